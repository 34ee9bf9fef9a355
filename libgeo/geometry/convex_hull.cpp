// Quickhull (Barber, Dobkin, Huhdanpaa 1996) with exact orientations: the farthest outside point
// replaces the facets that it sees by a cone over their horizon.
//
// A complete hull assigns an outside point to the first new facet that it is in front of, which is
// fast. A limited one assigns it to the one that it is farthest in front of. Each new corner is
// then the point that sticks out most of the hull so far.
#include "geometry/convex_hull.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <limits>
#include <map>
#include <optional>

#include "geometry/predicates.h"

namespace geo {
namespace {

struct Facet {
  Triangle v;
  Vec3 normal;
  double error = 0;                      // of distances, at most
  std::vector<std::uint32_t> outside{};  // points in front of this facet that are assigned to no other one
  std::uint32_t farthest = ~0u;          // of these; ~0u: none
  double distance = -1;                  // of the farthest one
};

enum class Assignment { first_facet, farthest_facet };

class Hull {
 public:
  Hull(std::span<const Vec3> points, const Triangle& base, std::uint32_t top, Assignment assignment)
      : points_(points), assignment_(assignment) {
    Box3 box;
    for (const Vec3& p : points) box.add(p);
    diameter_ = box.diagonal();
    const auto& [a, b, c] = base;  // counter-clockwise from outside: the top is behind it
    std::vector<std::uint32_t> all(points.size());
    for (std::uint32_t i = 0; i < all.size(); ++i) all[i] = i;
    for (const Triangle& t : {Triangle{a, b, c}, Triangle{b, a, top}, Triangle{c, b, top}, Triangle{a, c, top}})
      facets_.push_back(make(t));
    assign_outside(all, 0);
  }

  // Adds the point that is farthest in front of its facet. Returns false if no point is outside.
  bool grow() {
    const auto worst = std::max_element(facets_.begin(), facets_.end(),
                                        [](const Facet& f, const Facet& g) { return f.distance < g.distance; });
    if (worst->farthest == ~0u) return false;
    add(worst->farthest);
    return true;
  }

  // By Euler's formula; a corner that a later one hides does not count any more.
  std::size_t corner_count() const { return facets_.size() / 2 + 2; }

  std::vector<Triangle> triangles() const {
    std::vector<Triangle> result;
    for (const Facet& f : facets_) result.push_back(f.v);
    return result;
  }

  bool is_complete() const {
    return std::all_of(facets_.begin(), facets_.end(), [](const Facet& f) { return f.farthest == ~0u; });
  }

  // Corners, each moved so that its facets go outwards by half of what sticks out of them, in the
  // least squares. The weight of a short way, relative to that of the facets, decides where the
  // facets leave a direction free: along an edge between two walls, or within one wall.
  std::vector<Vec3> moved_corners() const {
    constexpr double short_way = 1e-2;  // facets that bend by 0.1 radian still decide about a direction
    struct Fit {
      Mat3 normals = Mat3::Zero();
      Vec3 wanted = Vec3::Zero();
    };
    std::map<std::uint32_t, Fit> fits;
    for (const Facet& f : facets_)
      for (const auto v : f.v) {
        Fit& fit = fits[v];
        fit.normals += f.normal * f.normal.transpose();
        fit.wanted += 0.5 * std::max(0.0, f.distance) * f.normal;
      }
    std::vector<Vec3> corners;
    for (const auto& [v, fit] : fits) {
      const Mat3 regular = fit.normals + short_way * fit.normals.trace() * Mat3::Identity();
      corners.push_back(points_[v] + regular.ldlt().solve(fit.wanted));
    }
    return corners;
  }

 private:
  // A facet without outside points.
  Facet make(const Triangle& v) const {
    const Vec3 b = points_[v[1]] - points_[v[0]];
    const Vec3 c = points_[v[2]] - points_[v[0]];
    const Vec3 n = b.cross(c);
    // Differences, products and sums round a distance by 8 ε of the products' size, which
    // exceeds the normal's where the facet is a sliver.
    const double error = 8 * std::numeric_limits<double>::epsilon() * (b.norm() * c.norm() / n.norm() + 1) * diameter_;
    return {.v = v, .normal = n.normalized(), .error = error};
  }

  // How far p is in front of f at least; none if it is not in front.
  std::optional<double> distance(const Facet& f, std::uint32_t p) const {
    const double d = f.normal.dot(points_[p] - points_[f.v[0]]);
    if (d > f.error) return d - f.error;
    if (d < -f.error || !is_in_front(f, p)) return std::nullopt;
    return 0;
  }
  bool is_in_front(const Facet& f, std::uint32_t p) const {
    return orient3d(points_[f.v[0]], points_[f.v[1]], points_[f.v[2]], points_[p]) > 0;
  }

  // Assigns each point to one of the facets from `first` on that it is in front of.
  void assign_outside(const std::vector<std::uint32_t>& points, std::size_t first) {
    for (const auto p : points) {
      Facet* best = nullptr;
      double farthest = -1;
      for (std::size_t f = first; f < facets_.size(); ++f) {
        const auto d = distance(facets_[f], p);
        if (!d || *d <= farthest) continue;
        best = &facets_[f];
        farthest = *d;
        if (assignment_ == Assignment::first_facet) break;
      }
      if (!best) continue;
      best->outside.push_back(p);
      if (farthest <= best->distance) continue;
      best->distance = farthest;
      best->farthest = p;
    }
  }

  // Replaces the facets visible from p by a cone of facets from their horizon to p.
  void add(std::uint32_t p) {
    std::vector<std::pair<std::uint32_t, std::uint32_t>> edges;
    std::vector<std::uint32_t> orphans;
    std::size_t first = 0;
    for (std::size_t f = 0; f < facets_.size(); ++f) {
      const Facet& facet = facets_[f];
      if (!distance(facet, p)) {
        if (f != first) facets_[first] = std::move(facets_[f]);
        ++first;
        continue;
      }
      for (std::size_t k = 0; k < 3; ++k) edges.emplace_back(facet.v[k], facet.v[(k + 1) % 3]);
      orphans.insert(orphans.end(), facet.outside.begin(), facet.outside.end());
    }
    facets_.resize(first);
    // The horizon: edges of visible facets whose twins belong to hidden ones.
    std::sort(edges.begin(), edges.end());
    for (const auto& [a, b] : edges)
      if (!std::binary_search(edges.begin(), edges.end(), std::pair(b, a))) facets_.push_back(make({a, b, p}));
    std::sort(orphans.begin(), orphans.end());
    assign_outside(orphans, first);
  }

  std::span<const Vec3> points_;
  Assignment assignment_;
  double diameter_ = 0;
  std::vector<Facet> facets_;
};

// The point with the largest measure; none if no measure is positive.
template <class Measure>
std::optional<std::uint32_t> farthest(std::span<const Vec3> points, const Measure& measure) {
  std::optional<std::uint32_t> best;
  double largest = 0;
  for (std::uint32_t i = 0; i < points.size(); ++i)
    if (const double m = measure(points[i]); m > largest) {
      largest = m;
      best = i;
    }
  return best;
}

// Quickhull with at most max_corners corners; none if all points are coplanar.
std::optional<Hull> grown_hull(std::span<const Vec3> points, std::size_t max_corners) {
  if (points.size() < 4) return std::nullopt;
  const Vec3& o = points[0];
  const auto b = farthest(points, [&](const Vec3& p) { return (p - o).norm(); });
  if (!b) return std::nullopt;
  const auto c = farthest(points, [&](const Vec3& p) { return (points[*b] - o).cross(p - o).norm(); });
  if (!c || collinear(o, points[*b], points[*c])) return std::nullopt;
  const Vec3 normal = (points[*b] - o).cross(points[*c] - o);
  const auto d = farthest(points, [&](const Vec3& p) { return std::abs(normal.dot(p - o)); });
  if (!d) return std::nullopt;
  const int side = orient3d(o, points[*b], points[*c], points[*d]);
  if (side == 0) return std::nullopt;
  const bool complete = max_corners >= points.size();
  std::optional<Hull> hull(std::in_place, points, side < 0 ? Triangle{0, *b, *c} : Triangle{0, *c, *b}, *d,
                           complete ? Assignment::first_facet : Assignment::farthest_facet);
  while (hull->corner_count() < max_corners && hull->grow()) {
  }
  return hull;
}

// Triangles of points with the corners that they use.
ConvexPolyhedron compact(std::span<const Vec3> points, std::vector<Triangle> triangles) {
  ConvexPolyhedron result;
  std::map<std::uint32_t, std::uint32_t> index;  // point → corner
  for (Triangle& t : triangles)
    for (auto& v : t) {
      const auto [entry, is_new] = index.try_emplace(v, static_cast<std::uint32_t>(result.corners.size()));
      if (is_new) result.corners.push_back(points[v]);
      v = entry->second;
    }
  result.triangles = std::move(triangles);
  return result;
}

}  // namespace

std::vector<Triangle> convex_hull(std::span<const Vec3> points, std::size_t max_corners) {
  const auto hull = grown_hull(points, max_corners);
  return hull ? hull->triangles() : std::vector<Triangle>();
}

ConvexPolyhedron fitted_hull(std::span<const Vec3> points, std::size_t max_corners) {
  const auto hull = grown_hull(points, max_corners);
  if (!hull) return {};
  if (hull->is_complete()) return compact(points, hull->triangles());
  const std::vector<Vec3> corners = hull->moved_corners();
  return compact(corners, convex_hull(corners));
}

}  // namespace geo
