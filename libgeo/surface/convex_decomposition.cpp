// convex_decomposition() of kerf/pieces.h.
//
// Greedy division (after Mamou and Ghorbel 2009): of seven planes across each principal axis, the
// one with the largest V(hull) − V(hull₁) − V(hull₂) divides a solid; the solid that saves most is
// divided first. Cuts are closed by a fan around the centroid of their rim.
#include "kerf/pieces.h"

#include <algorithm>
#include <functional>
#include <optional>

#include <Eigen/Eigenvalues>

#include "geometry/convex_hull.h"

namespace geo {
namespace {

TriangleMesh hull_of(const std::vector<Vec3>& points, std::size_t max_vertices) {
  ConvexPolyhedron fitted = fitted_hull(points, max_vertices);
  TriangleMesh hull;
  hull.vertices = std::move(fitted.corners);
  hull.triangles = std::move(fitted.triangles);
  return hull;
}

// A closed triangle soup and its hull. A cut is closed by a fan of triangles, which may overlap but
// stays inside the hull.
struct Solid {
  std::vector<std::array<Vec3, 3>> triangles;
  TriangleMesh hull;
  double volume = 0;  // of the hull

  Solid(std::vector<std::array<Vec3, 3>> soup, const std::vector<Vec3>& points, std::size_t max_vertices)
      : triangles(std::move(soup)), hull(hull_of(points, max_vertices)), volume(signed_volume(hull)) {}
};

// The part of a solid where side · (n · x − offset) is negative, closed again.
Solid below(const Solid& solid, const Vec3& n, double offset, double side, std::size_t max_vertices) {
  std::vector<std::array<Vec3, 3>> kept;
  std::vector<std::pair<Vec3, Vec3>> rim;
  std::vector<Vec3> points;
  Vec3 middle = Vec3::Zero();
  for (const auto& t : solid.triangles) {
    std::vector<Vec3> polygon;
    std::optional<Vec3> exit, entry;
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3 &a = t[k], &b = t[(k + 1) % 3];
      const double da = side * (n.dot(a) - offset), db = side * (n.dot(b) - offset);
      if (da <= 0) polygon.push_back(a);
      if ((da <= 0) == (db <= 0)) continue;
      const Vec3 p = a + da / (da - db) * (b - a);
      polygon.push_back(p);
      (da <= 0 ? exit : entry) = p;
    }
    for (std::size_t k = 2; k < polygon.size(); ++k) kept.push_back({polygon[0], polygon[k - 1], polygon[k]});
    points.insert(points.end(), polygon.begin(), polygon.end());
    if (exit && entry) {
      rim.push_back({*exit, *entry});
      middle += *exit + *entry;
    }
  }
  if (!rim.empty()) middle /= 2 * double(rim.size());
  for (const auto& [a, b] : rim) kept.push_back({b, a, middle});
  return Solid(std::move(kept), points, max_vertices);
}

// A division of a solid.
struct Division {
  std::vector<Solid> halves;
  double saved = 0;  // volume of the hull, less those of the halves' hulls
};

// The division that saves most, by planes at evenly spaced positions across the principal axes.
Division divide(const Solid& solid, std::size_t max_vertices, const std::function<void()>& after_plane) {
  constexpr int positions = 7;  // per axis; larger: better divisions, in proportionally more time
  Vec3 mean = Vec3::Zero();
  for (const auto& t : solid.triangles) mean += (t[0] + t[1] + t[2]) / (3 * double(solid.triangles.size()));
  Mat3 spread = Mat3::Zero();
  for (const auto& t : solid.triangles)
    for (const Vec3& p : t) spread += (p - mean) * (p - mean).transpose();
  const Eigen::SelfAdjointEigenSolver<Mat3> axes(spread);
  Division best;
  for (int axis = 0; axis < 3; ++axis) {
    const Vec3 n = axes.eigenvectors().col(axis);
    double lo = std::numeric_limits<double>::infinity(), hi = -lo;
    for (const auto& t : solid.triangles)
      for (const Vec3& p : t) {
        lo = std::min(lo, n.dot(p));
        hi = std::max(hi, n.dot(p));
      }
    for (int k = 1; k <= positions; ++k) {
      const double offset = lo + (hi - lo) * k / (positions + 1);
      Solid under = below(solid, n, offset, 1, max_vertices), over = below(solid, n, offset, -1, max_vertices);
      const double saved = solid.volume - under.volume - over.volume;
      after_plane();
      if (under.hull.triangles.empty() || over.hull.triangles.empty() || saved <= best.saved) continue;
      best = {{std::move(under), std::move(over)}, saved};
    }
  }
  return best;
}

}  // namespace

std::vector<TriangleMesh> convex_decomposition(const TriangleMesh& mesh, std::size_t max_hulls,
                                               std::size_t max_vertices, const Progress& progress) {
  const auto tell = [&](std::size_t hulls) { report(progress, "hulls", hulls, max_hulls); };
  std::vector<Solid> all{Solid(corners_of(mesh), mesh.vertices, max_vertices)};
  if (all[0].hull.triangles.empty()) return {};
  const double least_saving = 0.01 * all[0].volume;
  std::vector<Division> next;
  while (all.size() < max_hulls) {
    for (std::size_t p = next.size(); p < all.size(); ++p)
      next.push_back(divide(all[p], max_vertices, [&] { tell(all.size()); }));
    const auto best = static_cast<std::size_t>(
        std::max_element(next.begin(), next.end(), [](const auto& a, const auto& b) { return a.saved < b.saved; }) -
        next.begin());
    if (next[best].saved <= least_saving) break;
    auto halves = std::move(next[best].halves);
    all.erase(all.begin() + static_cast<std::ptrdiff_t>(best));
    next.erase(next.begin() + static_cast<std::ptrdiff_t>(best));
    for (Solid& half : halves) all.push_back(std::move(half));
  }
  std::vector<TriangleMesh> hulls;
  for (Solid& solid : all) hulls.push_back(std::move(solid.hull));
  return hulls;
}

}  // namespace geo
