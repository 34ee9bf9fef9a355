#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>

#include "base/random.h"
#include "graph.h"

namespace bench {
namespace {

constexpr double slit = 0.03;  // half its opening angle
constexpr double pi = std::numbers::pi;

double reach(double theta, double phi) { return 1 + 0.08 * std::cos(8 * phi) * std::sin(theta); }

geo::TriangleMesh ribbed_ball() {
  constexpr int rows = 42, columns = 84, depth = 14;
  geo::TriangleMesh mesh;
  std::map<std::array<double, 3>, std::uint32_t> known;
  // A point at a share of the way from the axis to the skin.
  const auto vertex = [&](int i, int j, double share) {
    const double theta = pi * i / rows, phi = slit + (2 * pi - 2 * slit) * j / columns, r = reach(theta, phi);
    const bool pole = i == 0 || i == rows;
    const double rho = pole ? 0 : r * std::sin(theta) * share, z = pole ? (i == 0 ? 1 : -1) : r * std::cos(theta);
    std::array<double, 3> p{rho * std::cos(phi), rho * std::sin(phi), z};
    if (share == 0 || pole) p[0] = p[1] = 0;
    const auto [it, fresh] = known.try_emplace(p, static_cast<std::uint32_t>(mesh.vertices.size()));
    if (fresh) mesh.vertices.push_back({p[0], p[1], p[2]});
    return it->second;
  };
  const auto quad = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
    for (const auto& t : {std::array{a, b, c}, std::array{a, c, d}})
      if (t[0] != t[1] && t[1] != t[2] && t[2] != t[0]) mesh.triangles.push_back(t);
  };
  for (int i = 0; i < rows; ++i) {
    for (int j = 0; j < columns; ++j)
      quad(vertex(i, j, 1), vertex(i + 1, j, 1), vertex(i + 1, j + 1, 1), vertex(i, j + 1, 1));
    for (int k = 0; k < depth; ++k) {
      const double near = double(k) / depth, far = double(k + 1) / depth;
      quad(vertex(i, 0, near), vertex(i + 1, 0, near), vertex(i + 1, 0, far), vertex(i, 0, far));
      quad(vertex(i, columns, near), vertex(i, columns, far), vertex(i + 1, columns, far),
           vertex(i + 1, columns, near));
    }
  }
  return mesh;
}

bool inside(const geo::Vec3& p, double margin) {
  const double r = p.norm(), rho = std::hypot(p.x(), p.y());
  if (r < 1e-9 || rho < 1e-9) return false;
  const double phi = std::atan2(p.y(), p.x()), turn = std::abs(phi);
  // The mesh lies up to 0.012 within the smooth shape, between its corners.
  if (r > reach(std::acos(p.z() / r), phi) - 0.012 - margin || turn < slit) return false;
  return rho * std::sin(std::min(turn - slit, pi / 2)) > margin;
}

std::uint64_t spread(std::uint64_t x) {
  std::uint64_t out = 0;
  for (int bit = 0; bit < 21; ++bit) out |= (x >> bit & 1) << (3 * bit);
  return out;
}

}  // namespace

GraphCase make_graph_case(std::size_t count) {
  GraphCase c;
  c.surface = ribbed_ball();
  double volume = 4.0;
  std::vector<geo::Vec3> points;
  for (int round = 0; round < 3; ++round) {
    c.spacing = std::cbrt(volume / double(count));
    points.clear();
    geo::Random random(7);
    const int half = static_cast<int>(1.15 / c.spacing) + 1;
    for (int k = -half; k <= half; ++k)
      for (int j = -half; j <= half; ++j)
        for (int i = -half; i <= half; ++i) {
          geo::Vec3 p(i + 0.5, j + 0.5, k + 0.5);
          for (int d = 0; d < 3; ++d) p[d] = c.spacing * (p[d] + random.uniform(-0.15, 0.15));
          if (inside(p, 0.25 * c.spacing)) points.push_back(p);
        }
    volume *= double(points.size()) / double(count);
  }
  std::vector<std::pair<std::uint64_t, std::uint32_t>> order;
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    const auto cell = [&](int d) { return spread(static_cast<std::uint64_t>((points[i][d] + 1.25) / 2.5 * 2097151)); };
    order.push_back({cell(0) | cell(1) << 1 | cell(2) << 2, i});
  }
  std::sort(order.begin(), order.end());
  for (const auto& [code, i] : order) c.nodes.position.push_back(points[i]);
  c.nodes.spacing.assign(points.size(), c.spacing);
  c.nodes.radius.assign(points.size(), 2.53 * c.spacing);
  c.nodes.volume.assign(points.size(), c.spacing * c.spacing * c.spacing);
  return c;
}

}  // namespace bench
