// An aggregate moves by u_i = t + ω × a_i, a_i the arm from its centre. Pᵀ K P is summed in tiles
// of 6×6 per pair of aggregates, within each block of points in parallel, then over blocks in
// order.
#include "mechanics/solver/coarse_correction.h"

#include <algorithm>

#include "kerf/parallel.h"
#include "mechanics/solver/coarse_lanes.h"

namespace geo {
namespace {

// Relaxation of the coarse correction in the sum of both levels. Overlapping subdomains move large
// parts, too; with the whole coarse correction added, the largest eigenvalue of the preconditioned
// matrix grows. Measured: fewest iterations at 0.35 to 0.4, a tenth to a fifth fewer than at 1
// (docs/decisions/045).
constexpr float relaxation = 0.4f;

bool is_zero(const float* tile_numbers) {
  return std::all_of(tile_numbers, tile_numbers + tile, [](float x) { return x == 0; });
}

}  // namespace

// The contribution of one block's points to the matrix.
struct CoarseCorrection::BlockTiles {
  std::vector<std::uint32_t> aggregates;  // ascending
  std::vector<float> tiles;               // of pairs s ≥ t of indices there, at s (s + 1) / 2 + t
};

CoarseCorrection::CoarseCorrection(const Aggregates& aggregates, const std::vector<Vec3>& at,
                                   const std::vector<std::uint8_t>& fixed)
    : aggregates_(aggregates),
      first_(aggregates.count() + 1, 0),
      arm_(at.size(), Vec3::Zero()),
      free_(at.size()),
      matrix_({}) {
  std::vector<Vec3> centre(aggregates.count(), Vec3::Zero());
  for (std::size_t i = 0; i < at.size(); ++i) {
    free_[i] = fixed.empty() || !fixed[i];
    if (free_[i]) {
      ++first_[aggregates.of[i] + 1];
      centre[aggregates.of[i]] += at[i];
    }
  }
  for (std::size_t g = 0; g < centre.size(); ++g) {
    if (first_[g + 1] > 0) centre[g] /= first_[g + 1];
    first_[g + 1] += first_[g];
  }
  member_.resize(first_.back());
  std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
  for (std::uint32_t i = 0; i < at.size(); ++i)
    if (free_[i]) {
      member_[next[aggregates.of[i]]++] = i;
      arm_[i] = at[i] - centre[aggregates.of[i]];
    }
}

CoarseCorrection::BlockTiles CoarseCorrection::block_tiles(const PointBlock& block, std::size_t b,
                                                           const PointStiffness& stiffness,
                                                           std::span<const Moduli> moduli, std::size_t stride) const {
  BlockTiles result;
  if (stiffness.modes[b].points == 0) return result;  // all of it sleeps
  std::vector<std::uint32_t>& own = result.aggregates;
  for (const auto j : block.nodes) own.push_back(aggregates_.of[j]);
  std::sort(own.begin(), own.end());
  own.erase(std::unique(own.begin(), own.end()), own.end());
  std::vector<std::uint16_t> slot;
  std::vector<float> arm;
  for (const auto j : block.nodes) {
    slot.push_back(
        static_cast<std::uint16_t>(std::lower_bound(own.begin(), own.end(), aggregates_.of[j]) - own.begin()));
    const auto numbers = arm_numbers(arm_[j], free_[j]);
    arm.insert(arm.end(), numbers.begin(), numbers.end());
  }
  result.tiles.assign(tile * own.size() * (own.size() + 1) / 2, 0);
  rigid_stiffness(
      {.block = block, .modes = stiffness.modes[b], .weight = stiffness.weight[b], .moduli = moduli, .stride = stride},
      slot, arm.data(), result.tiles.data());
  return result;
}

void CoarseCorrection::factor(const MaterialPoints& points, const PointStiffness& stiffness,
                              std::span<const Moduli> moduli, std::size_t stride, const std::vector<Mat3>& blocks) {
  std::vector<BlockTiles> block_sums(points.blocks.size());
  parallel_for(block_sums.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t b = begin; b < end; ++b)
      block_sums[b] = block_tiles(points.blocks[b], b, stiffness, moduli, stride);
  });
  const auto each_tile = [&](const auto& work) {
    for (const BlockTiles& sums : block_sums) {
      const float* at = sums.tiles.data();
      for (std::size_t s = 0; s < sums.aggregates.size(); ++s)
        for (std::size_t t = 0; t <= s; ++t, at += tile)
          if (!is_zero(at)) work(sums.aggregates[s], sums.aggregates[t], at);
    }
  };
  std::vector<std::size_t> last(aggregates_.count(), 0);
  each_tile([&](std::size_t s, std::size_t t, const float*) { last[t] = std::max(last[t], s); });
  matrix_ = BandCholesky(last);
  each_tile([&](std::size_t s, std::size_t t, const float* at) {
    for (std::size_t m = 0; m < 6; ++m)
      for (std::size_t k = 0; k < (s == t ? m + 1 : 6); ++k) matrix_.at(6 * t + k, 6 * s + m) += at[8 * m + mode_at(k)];
  });
  add_nodal_blocks(blocks);
  matrix_.factor();
}

void CoarseCorrection::add_nodal_blocks(const std::vector<Mat3>& blocks) {
  parallel_for(aggregates_.count(), 8, [&](std::size_t begin, std::size_t end) {
    for (std::size_t g = begin; g < end; ++g) {
      Eigen::Matrix<double, 6, 6> sum = Eigen::Matrix<double, 6, 6>::Zero();
      for (auto k = first_[g]; k < first_[g + 1]; ++k) {
        Eigen::Matrix<double, 3, 6> rigid;
        rigid.leftCols<3>().setIdentity();
        for (int m = 0; m < 3; ++m) rigid.col(3 + m) = Vec3::Unit(m).cross(arm_[member_[k]]);
        sum += rigid.transpose() * blocks[member_[k]] * rigid;
      }
      for (int m = 0; m < 6; ++m)
        for (int k = 0; k <= m; ++k)
          matrix_.at(6 * g + static_cast<std::size_t>(k), 6 * g + static_cast<std::size_t>(m)) += float(sum(k, m));
    }
  });
}

void CoarseCorrection::solve(const std::vector<Vec3>& r, const ActiveIslands& active) {
  motion_.assign(6 * aggregates_.count(), 0.0f);
  parallel_for(aggregates_.count(), 32, [&](std::size_t begin, std::size_t end) {
    for (std::size_t g = begin; g < end; ++g) {
      if (first_[g] == first_[g + 1] || !active[active.islands().of(member_[first_[g]])]) continue;
      Vec3 force = Vec3::Zero(), torque = Vec3::Zero();
      for (auto k = first_[g]; k < first_[g + 1]; ++k) {
        force += r[member_[k]];
        torque += arm_[member_[k]].cross(r[member_[k]]);
      }
      for (int k = 0; k < 3; ++k) {
        motion_[6 * g + static_cast<std::size_t>(k)] = float(force[k]);
        motion_[6 * g + 3 + static_cast<std::size_t>(k)] = float(torque[k]);
      }
    }
  });
  matrix_.solve(motion_.data());
  for (float& v : motion_) v *= relaxation;
}

}  // namespace geo
