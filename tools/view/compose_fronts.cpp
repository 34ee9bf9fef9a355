// add_seams() and add_fronts() of view/compose_parts.h. Seams and crack fronts are edges of the
// derived surface, distinguished by the patches of their two triangles: skin and crack, or the two
// sides of one crack.
#include <map>

#include "view/compose_parts.h"

namespace view {

using geo::Vec3;

void add_seams(Stage& stage) {
  const geo::TriangleMesh& mesh = stage.surface;
  if (mesh.patch.empty()) return;
  // Patches of the two triangles at each edge of the derived surface.
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::vector<std::int32_t>> patches;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k)
      patches[std::minmax(mesh.triangles[t][k], mesh.triangles[t][(k + 1) % 3])].push_back(mesh.patch[t]);
  const double width = 0.0028 * geo::bounding_box(mesh).diagonal();
  for (const auto& [edge, at] : patches) {
    if (at.size() != 2) continue;
    const bool seam = (at[0] == 0) != (at[1] == 0), tip = at[0] != 0 && at[0] == -at[1];
    if (seam)
      stage.sticks.push_back({.a = mesh.vertices[edge.first],
                              .b = mesh.vertices[edge.second],
                              .radius = width,
                              .color = Color{0.01f, 0.45f, 0.08f}});
    if (tip)
      stage.sticks.push_back({.a = mesh.vertices[edge.first],
                              .b = mesh.vertices[edge.second],
                              .radius = width,
                              .color = Color{0.75f, 0.02f, 0.02f}});
  }
}

void add_fronts(Stage& stage, const std::vector<geo::Front>& fronts, const Look& look) {
  geo::Box3 box = geo::bounding_box(stage.surface);
  for (const auto& front : fronts)
    for (const auto& step : front.steps)
      for (const auto& p : step) box.add(p);
  const double width = 0.002 * box.diagonal();
  for (const auto& front : fronts)
    for (std::size_t s = look.first_step; s < front.steps.size() && s <= look.last_step; ++s) {
      const auto& points = front.steps[s];
      const Color color = viridis(front.steps.size() > 1 ? double(s) / double(front.steps.size() - 1) : 0);
      const std::size_t n = points.size();
      for (std::size_t i = 0; i + (front.closed ? 0 : 1) < n; ++i)
        stage.sticks.push_back({.a = points[i], .b = points[(i + 1) % n], .radius = width, .color = color});
      if (s + 1 < front.steps.size() && s + 1 <= look.last_step && front.steps[s + 1].size() == n)
        for (std::size_t i = 0; i < n; ++i)
          stage.sticks.push_back(
              {.a = points[i], .b = front.steps[s + 1][i], .radius = 0.4 * width, .color = Color{0.4f, 0.4f, 0.42f}});
    }
}

}  // namespace view
