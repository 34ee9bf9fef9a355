// find_thin_material() of kerf/nodes.h: a ray goes inwards from the middle of each triangle to the
// other side of its wall.
#include <algorithm>
#include <cmath>

#include "kerf/nodes.h"
#include "kerf/parallel.h"
#include "sampling/node_grid.h"
#include "sampling/thickness.h"

namespace geo {

ThinMaterial find_thin_material(const TriangleMesh& solid, const NodeSet& nodes, double across) {
  constexpr std::size_t max_triangles = 4096;
  constexpr double enough = 0.999;  // a spacing that is rounded to four digits suffices
  ThinMaterial thin;
  if (solid.triangles.empty() || nodes.size() == 0) return thin;
  const RegionTree tree(solid);
  const NodeGrid grid(nodes.spacing[0], nodes.position);
  const std::size_t step = 1 + solid.triangles.size() / max_triangles;
  struct Place {
    Wall wall;
    double spacing;
  };
  std::vector<Place> places((solid.triangles.size() + step - 1) / step);
  parallel_for(places.size(), 64, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const auto t = static_cast<std::uint32_t>(i * step);
      const auto& [a, b, c] = tree.corners(t);
      const auto near = grid.nearest(nodes.position, (a + b + c) / 3, 1, ~0u, [](std::uint32_t) { return true; });
      const double spacing = nodes.spacing[near[0]];
      places[i] = {.wall = wall_behind(tree, t, enough * across * spacing), .spacing = spacing};
    }
  });
  double area = 0;
  for (const Place& p : places) area += p.wall.area;
  std::erase_if(places, [](const Place& p) { return !std::isfinite(p.wall.thickness); });
  if (places.empty()) return thin;
  std::sort(places.begin(), places.end(),
            [](const Place& p, const Place& q) { return p.wall.thickness < q.wall.thickness; });
  double thin_area = 0;
  for (const Place& p : places) thin_area += p.wall.area;
  double thinner = 0;
  const auto half = std::find_if(places.begin(), places.end(), [&](const Place& p) {
    thinner += p.wall.area;
    return thinner >= 0.5 * thin_area;
  });
  const Place& typical = half == places.end() ? places.back() : *half;
  return {.share = thin_area / area,
          .thickness = typical.wall.thickness,
          .spacing = typical.spacing,
          .at = typical.wall.at,
          .enough = typical.wall.thickness / across};
}

}  // namespace geo
