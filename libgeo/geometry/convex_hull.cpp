// Quickhull (Barber, Dobkin, Huhdanpaa 1996) with exact orientations: the farthest outside point
// replaces the facets that it sees by a cone over their horizon.
#include "geometry/convex_hull.h"

#include <algorithm>
#include <map>
#include <optional>

#include "geometry/predicates.h"

namespace geo {
namespace {

struct Facet {
  Triangle v;
  Vec3 normal;
  std::vector<std::uint32_t> outside;  // points in front of this facet and of no earlier one
  std::uint32_t farthest = ~0u;        // of these; ~0u: none
  double distance = 0;                 // of the farthest one
};

class Hull {
 public:
  Hull(std::span<const Vec3> points, const Triangle& base, std::uint32_t top) : points_(points) {
    const auto& [a, b, c] = base;  // counter-clockwise from outside: the top is behind it
    std::vector<std::uint32_t> all(points.size());
    for (std::uint32_t i = 0; i < all.size(); ++i) all[i] = i;
    for (const Triangle& t : {Triangle{a, b, c}, Triangle{b, a, top}, Triangle{c, b, top}, Triangle{a, c, top}})
      facets_.push_back(make(t));
    assign_outside(all, 0);
  }

  // Adds the point that is farthest outside. Returns false if no point is outside.
  bool grow() {
    const auto worst = std::max_element(facets_.begin(), facets_.end(),
                                        [](const Facet& f, const Facet& g) { return f.distance < g.distance; });
    if (worst->farthest == ~0u) {
      // A point may be outside by less than the rounding error of its distance.
      const auto any = std::find_if(facets_.begin(), facets_.end(), [](const Facet& f) { return !f.outside.empty(); });
      if (any == facets_.end()) return false;
      return add(any->outside.front()), true;
    }
    add(worst->farthest);
    return true;
  }

  std::vector<Triangle> triangles() const {
    std::vector<Triangle> result;
    for (const Facet& f : facets_) result.push_back(f.v);
    return result;
  }

 private:
  // A facet without outside points.
  Facet make(const Triangle& v) const {
    const Vec3 &a = points_[v[0]], &b = points_[v[1]], &c = points_[v[2]];
    return {v, (b - a).cross(c - a).normalized(), {}, ~0u, 0};
  }
  bool is_in_front(const Facet& f, std::uint32_t p) const {
    return orient3d(points_[f.v[0]], points_[f.v[1]], points_[f.v[2]], points_[p]) > 0;
  }

  // Assigns each point to the first facet, from `first` on, that it is in front of.
  void assign_outside(const std::vector<std::uint32_t>& points, std::size_t first) {
    for (const auto p : points)
      for (std::size_t f = first; f < facets_.size(); ++f)
        if (is_in_front(facets_[f], p)) {
          Facet& facet = facets_[f];
          facet.outside.push_back(p);
          const double distance = facet.normal.dot(points_[p] - points_[facet.v[0]]);
          if (distance > facet.distance) facet.distance = distance, facet.farthest = p;
          break;
        }
  }

  // Replaces the facets visible from p by a cone of facets from their horizon to p.
  void add(std::uint32_t p) {
    const auto visible =
        std::stable_partition(facets_.begin(), facets_.end(), [&](const Facet& f) { return !is_in_front(f, p); });
    std::map<std::pair<std::uint32_t, std::uint32_t>, bool> edges;
    std::vector<std::uint32_t> orphans;
    for (auto f = visible; f != facets_.end(); ++f) {
      for (std::size_t k = 0; k < 3; ++k) edges[{f->v[k], f->v[(k + 1) % 3]}] = true;
      orphans.insert(orphans.end(), f->outside.begin(), f->outside.end());
    }
    facets_.erase(visible, facets_.end());
    const std::size_t first = facets_.size();
    // The horizon: edges of visible facets whose twins belong to hidden ones.
    for (const auto& [edge, exists] : edges)
      if (edges.count({edge.second, edge.first}) == 0) facets_.push_back(make({edge.first, edge.second, p}));
    std::sort(orphans.begin(), orphans.end());
    assign_outside(orphans, first);
  }

  std::span<const Vec3> points_;
  std::vector<Facet> facets_;
};

// The point with the largest measure; none if no measure is positive.
template <class Measure>
std::optional<std::uint32_t> farthest(std::span<const Vec3> points, const Measure& measure) {
  std::optional<std::uint32_t> best;
  double largest = 0;
  for (std::uint32_t i = 0; i < points.size(); ++i)
    if (const double m = measure(points[i]); m > largest) largest = m, best = i;
  return best;
}

}  // namespace

std::vector<Triangle> convex_hull(std::span<const Vec3> points, std::size_t max_corners) {
  if (points.size() < 4) return {};
  const Vec3& o = points[0];
  const auto b = farthest(points, [&](const Vec3& p) { return (p - o).norm(); });
  if (!b) return {};
  const auto c = farthest(points, [&](const Vec3& p) { return (points[*b] - o).cross(p - o).norm(); });
  if (!c || collinear(o, points[*b], points[*c])) return {};
  const Vec3 normal = (points[*b] - o).cross(points[*c] - o);
  const auto d = farthest(points, [&](const Vec3& p) { return std::abs(normal.dot(p - o)); });
  if (!d) return {};
  const int side = orient3d(o, points[*b], points[*c], points[*d]);
  if (side == 0) return {};
  Hull hull(points, side < 0 ? Triangle{0, *b, *c} : Triangle{0, *c, *b}, *d);
  for (std::size_t corners = 4; corners < max_corners && hull.grow();) ++corners;
  return hull.triangles();
}

}  // namespace geo
