// Four phases: children of cut faces, crack faces, radial orders around the edges of crack faces,
// radial orders of divided edges. K's stored order is copied, never sorted again; crack faces are
// inserted into it by exact comparison of angles.
#include "crack/stitch.h"

#include <algorithm>

#include "kerf/error.h"

namespace geo::crack {
namespace {

class Stitcher {
 public:
  Stitcher(const Arrangement& a, const Complex& complex, const EdgeTable& edges, std::vector<VertexId>& vertex)
      : a_(a), complex_(complex), edges_(edges), vertex_(vertex), crack_edges_(a.points().size()) {
    vertex_.assign(a.points().size(), VertexId());
  }

  ComplexEdit run(std::span<const ChildRef> kept, std::int32_t crack) {
    face_of_.assign(a_.children.size(), FaceId());
    edit_.new_faces.reserve(a_.children.size());
    divide_faces();
    add_crack_faces(kept, crack);
    order_crack_edges(kept);
    order_divided_edges();
    return std::move(edit_);
  }

 private:
  struct RadialEntry {
    FaceId face;
    RadialFace member;
  };

  // The vertex at a point: one of K, or a new one.
  VertexId id(PointIndex p) {
    if (!vertex_[p].valid()) {
      vertex_[p] = a_.id(p);
      if (!vertex_[p].valid()) {
        vertex_[p] = VertexId(complex_.vertex_count() + static_cast<std::uint32_t>(edit_.new_vertices.size()));
        edit_.new_vertices.push_back(a_.points()[p]);
      }
    }
    return vertex_[p];
  }

  void add_face(std::uint32_t child, std::int32_t crack, FaceId parent) {
    const auto& v = a_.children[child].v;
    face_of_[child] = FaceId(complex_.face_count() + static_cast<std::uint32_t>(edit_.new_faces.size()));
    edit_.new_faces.push_back({{id(v[0]), id(v[1]), id(v[2])}, crack, parent});
  }

  // Replaces faces of K that are cut by their children.
  void divide_faces() {
    for (auto e = a_.strip_size; e < a_.elements.size(); ++e) {
      const Element& element = a_.elements[e];
      for (auto c = element.first; c < element.end; ++c) {
        if (!element.cut) {
          face_of_[c] = element.face;
          for (const PointIndex p : a_.children[c].v) id(p);
          continue;
        }
        add_face(c, complex_.face(element.face).crack, element.face);
      }
      if (element.cut) edit_.removed_faces.push_back(element.face);
    }
  }

  void add_crack_faces(std::span<const ChildRef> kept, std::int32_t crack) {
    crack_edges_.reserve(3 * kept.size());
    for (const ChildRef& ref : kept) {
      const auto& v = a_.children[ref.child].v;
      add_face(ref.child, crack, FaceId());
      for (std::uint8_t k = 0; k < 3; ++k) crack_edges_.add(v[k], v[(k + 1) % 3], {ref.element, ref.child, k});
    }
  }

  // Radial orders around the edges of crack faces, each at the edge's first use.
  void order_crack_edges(std::span<const ChildRef> kept) {
    for (const ChildRef& ref : kept)
      for (std::uint8_t k = 0; k < 3; ++k) {
        if (a_.children[ref.child].edge[k] == edge_diagonal) continue;
        const PointIndex u = a_.children[ref.child].v[k], v = a_.children[ref.child].v[(k + 1) % 3];
        crack_edges_.find(u, v, crack_uses_);
        if (crack_uses_[0].child == ref.child && crack_uses_[0].k == k) give_order(u, v);
      }
  }

  // Edges of K without a crack face keep their radial order. Where such an edge was divided its
  // parts need orders of their own; at a whole edge, apply() lets children inherit the order.
  void order_divided_edges() {
    for (auto e = a_.strip_size; e < a_.elements.size(); ++e) {
      const Element& element = a_.elements[e];
      if (!element.cut) continue;
      for (auto c = element.first; c < element.end; ++c)
        for (std::uint8_t k = 0; k < 3; ++k) {
          const Child& child = a_.children[c];
          if (child.edge[k] > 2) continue;
          const auto b = child.edge[k];
          const VertexId p = complex_.face(element.face).v[b], q = complex_.face(element.face).v[(b + 1) % 3];
          if (complex_.faces_around(p, q).size() < 3) continue;
          const PointIndex u = child.v[k], v = child.v[(k + 1) % 3];
          if (u == element.corner[b] && v == element.corner[(b + 1) % 3]) continue;  // whole
          crack_edges_.find(u, v, crack_uses_);
          if (!crack_uses_.empty()) continue;  // has an order already
          edges_.find(u, v, at_);
          if (at_[0].child == c && at_[0].k == k) give_order(u, v);
        }
    }
  }

  // Gives the radial order around u→v: K's faces in K's own order, which is authoritative, and
  // crack faces (crack_uses_) inserted by exact comparison of angles.
  void give_order(PointIndex u, PointIndex v) {
    cycle_.clear();
    edges_.find(u, v, at_);
    if (at_.size() + crack_uses_.size() < 3) return;
    for (const EdgeUse& use : at_) cycle_.push_back({face_of_[use.child], radial_face(a_, use, u)});
    if (at_.size() >= 3) sort_like_complex();
    for (const EdgeUse& use : crack_uses_) {
      const RadialFace m = radial_face(a_, use, u);
      const std::size_t at = position_in_cycle(u, v, m);
      cycle_.insert(cycle_.begin() + static_cast<std::ptrdiff_t>(at), {face_of_[use.child], m});
    }
    ComplexEdit::RadialOrder order{id(u), id(v), {}};
    for (const RadialEntry& entry : cycle_) order.faces.push_back(entry.face);
    edit_.radial_orders.push_back(std::move(order));
  }

  // The index at which face m is inserted into the cycle around u→v: i + 1 if
  // angle(m) < angle(cycle[i + 1]), angles counter-clockwise from cycle[i].
  std::size_t position_in_cycle(PointIndex u, PointIndex v, const RadialFace& m) const {
    if (cycle_.size() == 1 && compare_around(a_, u, v, cycle_[0].member, m, cycle_[0].member) == 0)
      throw GeometryError("two faces lie on each other at an edge");
    for (std::size_t i = 0; i < cycle_.size() && cycle_.size() >= 2; ++i) {
      const RadialFace &from = cycle_[i].member, &to = cycle_[(i + 1) % cycle_.size()].member;
      // Counter-clockwise from `from`, is m before `to`?
      if (compare_around(a_, u, v, from, m, from) == 0) throw GeometryError("two faces lie on each other at an edge");
      if (compare_around(a_, u, v, from, to, from) == 0 || compare_around(a_, u, v, from, m, to) < 0) return i + 1;
    }
    return cycle_.size();
  }

  // Brings the cycle, which has the faces at_, into K's order.
  void sort_like_complex() {
    const EdgeUse& first = at_[0];
    const auto b = a_.children[first.child].edge[first.k];
    if (b > 2) throw GeometryError("three faces meet at an edge that is not one of the complex");
    const auto& v = complex_.face(a_.elements[first.element].face).v;
    const VertexId p = v[b], q = v[(b + 1) % 3];
    const auto order = complex_.faces_around(p, q);
    if (order.size() != at_.size()) throw GeometryError("a face around a met edge was not met");
    std::vector<RadialEntry> sorted;
    for (const FaceId f : order) {
      const auto found =
          std::find_if(at_.begin(), at_.end(), [&](const EdgeUse& use) { return a_.elements[use.element].face == f; });
      if (found == at_.end()) throw GeometryError("a face around a met edge was not met");
      sorted.push_back(cycle_[static_cast<std::size_t>(found - at_.begin())]);
    }
    // K's order is counter-clockwise about its lower vertex to its higher one; this one about u→v.
    if ((p < q) != cycle_[0].member.forward) std::reverse(sorted.begin(), sorted.end());
    cycle_ = std::move(sorted);
  }

  const Arrangement& a_;
  const Complex& complex_;
  const EdgeTable& edges_;
  std::vector<VertexId>& vertex_;
  ComplexEdit edit_;
  EdgeTable crack_edges_;        // of the kept children
  std::vector<FaceId> face_of_;  // per child
  std::vector<EdgeUse> at_, crack_uses_;
  std::vector<RadialEntry> cycle_;
};

}  // namespace

ComplexEdit stitch(const Arrangement& a, const Complex& complex, const EdgeTable& edges, std::span<const ChildRef> kept,
                   std::int32_t crack, std::vector<VertexId>& vertex) {
  return Stitcher(a, complex, edges, vertex).run(kept, crack);
}

}  // namespace geo::crack
