// Tests the cycles that the edit lists and, at undivided edges with ≥ 3 faces, K's own cycles with
// parents replaced by their children. Edges without a rounded point are skipped: they are exact.
#include "crack/radial_order.h"

#include <algorithm>

#include "kerf/check.h"

namespace geo {
namespace {

using Edge = std::pair<VertexId, VertexId>;  ///< first < second

class RadialOrderTest {
 public:
  RadialOrderTest(const Complex& complex, const ComplexEdit& edit, std::span<const std::uint8_t> moved)
      : complex_(complex), edit_(edit), moved_(moved) {}

  Fault first_fault() const {
    std::vector<Edge> given;
    for (const auto& order : edit_.radial_orders) {
      given.push_back(std::minmax(order.a, order.b));
      if (Fault fault = fault_around(order.a, order.b, order.faces)) return fault;
    }
    std::sort(given.begin(), given.end());
    // Undivided edges of K with divided faces keep their order; children replace their parents.
    std::vector<std::pair<Edge, std::uint32_t>> children;
    for (std::uint32_t i = 0; i < edit_.new_faces.size(); ++i) {
      const auto& f = edit_.new_faces[i];
      if (!f.parent.valid()) continue;
      for (std::size_t e = 0; e < 3; ++e) {
        const Edge edge = std::minmax(f.v[e], f.v[(e + 1) % 3]);
        if (edge.second.value < complex_.vertex_count() && complex_.faces_around(edge.first, edge.second).size() > 2 &&
            !std::binary_search(given.begin(), given.end(), edge))
          children.push_back({edge, i});
      }
    }
    std::sort(children.begin(), children.end());
    std::vector<FaceId> cycle;
    for (auto from = children.begin(), to = from; from != children.end(); from = to) {
      const Edge edge = from->first;
      to = std::find_if(from, children.end(), [&](const auto& child) { return child.first != edge; });
      cycle.clear();
      for (const FaceId f : complex_.faces_around(edge.first, edge.second)) {
        const auto child = std::find_if(from, to, [&](const auto& p) { return edit_.new_faces[p.second].parent == f; });
        cycle.push_back(child == to ? f : FaceId(complex_.face_count() + child->second));
      }
      if (Fault fault = fault_around(edge.first, edge.second, cycle)) return fault;
    }
    return {};
  }

 private:
  const Vec3& point(VertexId v) const { return point_after(complex_, edit_, v); }
  bool is_moved(VertexId v) const {
    return v.value >= complex_.vertex_count() && (moved_.empty() || moved_[v.value - complex_.vertex_count()]);
  }

  // Faces listed counter-clockwise about a→b.
  Fault fault_around(VertexId a, VertexId b, const std::vector<FaceId>& cycle) const {
    bool touched = is_moved(a) || is_moved(b);
    std::vector<Vec3> apex;
    Fault fault{"rounding would exchange faces around an edge", {}};
    for (const FaceId f : cycle) {
      const bool is_new = f.value >= complex_.face_count();
      const auto& v = is_new ? edit_.new_faces[f.value - complex_.face_count()].v : complex_.face(f).v;
      if (is_new) fault.faces.push_back(f.value - complex_.face_count());
      for (const VertexId c : v)
        if (c != a && c != b) {
          apex.push_back(point(c));
          touched |= is_moved(c);
        }
    }
    return !touched || in_radial_order(point(a), point(b), apex) ? Fault{} : fault;
  }

  const Complex& complex_;
  const ComplexEdit& edit_;
  std::span<const std::uint8_t> moved_;
};

}  // namespace

Fault find_radial_fault(const Complex& complex, const ComplexEdit& edit, std::span<const std::uint8_t> moved) {
  return RadialOrderTest(complex, edit, moved).first_fault();
}

}  // namespace geo
