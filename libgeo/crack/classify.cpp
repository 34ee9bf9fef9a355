// A child at an edge of K is inside iff the wedge of K that contains it is material. Flood fill
// across edges without faces of K carries the answer over the component. Components without an edge
// on K are decided by the parity of skin crossings of a ray (Jordan curve theorem).
#include "crack/classify.h"

#include <algorithm>

#include "geometry/predicates.h"
#include "kerf/error.h"

namespace geo::crack {
namespace {

// Whether `child`, at edge uv of K, lies in a wedge of material. `at`: the faces of K there.
bool in_material_wedge(const Arrangement& a, const Complex& complex, PointIndex u, PointIndex v,
                       const RadialFace& child, const std::vector<EdgeUse>& at) {
  // The last face counter-clockwise from the child bounds the child's wedge.
  const EdgeUse* last = nullptr;
  RadialFace last_face{};
  for (const EdgeUse& use : at) {
    const RadialFace face = radial_face(a, use, u);
    if (lies_on(a, u, v, child, face)) throw GeometryError("a part of the strip lies on a face");
    if (!last || compare_around(a, u, v, child, face, last_face) > 0) {
      last = &use;
      last_face = face;
    }
  }
  if (complex.face(a.elements[last->element].face).crack > 0) return true;
  // A skin face has material behind it: the wedge is material if the back looks counter-clockwise.
  return !last_face.forward;
}

// Flood fill over the strip's children.
class Classifier {
 public:
  Classifier(const Arrangement& a, const Complex& complex, const EdgeTable& edges)
      : a_(a), complex_(complex), edges_(edges), strip_edges_(a.points().size()) {
    for (std::uint32_t e = 0; e < a.strip_size; ++e)
      for (auto c = a.elements[e].first; c < a.elements[e].end; ++c)
        if (!a.lies_on_other(e, a.children[c])) children_.push_back({e, c});
    strip_edges_.reserve(3 * children_.size());
    for (std::uint32_t i = 0; i < children_.size(); ++i)
      for (std::uint8_t k = 0; k < 3; ++k) {
        const auto& v = a.children[children_[i].child].v;
        strip_edges_.add(v[k], v[(k + 1) % 3], {i, children_[i].child, k});
      }
    strip_edges_.sort();
    visited_.assign(children_.size(), false);
  }

  std::vector<ChildRef> inside() {
    std::vector<ChildRef> kept;
    for (std::uint32_t start = 0; start < children_.size(); ++start) {
      if (visited_[start] || !component_inside(start)) continue;
      for (const auto i : component_) kept.push_back(children_[i]);
    }
    std::sort(kept.begin(), kept.end(), [](const ChildRef& x, const ChildRef& y) { return x.child < y.child; });
    return kept;
  }

 private:
  // Collects the component of `start` between edges of K. Whether it is inside.
  bool component_inside(std::uint32_t start) {
    component_.assign(1, start);
    visited_[start] = true;
    std::size_t inside = 0, outside = 0;
    for (std::size_t g = 0; g < component_.size(); ++g) {
      pause_before(g, a_.pause());
      const ChildRef ref = children_[component_[g]];
      const Child& child = a_.children[ref.child];
      for (std::uint8_t k = 0; k < 3; ++k) {
        const PointIndex u = child.v[k], v = child.v[(k + 1) % 3];
        if (child.edge[k] != edge_diagonal) {
          edges_.find(u, v, at_);
          if (!at_.empty()) {
            const RadialFace face{ref.element, child.v[(k + 2) % 3], true};
            ++(in_material_wedge(a_, complex_, u, v, face, at_) ? inside : outside);
            continue;
          }
        }
        strip_edges_.find(u, v, at_);
        for (const EdgeUse& next : at_)
          if (!visited_[next.element]) {
            visited_[next.element] = true;
            component_.push_back(next.element);
          }
      }
    }
    if (inside > 0 && outside > 0) throw GeometryError("the strip is inside and outside at once");
    if (inside + outside > 0) return inside > 0;
    const auto& c = a_.children[children_[start].child].v;
    return inside_material(complex_, (a_.points()[c[0]] + a_.points()[c[1]] + a_.points()[c[2]]) / 3);
  }

  const Arrangement& a_;
  const Complex& complex_;
  const EdgeTable& edges_;
  std::vector<ChildRef> children_;  // of the strip, but for those on a face
  EdgeTable strip_edges_;           // their uses; `element` is the index into children_
  std::vector<bool> visited_;
  std::vector<std::uint32_t> component_;  // indices into children_
  std::vector<EdgeUse> at_;
};

// How many faces of the skin segment pq crosses; −1 when it is not generic: it touches an edge, or
// an end touches a face.
int count_crossings(const Complex& complex, const Vec3& p, const Vec3& q, std::vector<FaceId>& near) {
  Box3 box{p, p};
  box.add(q);
  near.clear();
  complex.faces_near(box, near);
  int crossings = 0;
  for (const FaceId f : near) {
    if (complex.face(f).crack > 0) continue;
    const auto t = complex.corners(f);
    const int sp = orient3d(t[0], t[1], t[2], p), sq = orient3d(t[0], t[1], t[2], q);
    if (sp == sq && sp != 0) continue;
    const int e0 = orient3d(p, q, t[0], t[1]), e1 = orient3d(p, q, t[1], t[2]), e2 = orient3d(p, q, t[2], t[0]);
    if (!((e0 >= 0 && e1 >= 0 && e2 >= 0) || (e0 <= 0 && e1 <= 0 && e2 <= 0))) continue;
    if (sp == 0 || sq == 0 || e0 == 0 || e1 == 0 || e2 == 0) return -1;
    ++crossings;
  }
  return crossings;
}

}  // namespace

std::vector<ChildRef> children_in_material(const Arrangement& a, const Complex& complex, const EdgeTable& edges) {
  return Classifier(a, complex, edges).inside();
}

bool inside_material(const Complex& complex, const Vec3& q) {
  const Box3& extent = complex.extent();
  if (!Box3{q, q}.meets(extent)) return false;
  const double reach = extent.diagonal();
  std::vector<FaceId> near;
  for (int tries = 0; tries < 24; ++tries) {
    const int axis = tries % 3;
    // Straight out along an axis, to 1 % of the diagonal beyond the box. The tilt is small and
    // differs each time: a ray that touches an edge is followed by another one.
    Vec3 end = q;
    end[axis] = (tries / 3) % 2 == 0 ? extent.hi[axis] + reach * 0.01 : extent.lo[axis] - reach * 0.01;
    end[(axis + 1) % 3] += reach * (1.3e-4 + 3.1e-4 * tries);
    end[(axis + 2) % 3] += reach * (0.7e-4 + 2.3e-4 * tries);
    if (const int crossings = count_crossings(complex, q, end, near); crossings >= 0) return crossings % 2 == 1;
  }
  throw GeometryError("no line from a point of the strip avoids the edges of the skin");
}

}  // namespace geo::crack
