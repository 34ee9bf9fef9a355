// The first level of the preconditioner: patches of nodes, each solved for on its own while all others stand still, with the
// stiffness they have at rest turned to where they are (overlapping Schwarz; each node's share is spread over its patches).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "mechanics/node_patches.h"
#include "mechanics/stiffness_lanes.h"

namespace geo {

class PatchMotion {
 public:
  /// `modes`: rotations of points now; `moduli`: of an isotropic stiffness, per material; `blocks`: what nodes have besides;
  /// `fixed`: as in Environment. Keeps `materials` and `moduli`.
  PatchMotion(const NodePatches& patches, const Materials& materials, std::span<const Moduli> moduli, const std::vector<StiffnessModes>& modes,
              const std::vector<Mat3>& blocks, const std::vector<std::uint8_t>& fixed);
  /// Patches that have another block than before, with the rotations that they have.
  void renew(std::span<const std::uint32_t> which, const std::vector<Mat3>& blocks, const std::vector<std::uint8_t>& fixed);
  /// Inverses of the patches times r, each on its own; then their sum at a node.
  void solve(const std::vector<Vec3>& r, std::span<const std::uint32_t> patches);
  Vec3 at(std::size_t node) const {
    Vec3 sum = Vec3::Zero();
    for (const auto& place : patches_.patches_of(node)) sum += Eigen::Map<const Eigen::Vector3f>(&parts_[4 * (patches_.first(place.patch) + place.slot)]).cast<double>();
    return sum;
  }

 private:
  void invert(std::size_t patch, const std::vector<Mat3>& blocks, const std::vector<std::uint8_t>& fixed);
  const NodePatches& patches_;
  const Materials& materials_;
  std::span<const Moduli> moduli_;
  std::vector<Eigen::Matrix3f> rotation_;   // per patch
  std::vector<std::size_t> first_;          // per patch and one more
  std::vector<std::uint16_t> inverse_;      // upper halves of numbers
  std::vector<float> parts_;                // four numbers a node of a patch
};

}  // namespace geo
