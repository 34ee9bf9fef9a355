#include "kerf/pieces.h"

#include <algorithm>
#include <map>
#include <optional>

#include <Eigen/Eigenvalues>

#include "geometry/convex_hull.h"

namespace geo {
namespace {

TriangleMesh hull_of(const std::vector<Vec3>& points, std::size_t corners) {
  TriangleMesh hull;
  std::map<std::uint32_t, std::uint32_t> rows;
  for (Triangle t : convex_hull(points, corners)) {
    for (auto& v : t) {
      const auto [entry, fresh] = rows.try_emplace(v, static_cast<std::uint32_t>(hull.vertices.size()));
      if (fresh) hull.vertices.push_back(points[v]);
      v = entry->second;
    }
    hull.triangles.push_back(t);
  }
  return hull;
}

// A closed soup of triangles. Where it was cut off it is closed by a fan, which may pass over
// itself, but not beyond the hull.
struct Part {
  std::vector<std::array<Vec3, 3>> triangles;
  TriangleMesh hull;
  double volume = 0;  // of the hull

  Part(std::vector<std::array<Vec3, 3>> soup, const std::vector<Vec3>& points, std::size_t corners)
      : triangles(std::move(soup)), hull(hull_of(points, corners)), volume(signed_volume(hull)) {}
};

// What of a part is where `side` of (n · x − offset) is negative, closed again.
Part below(const Part& part, const Vec3& n, double offset, double side, std::size_t corners) {
  std::vector<std::array<Vec3, 3>> kept;
  std::vector<std::pair<Vec3, Vec3>> rim;
  std::vector<Vec3> points;
  Vec3 middle = Vec3::Zero();
  for (const auto& t : part.triangles) {
    std::vector<Vec3> polygon;
    std::optional<Vec3> leaves, enters;
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3 &a = t[k], &b = t[(k + 1) % 3];
      const double da = side * (n.dot(a) - offset), db = side * (n.dot(b) - offset);
      if (da <= 0) polygon.push_back(a);
      if ((da <= 0) == (db <= 0)) continue;
      const Vec3 p = a + da / (da - db) * (b - a);
      polygon.push_back(p);
      (da <= 0 ? leaves : enters) = p;
    }
    for (std::size_t k = 2; k < polygon.size(); ++k) kept.push_back({polygon[0], polygon[k - 1], polygon[k]});
    points.insert(points.end(), polygon.begin(), polygon.end());
    if (leaves && enters) rim.push_back({*leaves, *enters}), middle += *leaves + *enters;
  }
  if (!rim.empty()) middle /= 2 * double(rim.size());
  for (const auto& [a, b] : rim) kept.push_back({b, a, middle});
  return Part(std::move(kept), points, corners);
}

// The best way to divide a part, and the volume of hulls that it saves.
struct Division {
  std::vector<Part> halves;
  double saved = 0;
};

Division divide(const Part& part, std::size_t corners) {
  constexpr int places = 7;  // of the plane along each axis, evenly spread
  Vec3 mean = Vec3::Zero();
  for (const auto& t : part.triangles) mean += (t[0] + t[1] + t[2]) / (3 * double(part.triangles.size()));
  Mat3 spread = Mat3::Zero();
  for (const auto& t : part.triangles)
    for (const Vec3& p : t) spread += (p - mean) * (p - mean).transpose();
  const Eigen::SelfAdjointEigenSolver<Mat3> axes(spread);
  Division best;
  for (int axis = 0; axis < 3; ++axis) {
    const Vec3 n = axes.eigenvectors().col(axis);
    double lo = std::numeric_limits<double>::infinity(), hi = -lo;
    for (const auto& t : part.triangles)
      for (const Vec3& p : t) lo = std::min(lo, n.dot(p)), hi = std::max(hi, n.dot(p));
    for (int k = 1; k <= places; ++k) {
      const double offset = lo + (hi - lo) * k / (places + 1);
      Part under = below(part, n, offset, 1, corners), over = below(part, n, offset, -1, corners);
      const double saved = part.volume - under.volume - over.volume;
      if (under.hull.triangles.empty() || over.hull.triangles.empty() || saved <= best.saved) continue;
      best = {{std::move(under), std::move(over)}, saved};
    }
  }
  return best;
}

}  // namespace

std::vector<TriangleMesh> convex_decomposition(const TriangleMesh& mesh, std::size_t parts, std::size_t corners) {
  std::vector<Part> all{Part(corners_of(mesh), mesh.vertices, corners)};
  if (all[0].hull.triangles.empty()) return {};
  const double least = 0.01 * all[0].volume;
  std::vector<Division> next;
  while (all.size() < parts) {
    for (std::size_t p = next.size(); p < all.size(); ++p) next.push_back(divide(all[p], corners));
    const auto most = static_cast<std::size_t>(
        std::max_element(next.begin(), next.end(), [](const auto& a, const auto& b) { return a.saved < b.saved; }) -
        next.begin());
    if (next[most].saved <= least) break;
    auto halves = std::move(next[most].halves);
    all.erase(all.begin() + static_cast<std::ptrdiff_t>(most)),
        next.erase(next.begin() + static_cast<std::ptrdiff_t>(most));
    for (Part& half : halves) all.push_back(std::move(half));
  }
  std::vector<TriangleMesh> hulls;
  for (Part& part : all) hulls.push_back(std::move(part.hull));
  return hulls;
}

}  // namespace geo
