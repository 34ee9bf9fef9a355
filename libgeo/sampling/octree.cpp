#include "sampling/octree.h"

#include <algorithm>
#include <cmath>
#include <unordered_set>

namespace geo {
namespace {

std::uint64_t spread(std::uint64_t x) {
  x &= 0x1fffff;
  x = (x | x << 32) & 0x1f00000000ffffull, x = (x | x << 16) & 0x1f0000ff0000ffull, x = (x | x << 8) & 0x100f00f00f00f00full;
  x = (x | x << 4) & 0x10c30c30c30c30c3ull, x = (x | x << 2) & 0x1249249249249249ull;
  return x;
}
std::uint64_t morton(const std::array<std::int32_t, 3>& c) {
  return spread(static_cast<std::uint64_t>(c[0])) | spread(static_cast<std::uint64_t>(c[1])) << 1 | spread(static_cast<std::uint64_t>(c[2])) << 2;
}

}  // namespace

std::vector<Cell> build_octree(const Box3& box, double size, int levels, const std::function<double(const Vec3&)>& depth) {
  const int top = levels - 1;
  const std::int32_t step = 1 << top;
  std::array<std::int32_t, 3> cells;
  for (int i = 0; i < 3; ++i) cells[i] = static_cast<std::int32_t>(std::ceil((box.hi[i] - box.lo[i]) / (size * step))) * step;
  // Leaves by level, as Morton codes of their corners.
  std::vector<std::unordered_set<std::uint64_t>> leaves(static_cast<std::size_t>(levels));
  std::vector<Cell> stack, found;
  for (std::int32_t z = 0; z < std::max(cells[2], step); z += step)
    for (std::int32_t y = 0; y < std::max(cells[1], step); y += step)
      for (std::int32_t x = 0; x < std::max(cells[0], step); x += step) stack.push_back({{x, y, z}, top});
  const auto divide = [](const Cell& c, const auto& each) {
    const std::int32_t half = 1 << (c.level - 1);
    for (int k = 0; k < 8; ++k)
      each(Cell{{c.corner[0] + (k & 1 ? half : 0), c.corner[1] + (k & 2 ? half : 0), c.corner[2] + (k & 4 ? half : 0)}, c.level - 1});
  };
  while (!stack.empty()) {
    const Cell c = stack.back();
    stack.pop_back();
    const double edge = size * double(1 << c.level);
    const Vec3 middle = box.lo + size * Vec3(c.corner[0], c.corner[1], c.corner[2]) + Vec3::Constant(0.5 * edge);
    const double d = depth(middle);
    if (d < -0.9 * edge) continue;  // farther out than half a diagonal: no material in it
    if (c.level > 0 && d < edge)
      divide(c, [&](const Cell& part) { stack.push_back(part); });
    else
      leaves[static_cast<std::size_t>(c.level)].insert(morton(c.corner)), found.push_back(c);
  }
  // Balance: a leaf of level l wants no leaf of level l + 2 or more beside it.
  for (std::size_t at = 0; at < found.size(); ++at) {
    const Cell c = found[at];
    if (!leaves[static_cast<std::size_t>(c.level)].count(morton(c.corner))) continue;  // divided since
    for (int dx = -1; dx <= 1; ++dx)
      for (int dy = -1; dy <= 1; ++dy)
        for (int dz = -1; dz <= 1; ++dz)
          for (int level = c.level + 2; level <= top; ++level) {
            const std::int32_t reach = 1 << c.level;
            std::array<std::int32_t, 3> p{c.corner[0] + dx * reach, c.corner[1] + dy * reach, c.corner[2] + dz * reach};
            if (p[0] < 0 || p[1] < 0 || p[2] < 0) continue;
            for (auto& x : p) x &= ~((1 << level) - 1);
            if (!leaves[static_cast<std::size_t>(level)].erase(morton(p))) continue;
            divide({p, level}, [&](const Cell& part) {
              leaves[static_cast<std::size_t>(part.level)].insert(morton(part.corner));
              found.push_back(part);
            });
            found.push_back(c);  // look again: its neighbour may still be too coarse
          }
  }
  std::sort(found.begin(), found.end(), [](const Cell& a, const Cell& b) {
    const auto ma = morton(a.corner), mb = morton(b.corner);
    return ma != mb ? ma < mb : a.level < b.level;
  });
  std::vector<Cell> result;
  for (const Cell& c : found)
    if (leaves[static_cast<std::size_t>(c.level)].erase(morton(c.corner))) result.push_back(c);
  return result;
}

}  // namespace geo
