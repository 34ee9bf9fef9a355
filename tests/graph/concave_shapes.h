// Prisms in which shortest paths are known: as long as a path in the polygon below and the height
// climbed demand.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <string>
#include <vector>

#include "base/random.h"
#include "graph/guide_placement.h"
#include "kerf/mesh.h"
#include "kerf/nodes.h"

using Point2 = std::array<double, 2>;

/// The walls over a polygon, counter-clockwise, of height 1; a crack is a pair of walls in one
/// place.
struct Prism {
  std::string name;
  std::vector<Point2> polygon;
  std::vector<std::size_t> concave;  ///< corners where paths may bend
};

inline std::vector<Prism> concave_prisms() {
  return {{"L", {{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}}, {3}},
          {"notch", {{0, 0}, {2, 0}, {2, 2}, {1.4, 2}, {1, 1}, {0.6, 2}, {0, 2}}, {4}},
          {"slit", {{0, 0}, {2, 0}, {2, 2}, {1.01, 2}, {1, 1}, {0.99, 2}, {0, 2}}, {4}},
          {"crack", {{0, 0}, {2, 0}, {2, 2}, {1, 2}, {1, 1}, {1, 2}, {0, 2}}, {4}},
          {"slot", {{0, 0}, {2, 0}, {2, 2}, {1.05, 2}, {1.05, 1}, {0.95, 1}, {0.95, 2}, {0, 2}}, {4, 5}}};
}

inline geo::TriangleMesh walls_of(const Prism& prism) {
  geo::TriangleMesh mesh;
  const auto n = static_cast<std::uint32_t>(prism.polygon.size());
  for (const double z : {0.0, 1.0})
    for (const auto& p : prism.polygon) mesh.vertices.push_back({p[0], p[1], z});
  for (std::uint32_t k = 0; k < n; ++k) {
    const auto next = (k + 1) % n;
    mesh.triangles.push_back({k, next, n + next});
    mesh.triangles.push_back({k, n + next, n + k});
  }
  return mesh;
}

/// The edges between two triangles of a mesh.
inline std::vector<geo::SurfaceEdge> edges_of(const geo::TriangleMesh& mesh) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::vector<std::pair<std::uint32_t, std::size_t>>> halves;
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k)
      halves[std::minmax(mesh.triangles[t][k], mesh.triangles[t][(k + 1) % 3])].push_back({t, k});
  std::vector<geo::SurfaceEdge> edges;
  for (const auto& entry : halves) {
    const auto& at = entry.second;
    if (at.size() != 2) continue;
    const auto corner = [&](std::size_t half, std::size_t k) {
      return mesh.vertices[mesh.triangles[at[half].first][(at[half].second + k) % 3]];
    };
    edges.push_back({corner(0, 0), corner(0, 1), corner(0, 2), corner(1, 2)});
  }
  return edges;
}

class PrismPaths {
 public:
  explicit PrismPaths(const Prism& prism) : prism_(prism) {}
  /// Whether no wall lies across the way between two points, which are in the polygon or are its
  /// corners.
  bool clear(const Point2& p, const Point2& q) const {
    const auto& c = prism_.polygon;
    for (std::size_t k = 0; k < c.size(); ++k) {
      const auto &a = c[k], &b = c[(k + 1) % c.size()];
      if (turn(p, q, a) * turn(p, q, b) < 0 && turn(a, b, p) * turn(a, b, q) < 0) return false;
    }
    return true;
  }
  /// The length of the shortest path inside.
  double length(const geo::Vec3& p, const geo::Vec3& q) const {
    const Point2 from{p.x(), p.y()}, to{q.x(), q.y()};
    double best = clear(from, to) ? distance(from, to) : std::numeric_limits<double>::infinity();
    for (const auto i : prism_.concave)
      for (const auto j : prism_.concave) {
        const auto &a = prism_.polygon[i], &b = prism_.polygon[j];
        if (clear(from, a) && clear(a, b) && clear(b, to))
          best = std::min(best, distance(from, a) + distance(a, b) + distance(b, to));
      }
    return std::hypot(best, p.z() - q.z());
  }
  bool inside(const Point2& p, double margin) const {
    const auto& c = prism_.polygon;
    bool in = false;
    for (std::size_t k = 0; k < c.size(); ++k) {
      const auto &a = c[k], &b = c[(k + 1) % c.size()];
      const double lx = b[0] - a[0], ly = b[1] - a[1];
      const double t = std::clamp(((p[0] - a[0]) * lx + (p[1] - a[1]) * ly) / (lx * lx + ly * ly), 0.0, 1.0);
      if (std::hypot(p[0] - a[0] - t * lx, p[1] - a[1] - t * ly) < margin) return false;
      if ((a[1] > p[1]) != (b[1] > p[1]) && p[0] < a[0] + (p[1] - a[1]) / ly * lx) in = !in;
    }
    return in;
  }

 private:
  static double turn(const Point2& a, const Point2& b, const Point2& c) {
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
  }
  static double distance(const Point2& a, const Point2& b) { return std::hypot(a[0] - b[0], a[1] - b[1]); }
  const Prism& prism_;
};

/// Errors of distances, relative to the exact ones.
struct ConcaveErrors {
  std::size_t count = 0, missed = 0;  ///< pairs, and those too far apart by the graph to be neighbours
  double sum = 0, worst = 0, least = 0;
  double mean() const { return count == 0 ? 0 : sum / double(count); }
  void add(double distance, double exact, double radius) {
    const double error = distance / exact - 1;
    ++count;
    missed += distance >= radius;
    sum += error;
    worst = std::max(worst, error);
    least = std::min(least, error);
  }
};

/// Jittered nodes in a prism, `across` of them a unit, a sixth of their spacing or more off its
/// walls; supports of 2.4 spacings.
inline geo::NodeSet nodes_in(const Prism& prism, int across, std::uint64_t seed) {
  geo::Random random(seed);
  const PrismPaths paths(prism);
  geo::NodeSet nodes;
  const double h = 1.0 / across;
  for (int k = 0; k < across; ++k)
    for (int j = 0; j < 2 * across; ++j)
      for (int i = 0; i < 2 * across; ++i) {
        geo::Vec3 p(i + 0.5, j + 0.5, k + 0.5);
        for (int d = 0; d < 3; ++d) p[d] = h * (p[d] + random.uniform(-0.15, 0.15));
        if (paths.inside({p.x(), p.y()}, h / 6)) nodes.position.push_back(p);
      }
  nodes.spacing.assign(nodes.position.size(), h);
  nodes.radius.assign(nodes.position.size(), 2.4 * h);
  nodes.volume.assign(nodes.position.size(), h * h * h);
  return nodes;
}
