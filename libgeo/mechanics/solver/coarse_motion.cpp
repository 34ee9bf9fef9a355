#include "mechanics/solver/coarse_motion.h"

#include <algorithm>

#include "kerf/parallel.h"
#include "mechanics/solver/coarse_lanes.h"

namespace geo {
namespace {

// What a block of points has for the groups of its nodes.
struct BlockTiles {
  std::vector<std::uint32_t> groups;  // ascending
  std::vector<float> tiles;           // of pairs s ≥ t at s (s + 1) / 2 + t
};

// Of the coarse motions in the sum of both levels. Patches overlap, so that all of them have a part in motions of large
// parts, too; with all of the coarse ones added to it, what is farthest from 1 is too long. Fewest products at 0.35 to
// 0.4, a tenth to a fifth fewer than at 1.
constexpr float share = 0.4f;

bool is_zero(const float* tiles) {
  return std::all_of(tiles, tiles + tile, [](float x) { return x == 0; });
}

}  // namespace

CoarseMotion::CoarseMotion(const NodeGroups& groups, const std::vector<Vec3>& at,
                           const std::vector<std::uint8_t>& fixed)
    : groups_(groups), first_(groups.count() + 1, 0), arm_(at.size(), Vec3::Zero()), free_(at.size()), matrix_({}) {
  std::vector<Vec3> middle(groups.count(), Vec3::Zero());
  for (std::size_t i = 0; i < at.size(); ++i) {
    free_[i] = fixed.empty() || !fixed[i];
    if (free_[i]) ++first_[groups.of[i] + 1], middle[groups.of[i]] += at[i];
  }
  for (std::size_t g = 0; g < middle.size(); ++g) {
    if (first_[g + 1] > 0) middle[g] /= first_[g + 1];
    first_[g + 1] += first_[g];
  }
  member_.resize(first_.back());
  std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
  for (std::uint32_t i = 0; i < at.size(); ++i)
    if (free_[i]) member_[next[groups.of[i]]++] = i, arm_[i] = at[i] - middle[groups.of[i]];
}

void CoarseMotion::factor(const MaterialPoints& points, const std::vector<StiffnessModes>& modes,
                          const std::vector<std::vector<float>>& weight, std::span<const Moduli> moduli,
                          std::size_t stride, const std::vector<Mat3>& blocks) {
  std::vector<BlockTiles> parts(points.blocks.size());
  parallel_for(parts.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t b = begin; b < end; ++b) {
      const PointBlock& block = points.blocks[b];
      BlockTiles& part = parts[b];
      for (const auto j : block.nodes) part.groups.push_back(groups_.of[j]);
      std::sort(part.groups.begin(), part.groups.end());
      part.groups.erase(std::unique(part.groups.begin(), part.groups.end()), part.groups.end());
      std::vector<std::uint16_t> slot;
      std::vector<float> arm;
      for (const auto j : block.nodes) {
        slot.push_back(static_cast<std::uint16_t>(
            std::lower_bound(part.groups.begin(), part.groups.end(), groups_.of[j]) - part.groups.begin()));
        const auto numbers = arm_numbers(arm_[j], free_[j]);
        arm.insert(arm.end(), numbers.begin(), numbers.end());
      }
      part.tiles.assign(tile * part.groups.size() * (part.groups.size() + 1) / 2, 0);
      rigid_stiffness(block, modes[b], weight[b], moduli, stride, slot, arm.data(), part.tiles.data());
    }
  });
  const auto each_tile = [&](const auto& work) {
    for (const BlockTiles& part : parts) {
      const float* at = part.tiles.data();
      for (std::size_t s = 0; s < part.groups.size(); ++s)
        for (std::size_t t = 0; t <= s; ++t, at += tile)
          if (!is_zero(at)) work(part.groups[s], part.groups[t], at);
    }
  };
  std::vector<std::size_t> last(groups_.count(), 0);
  each_tile([&](std::size_t s, std::size_t t, const float*) { last[t] = std::max(last[t], s); });
  matrix_ = BandFactor(last);
  each_tile([&](std::size_t s, std::size_t t, const float* at) {
    for (std::size_t m = 0; m < 6; ++m)
      for (std::size_t k = 0; k < (s == t ? m + 1 : 6); ++k) matrix_.at(6 * t + k, 6 * s + m) += at[8 * m + mode_at(k)];
  });
  parallel_for(groups_.count(), 8, [&](std::size_t begin, std::size_t end) {
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
  matrix_.factor();
}

void CoarseMotion::solve(const std::vector<Vec3>& r, const StepParts& parts) {
  values_.assign(6 * groups_.count(), 0.0f);
  parallel_for(groups_.count(), 32, [&](std::size_t begin, std::size_t end) {
    for (std::size_t g = begin; g < end; ++g) {
      if (first_[g] == first_[g + 1] || !parts.chosen()[parts.of(member_[first_[g]])]) continue;
      Vec3 force = Vec3::Zero(), torque = Vec3::Zero();
      for (auto k = first_[g]; k < first_[g + 1]; ++k)
        force += r[member_[k]], torque += arm_[member_[k]].cross(r[member_[k]]);
      for (int k = 0; k < 3; ++k)
        values_[6 * g + static_cast<std::size_t>(k)] = float(force[k]),
                        values_[6 * g + 3 + static_cast<std::size_t>(k)] = float(torque[k]);
    }
  });
  matrix_.solve(values_.data());
  for (float& v : values_) v *= share;
}

}  // namespace geo
