// The first level of the preconditioner: patches of nodes, each solved for on its own while all
// others stand still, with the stiffness they have at rest turned to where they are (overlapping
// Schwarz; each node's share is spread over its patches).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "mechanics/material/stiffness_lanes.h"
#include "mechanics/solver/node_patches.h"
#include "mechanics/solver/patch_inverses.h"
#include "mechanics/solver/patch_lanes.h"

namespace geo {

class PatchMotion {
 public:
  /// `modes`: rotations of points now; `moduli`: of an isotropic stiffness, per material; `blocks`:
  /// what nodes have besides; `fixed`: as in Environment. `inverses`: of an earlier step, of which
  /// those are left that are the same now. Keeps all but modes, blocks and fixed.
  PatchMotion(const NodePatches& patches, const Materials& materials, std::span<const Moduli> moduli,
              const std::vector<StiffnessModes>& modes, const std::vector<Mat3>& blocks,
              const std::vector<std::uint8_t>& fixed, PatchInverses& inverses);
  /// Patches that have another block than before, with the rotations that they have.
  void renew(std::span<const std::uint32_t> which, const std::vector<Mat3>& blocks,
             const std::vector<std::uint8_t>& fixed);
  /// Inverses of the patches times r, each on its own; then their sum at a node.
  void solve(const std::vector<Vec3>& r, std::span<const std::uint32_t> patches);
  Vec3 at(std::size_t node) const {
    Vec3 sum = Vec3::Zero();
    for (const auto& place : patches_.patches_of(node))
      sum += Eigen::Map<const Eigen::Vector3f>(&parts_[4 * (patches_.first(place.patch) + place.slot)]).cast<double>();
    return sum;
  }

 private:
  void besides(std::size_t patch, const std::vector<Mat3>& blocks, const std::vector<std::uint8_t>& fixed,
               std::vector<PatchInverses::Besides>& all) const;
  const Moduli& moduli_of(std::size_t patch) const { return moduli_[materials_.index(patches_.nodes(patch)[0])]; }
  void put(std::size_t patch, bool plain, const std::vector<Mat3>& blocks, const std::vector<std::uint8_t>& fixed,
           std::size_t lane, EightPatches& to) const;
  void take(std::size_t patch, std::size_t lane, const EightPatches& from);
  const NodePatches& patches_;
  const Materials& materials_;
  std::span<const Moduli> moduli_;
  PatchInverses& inverse_;
  std::vector<Eigen::Matrix3f> rotation_;  // per patch
  std::vector<float> parts_;               // four numbers a node of a patch
};

}  // namespace geo
