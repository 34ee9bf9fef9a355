// Four phases: children of cut faces, crack faces, radial orders around the edges of crack faces,
// radial orders of divided edges. K's stored order is copied, never sorted again; crack faces are
// inserted into it by exact comparison of angles.
#include "crack/stitch.h"

#include <algorithm>
#include <stdexcept>

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

  // The vertex at a point: that of K, or a new one, which is added to the edit on its first use.
  VertexId vertex_at(PointIndex p) {
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
    edit_.new_faces.push_back({{vertex_at(v[0]), vertex_at(v[1]), vertex_at(v[2])}, crack, parent});
  }

  // Replaces each cut face of K by its children. A face that is only touched keeps its id; its
  // corners are entered in vertex_.
  void divide_faces() {
    for (auto e = a_.strip_size; e < a_.elements.size(); ++e) {
      pause_before(e, a_.pause());
      const Element& element = a_.elements[e];
      for (auto c = element.first; c < element.end; ++c) {
        if (!element.cut) {
          face_of_[c] = element.face;
          for (const PointIndex p : a_.children[c].v) vertex_at(p);
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
    crack_edges_.sort();
  }

  // Radial orders around the edges of crack faces, each at the edge's first use.
  void order_crack_edges(std::span<const ChildRef> kept) {
    for (std::size_t i = 0; i < kept.size(); ++i) {
      pause_before(i, a_.pause());
      const ChildRef& ref = kept[i];
      for (std::uint8_t k = 0; k < 3; ++k) {
        if (a_.children[ref.child].edge[k] == edge_diagonal) continue;
        const PointIndex u = a_.children[ref.child].v[k], v = a_.children[ref.child].v[(k + 1) % 3];
        crack_edges_.find(u, v, crack_uses_);
        if (crack_uses_[0].child == ref.child && crack_uses_[0].k == k) give_order(u, v, crack_uses_);
      }
    }
  }

  // Edges of K without a crack face keep their radial order. Where such an edge was divided its
  // parts need orders of their own; at a whole edge, Complex::apply() lets children inherit the
  // order.
  void order_divided_edges() {
    for (auto e = a_.strip_size; e < a_.elements.size(); ++e) {
      pause_before(e, a_.pause());
      const Element& element = a_.elements[e];
      if (!element.cut) continue;
      for (auto c = element.first; c < element.end; ++c)
        for (std::uint8_t k = 0; k < 3; ++k) {
          const Child& child = a_.children[c];
          if (!on_face_edge(child.edge[k])) continue;
          const auto b = child.edge[k];
          const VertexId p = complex_.face(element.face).v[b], q = complex_.face(element.face).v[(b + 1) % 3];
          if (complex_.faces_around(p, q).size() < 3) continue;
          const PointIndex u = child.v[k], v = child.v[(k + 1) % 3];
          if (u == element.corner[b] && v == element.corner[(b + 1) % 3]) continue;  // whole
          crack_edges_.find(u, v, crack_uses_);
          if (!crack_uses_.empty()) continue;  // has an order already
          edges_.find(u, v, complex_uses_);
          if (complex_uses_[0].child == c && complex_uses_[0].k == k) give_order(u, v, {});
        }
    }
  }

  // Gives the radial order around u→v: K's faces in K's own order, which is authoritative, and
  // crack faces inserted by exact comparison of angles.
  void give_order(PointIndex u, PointIndex v, std::span<const EdgeUse> crack_uses) {
    cycle_.clear();
    edges_.find(u, v, complex_uses_);
    if (complex_uses_.size() + crack_uses.size() < 3) return;  // two faces have one cyclic order
    for (const EdgeUse& use : complex_uses_) cycle_.push_back({face_of_[use.child], radial_face(a_, use, u)});
    if (complex_uses_.size() >= 3) sort_like_complex();
    for (const EdgeUse& use : crack_uses) {
      const RadialFace m = radial_face(a_, use, u);
      const std::size_t at = position_in_cycle(u, v, m);
      cycle_.insert(cycle_.begin() + static_cast<std::ptrdiff_t>(at), {face_of_[use.child], m});
    }
    ComplexEdit::RadialOrder order{vertex_at(u), vertex_at(v), {}};
    for (const RadialEntry& entry : cycle_) order.faces.push_back(entry.face);
    edit_.radial_orders.push_back(std::move(order));
  }

  // The index at which face m is inserted into the cycle around u→v. It is i + 1 for the first i
  // with angle(m) < angle(cycle[i + 1]), angles counter-clockwise from cycle[i]. An empty cycle
  // gives 0, one face gives 1: a cycle of two has one order.
  std::size_t position_in_cycle(PointIndex u, PointIndex v, const RadialFace& m) const {
    const std::size_t n = cycle_.size();
    for (std::size_t i = 0; i < n; ++i) {
      const RadialFace &from = cycle_[i].member, &to = cycle_[(i + 1) % n].member;
      if (lies_on(a_, u, v, from, m)) throw GeometryError("two faces lie on each other at an edge");
      if (n == 1) return 1;
      if (lies_on(a_, u, v, from, to)) throw GeometryError("two faces of the complex lie on each other at an edge");
      if (compare_around(a_, u, v, from, m, to) < 0) return i + 1;
    }
    if (n == 0) return 0;
    // The arcs from each face to the next lead around the edge once, or more often where K's order
    // contradicts its coordinates. So one of them contains m.
    throw std::logic_error("no wedge around an edge contains a face");
  }

  // Brings the cycle, which has the faces of complex_uses_, into K's order.
  void sort_like_complex() {
    const EdgeUse& first = complex_uses_[0];
    const auto b = a_.children[first.child].edge[first.k];
    if (!on_face_edge(b)) throw GeometryError("three faces meet at an edge that is not one of the complex");
    const auto& v = complex_.face(a_.elements[first.element].face).v;
    const VertexId p = v[b], q = v[(b + 1) % 3];
    const auto order = complex_.faces_around(p, q);
    if (order.size() != complex_uses_.size()) throw GeometryError("a face around a met edge was not met");
    std::vector<RadialEntry> sorted;
    for (const FaceId f : order) {
      const auto found = std::find_if(complex_uses_.begin(), complex_uses_.end(),
                                      [&](const EdgeUse& use) { return a_.elements[use.element].face == f; });
      if (found == complex_uses_.end()) throw GeometryError("a face around a met edge was not met");
      sorted.push_back(cycle_[static_cast<std::size_t>(found - complex_uses_.begin())]);
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
  EdgeTable crack_edges_;                           // of the kept children
  std::vector<FaceId> face_of_;                     // per child
  std::vector<EdgeUse> complex_uses_, crack_uses_;  // of the edge at hand, by faces of K and by crack faces
  std::vector<RadialEntry> cycle_;
};

}  // namespace

ComplexEdit stitch(const Arrangement& a, const Complex& complex, const EdgeTable& edges, std::span<const ChildRef> kept,
                   std::int32_t crack, std::vector<VertexId>& vertex) {
  return Stitcher(a, complex, edges, vertex).run(kept, crack);
}

}  // namespace geo::crack
