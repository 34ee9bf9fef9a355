#include "graph/place_guides.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <tuple>

#include "base/error.h"
#include "geometry/predicates.h"
#include "sampling/node_grid.h"

namespace geo {
namespace {

constexpr double beside = 1.0 / 64;  // of the nodes' spacing: how far guides stand from their edges

struct ConcaveEdge {
  Vec3 a, b;
  Vec3 into;  // of unit length, halves the material around it
};

// The edge ab of triangles abc and bad, unless the material there spans less than 180 degrees and `bend`, in radians, more.
std::optional<ConcaveEdge> concave_edge(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d, double bend) {
  const Vec3 along = (b - a).normalized();
  const auto across = [&](const Vec3& p) -> Vec3 { return ((p - a) - (p - a).dot(along) * along).normalized(); };
  const Vec3 u = across(c), v = across(d);
  // Triangles that lie on each other are the two sides of a crack at its front, with the material all around.
  const int above = orient3d(a, b, c, d);
  const double air = std::acos(std::clamp(u.dot(v), -1.0, 1.0));
  if (above < 0 || (above == 0 && u.dot(v) <= 0) || (above > 0 && std::numbers::pi - air < bend)) return std::nullopt;
  return ConcaveEdge{a, b, -(u + v).normalized()};
}

// By edge, then by triangle.
struct Half {
  std::uint32_t lo, hi, triangle, corner;
  auto key() const { return std::pair(lo, hi); }
};

}  // namespace

std::vector<Guide> place_guides(const TriangleMesh& surface, const NodeSet& nodes, const NodeGrid& grid, const TriangleBvh& obstacles,
                                const GuideOptions& options) {
  if (!(options.spacing >= 0.05 && options.spacing <= 10)) throw InputError("guides: their spacing must be from 0.05 to 10");
  if (!(options.bend >= 1 && options.bend <= 180)) throw InputError("guides: the bend of an edge must be from 1 to 180 degrees");
  std::vector<Half> halves;
  for (std::uint32_t t = 0; t < surface.triangles.size(); ++t)
    for (std::uint32_t k = 0; k < 3; ++k) {
      const auto a = surface.triangles[t][k], b = surface.triangles[t][(k + 1) % 3];
      halves.push_back({std::min(a, b), std::max(a, b), t, k});
    }
  std::sort(halves.begin(), halves.end(), [](const Half& p, const Half& q) { return std::tie(p.lo, p.hi, p.triangle) < std::tie(q.lo, q.hi, q.triangle); });

  std::vector<Guide> guides;
  GuideSet placed;
  std::vector<std::uint32_t> near;
  const auto any = [](std::uint32_t) { return true; };
  for (std::size_t e = 0; e + 1 < halves.size(); ++e) {
    if (halves[e].key() != halves[e + 1].key()) continue;
    const auto corner = [&](const Half& h, std::uint32_t k) -> const Vec3& { return surface.vertices[surface.triangles[h.triangle][(h.corner + k) % 3]]; };
    const Half &one = halves[e], &other = halves[e + 1];
    const auto edge = concave_edge(corner(one, 0), corner(one, 1), corner(one, 2), corner(other, 2), options.bend * std::numbers::pi / 180);
    if (!edge) continue;
    const auto node_at = [&](const Vec3& p) { return grid.nearest(nodes.position, p, 1, ~0u, any).front(); };
    const double gap = options.spacing * nodes.spacing[node_at(0.5 * (edge->a + edge->b))];
    const auto parts = static_cast<std::size_t>(std::ceil((edge->b - edge->a).norm() / gap));
    for (std::size_t k = 0; k < parts; ++k) {
      const Vec3 at = edge->a + (double(k) + 0.5) / double(parts) * (edge->b - edge->a);
      const auto node = node_at(at);
      const Vec3 p = at + beside * nodes.spacing[node] * edge->into;
      near.clear();
      placed.within(p, 0.5 * options.spacing * nodes.spacing[node], near);
      if (std::any_of(near.begin(), near.end(), [&](std::uint32_t g) { return !obstacles.blocks(placed.position(g), p); })) continue;
      guides.push_back({p, nodes.radius[node]});
      placed.add(guides.back());
    }
  }
  return guides;
}

}  // namespace geo
