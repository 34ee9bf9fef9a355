// Edge-uses are sorted by lower point (counting sort). Radial order: the side of the plane of face
// `zero` gives each face's sector, 0, (0, π), π or (π, 2π); within a sector, orient3d orders two
// faces.
#include "crack/edge_table.h"

#include <algorithm>
#include <numeric>

#include "geometry/predicates.h"

namespace geo::crack {

void EdgeTable::add(PointIndex u, PointIndex v, const EdgeUse& use) {
  const PointIndex low = std::min(u, v);
  added_.push_back({low, std::max(u, v), use});
  ++first_[low + 1];
}

void EdgeTable::sort() {
  std::partial_sum(first_.begin(), first_.end(), first_.begin());
  sorted_.resize(added_.size());
  std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
  for (const Entry& entry : added_) sorted_[next[entry.low]++] = entry;
  added_ = {};
}

void EdgeTable::find(PointIndex u, PointIndex v, std::vector<EdgeUse>& out) const {
  out.clear();
  const PointIndex low = std::min(u, v), high = std::max(u, v);
  for (auto e = first_[low]; e < first_[low + 1]; ++e)
    if (sorted_[e].high == high) out.push_back(sorted_[e].use);
}

RadialFace radial_face(const Arrangement& a, const EdgeUse& use, PointIndex u) {
  const auto& c = a.children[use.child].v;
  return {use.element, c[(use.k + 2) % 3], c[use.k] == u};
}

namespace {

// The sector of face w, counter-clockwise from `zero`: 0 at angle 0, 1 below π, 2 at π, 3 above π.
int sector(const Arrangement& a, PointIndex u, PointIndex v, const RadialFace& zero, const RadialFace& w) {
  if (zero.element == w.element) return zero.forward == w.forward ? 0 : 2;
  const int side = a.side(zero.element, w.apex);
  if (side != 0) return (side > 0) == zero.forward ? 1 : 3;
  const auto [axis, turn] = projection_of(a.points(), a.elements[zero.element].corner);
  return a.points().orient2d(u, v, w.apex, axis) == (zero.forward ? turn : -turn) ? 0 : 2;
}

}  // namespace

bool lies_on(const Arrangement& a, PointIndex u, PointIndex v, const RadialFace& zero, const RadialFace& w) {
  return sector(a, u, v, zero, w) == 0;
}

int compare_around(const Arrangement& a, PointIndex u, PointIndex v, const RadialFace& zero, const RadialFace& p,
                   const RadialFace& q) {
  const int sp = sector(a, u, v, zero, p), sq = sector(a, u, v, zero, q);
  if (sp != sq) return sp < sq ? -1 : 1;
  if (sp == 0 || sp == 2 || p.element == q.element) return 0;
  const int side = a.side(p.element, q.apex);
  return p.forward ? -side : side;
}

EdgeTable edges_of_complex(const Arrangement& a) {
  EdgeTable edges(a.points().size());
  edges.reserve(2 * a.children.size());
  for (std::uint32_t e = a.strip_size; e < a.elements.size(); ++e)
    for (auto c = a.elements[e].first; c < a.elements[e].end; ++c) {
      const Child& child = a.children[c];
      for (std::uint8_t k = 0; k < 3; ++k)
        if (child.edge[k] != edge_diagonal) edges.add(child.v[k], child.v[(k + 1) % 3], {e, c, k});
    }
  edges.sort();
  return edges;
}

}  // namespace geo::crack
