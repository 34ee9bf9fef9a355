// Turns an arrangement and the parts to keep into an edit of K (§ 5.2: joining crack and skin along
// the seam).
#include <algorithm>

#include "crack/classify.h"
#include "kerf/error.h"

namespace geo::crack {
namespace {

class Stitcher {
 public:
  Stitcher(const Arrangement& a, const Complex& complex, const EdgeTable& edges, std::vector<VertexId>& vertex)
      : a_(a), complex_(complex), edges_(edges), vertex_(vertex) {
    vertex_.assign(a.points().size(), VertexId());
  }

  ComplexEdit run(std::span<const Part> parts, std::int32_t crack) {
    const std::uint32_t base = complex_.face_count();
    face_of_.assign(a_.children.size(), FaceId());
    edit_.new_faces.reserve(a_.children.size());
    for (auto e = a_.strip_size; e < a_.elements.size(); ++e) {
      const Element& element = a_.elements[e];
      for (auto c = element.first; c < element.end; ++c) {
        const auto& v = a_.children[c].v;
        if (!element.cut) {
          face_of_[c] = element.face;
          for (const Local p : v) id(p);
          continue;
        }
        face_of_[c] = FaceId(base + static_cast<std::uint32_t>(edit_.new_faces.size()));
        edit_.new_faces.push_back({{id(v[0]), id(v[1]), id(v[2])}, complex_.face(element.face).crack, element.face});
      }
      if (element.cut) edit_.removed_faces.push_back(element.face);
    }
    EdgeTable own(a_.points().size());
    own.reserve(3 * parts.size());
    for (const Part& part : parts) {
      const auto& v = a_.children[part.child].v;
      face_of_[part.child] = FaceId(base + static_cast<std::uint32_t>(edit_.new_faces.size()));
      edit_.new_faces.push_back({{id(v[0]), id(v[1]), id(v[2])}, crack, FaceId()});
      for (std::uint8_t k = 0; k < 3; ++k) own.add(v[k], v[(k + 1) % 3], {part.element, part.child, k});
    }
    for (const Part& part : parts)
      for (std::uint8_t k = 0; k < 3; ++k) {
        if (a_.children[part.child].edge[k] == edge_diagonal) continue;
        const Local u = a_.children[part.child].v[k], v = a_.children[part.child].v[(k + 1) % 3];
        own.find(u, v, fresh_);
        if (fresh_[0].child != part.child || fresh_[0].k != k) continue;  // its ring is made at its first use
        order(u, v);
      }
    // Edges of K that gain no crack face but lose faces to their children keep their order; it is
    // given anew where the edge itself was divided.
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
          const Local u = child.v[k], v = child.v[(k + 1) % 3];
          if (u == element.corner[b] && v == element.corner[(b + 1) % 3]) continue;  // whole: parts take places
          own.find(u, v, fresh_);
          if (!fresh_.empty()) continue;  // done above
          edges_.find(u, v, at_);
          if (at_[0].child == c && at_[0].k == k) order(u, v);
        }
    }
    return std::move(edit_);
  }

 private:
  VertexId id(Local p) {
    if (!vertex_[p].valid()) {
      vertex_[p] = a_.id(p);
      if (!vertex_[p].valid()) {
        vertex_[p] = VertexId(complex_.vertex_count() + static_cast<std::uint32_t>(edit_.new_vertices.size()));
        edit_.new_vertices.push_back(a_.points()[p]);
      }
    }
    return vertex_[p];
  }

  struct Place {
    FaceId face;
    Member member;
  };

  // K's faces around u→v in K's own order, which is authoritative; crack faces (fresh_) put into it
  // by exact angles.
  void order(Local u, Local v) {
    ring_.clear();
    edges_.find(u, v, at_);
    if (at_.size() + fresh_.size() < 3) return;
    for (const Use& use : at_) ring_.push_back({face_of_[use.child], member_at(a_, use, u)});
    if (at_.size() >= 3) sort_like_complex();
    for (const Use& use : fresh_) {
      const Member m = member_at(a_, use, u);
      std::size_t place = ring_.size();
      for (std::size_t i = 0; i < ring_.size() && ring_.size() >= 2; ++i) {
        const Member &from = ring_[i].member, &to = ring_[(i + 1) % ring_.size()].member;
        // Counter-clockwise from `from`, is m before `to`?
        if (compare_around(a_, u, v, from, m, from) == 0) throw GeometryError("two faces lie on each other at an edge");
        if (compare_around(a_, u, v, from, to, from) == 0 || compare_around(a_, u, v, from, m, to) < 0) {
          place = i + 1;
          break;
        }
      }
      if (ring_.size() == 1 && compare_around(a_, u, v, ring_[0].member, m, ring_[0].member) == 0)
        throw GeometryError("two faces lie on each other at an edge");
      ring_.insert(ring_.begin() + static_cast<std::ptrdiff_t>(place), {face_of_[use.child], m});
    }
    ComplexEdit::RadialOrder given{id(u), id(v), {}};
    for (const Place& p : ring_) given.faces.push_back(p.face);
    edit_.radial_orders.push_back(std::move(given));
  }

  void sort_like_complex() {
    const Use& first = at_[0];
    const auto b = a_.children[first.child].edge[first.k];
    if (b > 2) throw GeometryError("three faces meet at an edge that is not one of the complex");
    const auto& v = complex_.face(a_.elements[first.element].face).v;
    const VertexId p = v[b], q = v[(b + 1) % 3];
    const auto order = complex_.faces_around(p, q);
    if (order.size() != at_.size()) throw GeometryError("a face around a met edge was not met");
    std::vector<Place> sorted;
    for (const FaceId f : order) {
      const auto found =
          std::find_if(at_.begin(), at_.end(), [&](const Use& use) { return a_.elements[use.element].face == f; });
      if (found == at_.end()) throw GeometryError("a face around a met edge was not met");
      sorted.push_back(ring_[static_cast<std::size_t>(found - at_.begin())]);
    }
    // K's order is counter-clockwise about its lower vertex to its higher one; ours about u→v.
    if ((p < q) != ring_[0].member.forward) std::reverse(sorted.begin(), sorted.end());
    ring_ = std::move(sorted);
  }

  const Arrangement& a_;
  const Complex& complex_;
  const EdgeTable& edges_;
  std::vector<VertexId>& vertex_;
  ComplexEdit edit_;
  std::vector<FaceId> face_of_;  // per child
  std::vector<Use> at_, fresh_;
  std::vector<Place> ring_;
};

}  // namespace

ComplexEdit stitch(const Arrangement& a, const Complex& complex, const EdgeTable& edges, std::span<const Part> parts,
                   std::int32_t crack, std::vector<VertexId>& vertex) {
  return Stitcher(a, complex, edges, vertex).run(parts, crack);
}

}  // namespace geo::crack
