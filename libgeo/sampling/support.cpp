// r_i = max(support · min(s_i, Σ s² / Σ s), 1.05 · min(d_12, 3 s_i)). Sums run over node i and its
// twelve nearest nodes; d_12 is the distance of the twelfth, infinite if fewer are near.
#include "sampling/support.h"

#include <algorithm>
#include <cmath>

#include "kerf/parallel.h"

namespace geo {
namespace {

constexpr std::size_t dozen = 12;

struct Near {
  double squared;
  std::uint32_t row;
  bool operator<(const Near& b) const { return squared != b.squared ? squared < b.squared : row < b.row; }
};

/// The twelve nodes nearest to node i within four spacings; fewer if there are fewer.
void find_dozen(const NodeSet& nodes, const LeafIndex& leaves, std::size_t i, std::vector<Near>& near) {
  const Cell cell = leaves.cell(i);
  // Cells one level coarser cover two spacings, which nearly always suffices; two levels, four.
  for (int up = 1; up <= 2; ++up) {
    near.clear();
    const double reach = up * 2 * nodes.spacing[i];
    leaves.around(cell, cell.level + up, [&](std::uint32_t row) {
      const double d = (nodes.position[row] - nodes.position[i]).squaredNorm();
      if (d <= reach * reach && row != i) near.push_back({d, row});
    });
    if (near.size() >= dozen) break;
  }
  if (near.size() <= dozen) return;
  std::nth_element(near.begin(), near.begin() + dozen - 1, near.end());
  near.resize(dozen);
  std::sort(near.begin(), near.end());  // sums in one order, whatever the standard library
}

}  // namespace

void set_support_radii(NodeSet& nodes, const LeafIndex& leaves, double support, const Progress& progress) {
  nodes.radius.resize(nodes.size());
  const std::size_t share = std::max<std::size_t>(1 << 16, nodes.size() / 64);
  for (std::size_t first = 0; first < nodes.size(); first += share) {
    report(progress, "support", first, nodes.size());
    parallel_for(std::min(share, nodes.size() - first), 256, [&](std::size_t begin, std::size_t end) {
      std::vector<Near> near;
      for (std::size_t i = first + begin; i < first + end; ++i) {
        find_dozen(nodes, leaves, i, near);
        const double own = nodes.spacing[i];
        double sum = own, squares = own * own, squared = 0;
        for (const Near& n : near) {
          sum += nodes.spacing[n.row];
          squares += nodes.spacing[n.row] * nodes.spacing[n.row];
          squared = std::max(squared, n.squared);
        }
        const double reach =
            near.size() < std::min(dozen, nodes.size() - 1) ? 3 * own : std::min(std::sqrt(squared), 3 * own);
        // 5 % more than the distance of the twelfth node, which then lies strictly within the
        // radius.
        nodes.radius[i] = std::max(support * std::min(own, squares / sum), 1.05 * reach);
      }
    });
  }
}

}  // namespace geo
