#include "score/partial.h"

#include <algorithm>
#include <numeric>
#include <unordered_map>

#include "base/error.h"
#include "base/parallel.h"

namespace geo {

void keep_shallow(TriangleMesh& walls, const TriangleBvh& skin, double depth) {
  if (!(depth > 0 && depth < 1)) throw InputError("the depth of a partial score must be above 0 and below 100 percent");
  const std::size_t count = walls.triangles.size();
  std::vector<double> deep(count, -1);  // below the skin; negative: outside
  parallel_for(count, 256, [&](std::size_t begin, std::size_t end) {
    for (std::size_t t = begin; t < end; ++t) {
      const auto& c = walls.triangles[t];
      const Vec3 middle = (walls.vertices[c[0]] + walls.vertices[c[1]] + walls.vertices[c[2]]) / 3;
      if (skin.inside(middle)) deep[t] = skin.closest(middle).distance;
    }
  });
  // Triangles inside that share an edge with each other only belong together.
  std::vector<std::uint32_t> root(count);
  std::iota(root.begin(), root.end(), 0u);
  const auto find = [&](std::uint32_t t) {
    while (root[t] != t) t = root[t] = root[root[t]];
    return t;
  };
  std::unordered_map<std::uint64_t, std::vector<std::uint32_t>> at;
  for (std::uint32_t t = 0; t < count; ++t)
    for (std::size_t k = 0; k < 3; ++k) {
      const auto a = walls.triangles[t][k], b = walls.triangles[t][(k + 1) % 3];
      at[std::uint64_t(std::min(a, b)) << 32 | std::max(a, b)].push_back(t);
    }
  for (const auto& [edge, pair] : at)
    if (pair.size() == 2 && deep[pair[0]] >= 0 && deep[pair[1]] >= 0) root[find(pair[0])] = find(pair[1]);
  std::vector<double> deepest(count, 0);
  for (std::uint32_t t = 0; t < count; ++t) deepest[find(t)] = std::max(deepest[find(t)], deep[t]);
  // Outside nothing is cut: what stays there goes with the shallow part that it hangs on.
  std::vector<char> keep(count);
  for (std::uint32_t t = 0; t < count; ++t) keep[t] = deep[t] >= 0 && deep[t] < depth * deepest[find(t)];
  for (bool more = true; more;) {
    more = false;
    for (const auto& [edge, around] : at)
      if (std::any_of(around.begin(), around.end(), [&](auto t) { return keep[t]; }))
        for (const auto t : around)
          if (!keep[t] && deep[t] < 0) keep[t] = more = true;
  }
  std::size_t kept = 0;
  for (std::size_t t = 0; t < count; ++t)
    if (keep[t]) walls.triangles[kept++] = walls.triangles[t];
  walls.triangles.resize(kept);
}

}  // namespace geo
