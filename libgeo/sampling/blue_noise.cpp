// Simultaneous relaxation: p_i ← p_i + ½ Σ_j (w_ij / d_ij − 1) (p_i − p_j), with d_ij = |p_i − p_j|
// and w_ij = (s_i + s_j) / 2. The sum runs over j with d_ij < w_ij. Then p_i is clamped to the
// inner box of its leaf.
#include "sampling/blue_noise.h"

#include "kerf/parallel.h"
#include "sampling/leaves.h"

namespace geo {

void move_apart(NodeSet& nodes, const LeafIndex& leaves, const Lattice& lattice, const std::vector<char>& free,
                const Progress& progress) {
  // More steps give a more even pattern at proportional cost. Half of each overlap goes to each
  // node of a pair (strength).
  constexpr int steps = 8;
  constexpr double strength = 0.5, range = 0.5 - keep_off;
  std::vector<Vec3> moved(nodes.size());
  for (int step = 0; step < steps; ++step) {
    report(progress, "blue noise", static_cast<std::size_t>(step), steps);
    parallel_for(nodes.size(), 256, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        const Vec3& p = moved[i] = nodes.position[i];
        if (!free[i]) continue;
        const Cell cell = leaves.cell(i);
        Vec3 shift = Vec3::Zero();
        leaves.around(cell, cell.level, [&](std::uint32_t row) {
          const double wanted = 0.5 * (nodes.spacing[i] + nodes.spacing[row]), d = (p - nodes.position[row]).norm();
          if (row != i && d > 0 && d < wanted) shift += (wanted / d - 1) * (p - nodes.position[row]);
        });
        const Vec3 middle = lattice.middle(cell), reach = Vec3::Constant(range * nodes.spacing[i]);
        moved[i] = (p + strength * shift).cwiseMax(middle - reach).cwiseMin(middle + reach);
      }
    });
    nodes.position.swap(moved);
  }
}

}  // namespace geo
