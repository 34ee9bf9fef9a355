// A guide stands at distance `offset` from its edge, along the bisector −(u + v) / |u + v|. Here u
// and v are unit vectors across the edge within its two triangles. The angle outside the material
// is acos(u · v); the material spans 2π less that angle.
#include "graph/guide_placement.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "geometry/predicates.h"
#include "graph/graph_storage.h"
#include "kerf/error.h"

namespace geo {
namespace {

// Distance of guides from their edges, in spacings of the nodes. By the triangle inequality a path
// through a guide is at most twice that longer than through its edge: 3 % of a spacing. It is far
// above rounding, so that a guide is clearly inside the material.
constexpr double offset = 1.0 / 64;

// The unit vector that bisects the material around an edge. Empty unless the material spans 180
// degrees and `bend` (radians) more.
std::optional<Vec3> bisector_into_material(const SurfaceEdge& e, double bend) {
  const Vec3 along = (e.b - e.a).normalized();
  const auto across = [&](const Vec3& p) -> Vec3 { return ((p - e.a) - (p - e.a).dot(along) * along).normalized(); };
  const Vec3 u = across(e.c), v = across(e.d);
  const int above = orient3d(e.a, e.b, e.c, e.d);
  if (above < 0) return std::nullopt;
  // Triangles in a plane either go on or, at the front of a crack, lie on each other with the
  // material all around.
  if (above == 0 && u.dot(v) <= 0) return std::nullopt;
  const double air = std::acos(std::clamp(u.dot(v), -1.0, 1.0));
  if (above > 0 && std::numbers::pi - air < bend) return std::nullopt;
  return -(u + v).normalized();
}

}  // namespace

std::vector<Guide> place_guides(std::span<const SurfaceEdge> edges, const NodeSet& nodes, const NodeGrid& grid,
                                const std::function<bool(const Vec3&, const Vec3&)>& blocked,
                                const GuideOptions& options, const GuideSet& taken) {
  if (!(options.spacing >= 0.05 && options.spacing <= 10))
    throw InputError("guides: their spacing must be from 0.05 to 10");
  if (!(options.bend >= 1 && options.bend <= 180))
    throw InputError("guides: the bend of an edge must be from 1 to 180 degrees");
  std::vector<Guide> guides;
  GuideSet placed = taken;
  std::vector<std::uint32_t> near;
  const auto node_at = [&](const Vec3& p) {
    return grid.nearest(nodes.position, p, 1, ~0u, [](std::uint32_t) { return true; }).front();
  };
  for (const SurfaceEdge& edge : edges) {
    const auto into = bisector_into_material(edge, options.bend * std::numbers::pi / 180);
    if (!into) continue;
    const double gap = options.spacing * nodes.spacing[node_at(0.5 * (edge.a + edge.b))];
    const auto parts = static_cast<std::size_t>(std::ceil((edge.b - edge.a).norm() / gap));
    for (std::size_t k = 0; k < parts; ++k) {
      const Vec3 at = edge.a + (double(k) + 0.5) / double(parts) * (edge.b - edge.a);
      const auto node = node_at(at);
      const Vec3 p = at + offset * nodes.spacing[node] * *into;
      near.clear();
      placed.within(p, 0.5 * options.spacing * nodes.spacing[node], near);
      if (std::any_of(near.begin(), near.end(), [&](std::uint32_t g) { return !blocked(placed.position(g), p); }))
        continue;
      guides.push_back({p, nodes.radius[node]});
      placed.add(guides.back());
    }
  }
  return guides;
}

}  // namespace geo
