#include "contact/surface/open_sheets.h"

#include <algorithm>
#include <cmath>

#include "contact/detection/close_pairs.h"
#include "kerf/crossing.h"

namespace geo {

std::size_t open_sheets(const ContactSurface& surface, const VertexFans& fans, const Copies& copies,
                        const std::vector<Vec3>& to, double gap, double opens, std::vector<Vec3>& positions) {
  const std::vector<Vec3> normals = vertex_normals(surface, fans, copies, positions);
  std::vector<std::uint32_t> opening;
  for (std::uint32_t v = 0; v < copies.size(); ++v)
    for (std::size_t i = 0; i < copies[v].size(); ++i)
      for (std::size_t j = i + 1; j < copies[v].size(); ++j) {
        const auto a = copies[v][i], b = copies[v][j];
        const Vec3 n = (normals[b].normalized() - normals[a].normalized()).normalized(), apart = to[a] - to[b];
        const double along = n.dot(apart);
        if ((along > opens || (apart - along * n).norm() > 3 * opens) && (opening.empty() || opening.back() != v))
          opening.push_back(v);
      }
  const std::size_t wanted = opening.size();
  if (wanted == 0) return 0;
  const std::vector<Vec3> closed = positions;
  // Triangles that may come together while none of these vertices goes further than half a gap.
  std::vector<std::uint8_t> moving(positions.size(), 0);
  for (const auto v : opening)
    for (const auto c : copies[v]) moving[c] = 1;
  std::vector<Box3> boxes(surface.triangles.size());
  std::vector<std::uint8_t> asked(boxes.size(), 0);
  Box3 region;
  for (std::size_t t = 0; t < boxes.size(); ++t) {
    const auto& [a, b, c] = surface.triangles[t];
    boxes[t] = box_of(positions[a], positions[b], positions[c]).grown(0.5 * gap);
    if (moving[a] || moving[b] || moving[c]) region.add(boxes[t]), asked[t] = 1;
  }
  for (Box3& box : boxes)
    if (!box.meets(region)) box = Box3();
  const auto pairs = close_pairs(boxes, &asked);
  // Smaller steps for those that would cross; what is left stays together.
  std::vector<Vec3> shared = shared_normals(surface, vertices_together(surface.site, positions), positions);
  for (std::size_t v = 0; v < shared.size(); ++v)
    if (shared[v].isZero(0)) shared[v] = normals[v];
  for (int trial = 0; !opening.empty() && trial < 10; ++trial) {
    const double step = std::ldexp(0.5 * gap, -2 * (trial / 2));
    std::vector<std::uint32_t> refused;
    std::vector<std::uint8_t> moved(positions.size(), 0), marked(surface.triangles.size(), 0), bad(positions.size(), 0);
    for (const auto v : opening)
      for (const auto c : copies[v])
        positions[c] -= step * (trial % 2 == 0 ? shared[c] : normals[c]).normalized(), moved[c] = 1;
    for (;;) {
      for (std::size_t t = 0; t < marked.size(); ++t)
        marked[t] =
            std::any_of(surface.triangles[t].begin(), surface.triangles[t].end(), [&](auto v) { return moved[v]; });
      const auto crossings = find_crossings(pairs, surface.triangles, positions,
                                            vertices_together(surface.site, positions), true, &marked);
      if (crossings.empty()) break;
      for (const auto& [s, t] : crossings)
        for (const auto& triangle : {surface.triangles[s], surface.triangles[t]})
          for (const auto v : triangle) bad[v] = 1;
      bool undone = false;
      for (const auto v : opening)
        if (std::any_of(copies[v].begin(), copies[v].end(), [&](auto c) { return bad[c] && moved[c]; })) {
          for (const auto c : copies[v]) positions[c] = closed[v], moved[c] = 0;
          refused.push_back(v), undone = true;
        }
      if (!undone) break;
    }
    opening.swap(refused);
  }
  // One after another, as the others' may have been in the way.
  auto together = vertices_together(surface.site, positions);
  std::vector<std::uint32_t> turn(positions.size(), ~0u);  // per vertex, whose it is
  for (std::uint32_t k = 0; k < opening.size(); ++k)
    for (const auto c : copies[opening[k]]) turn[c] = k;
  std::vector<std::vector<std::pair<std::uint32_t, std::uint32_t>>> pairs_about(opening.size());
  if (!opening.empty())
    for (const auto& pair : pairs)
      for (const auto t : {pair.first, pair.second})
        for (const auto c : surface.triangles[t])
          if (turn[c] != ~0u && (pairs_about[turn[c]].empty() || pairs_about[turn[c]].back() != pair))
            pairs_about[turn[c]].push_back(pair);
  std::erase_if(opening, [&](auto v) {
    const auto& about = pairs_about[turn[copies[v][0]]];
    for (int trial = 0; trial < 20; ++trial) {
      const double step = std::ldexp(0.5 * gap, -2 * (trial / 4));
      // Both, or one of them alone.
      for (const auto c : copies[v]) {
        const std::vector<Vec3>& along = trial % 4 < 2 ? shared : normals;
        positions[c] = trial % 2 == 1 && c == copies[v][0] ? closed[v] : Vec3(closed[v] - step * along[c].normalized());
        together[c] = c;
      }
      if (find_crossings(about, surface.triangles, positions, together, true).empty()) return true;
    }
    for (const auto c : copies[v]) positions[c] = closed[v], together[c] = v;
    return false;
  });
  return wanted - opening.size();
}

}  // namespace geo
