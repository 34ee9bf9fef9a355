// Inverses of patches, which are kept from step to step while nothing changes that they are made
// of.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/uninitialized_array.h"
#include "kerf/material.h"
#include "mechanics/material/stress_derivative.h"
#include "mechanics/solver/node_patches.h"

namespace geo {

class PatchInverses {
 public:
  /// What a patch's inverse is made of beside the patch's own sums.
  struct Besides {
    float inertia;        ///< of a node, the same in all directions; below zero: it is held
    std::uint32_t among;  ///< how many patches its share is spread over
    friend bool operator==(const Besides&, const Besides&) = default;
  };

  /// Room for all patches; nothing is known of any.
  void begin(const NodePatches& patches);
  /// The same after they have changed; `was`: as NodePatches::follow() says. What is known of those
  /// that were there stays.
  void follow(const NodePatches& patches, std::span<const std::uint32_t> was);
  std::size_t count() const { return moduli_.size(); }

  /// Whether the inverse of p is known for these.
  bool knows(std::size_t p, std::span<const Besides> besides, const Moduli& moduli) const;
  /// What is written to matrix(p) is made of these; none: of something else as well, and good for
  /// this step only.
  void tell(std::size_t p, std::span<const Besides> besides, const Moduli& moduli);

  /// Upper halves of numbers; three rows a node, padded() apart.
  std::uint16_t* matrix(std::size_t p) { return &matrix_[first_[p]]; }
  const std::uint16_t* matrix(std::size_t p) const { return &matrix_[first_[p]]; }

 private:
  std::vector<std::size_t> node_, first_;  // per patch and one more: of its nodes, of its numbers
  UninitializedArray<std::uint16_t> matrix_;
  std::vector<Besides> besides_;  // per node of a patch
  std::vector<Moduli> moduli_;    // per patch
  std::vector<char> known_;
};

}  // namespace geo
