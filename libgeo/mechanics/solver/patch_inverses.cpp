#include "mechanics/solver/patch_inverses.h"

#include <algorithm>
#include <utility>

#include "kerf/parallel.h"
#include "mechanics/solver/patch_lanes.h"

namespace geo {

void PatchInverses::begin(const NodePatches& patches) {
  node_.assign(1, 0), first_.assign(1, 0);
  for (std::size_t p = 0; p < patches.count(); ++p) {
    const std::size_t nodes = patches.nodes(p).size();
    node_.push_back(node_.back() + nodes), first_.push_back(first_.back() + 3 * nodes * padded(3 * nodes));
  }
  matrix_ = UninitializedArray<std::uint16_t>(first_.back());
  besides_.resize(node_.back()), moduli_.resize(patches.count()), known_.assign(patches.count(), 0);
}

void PatchInverses::follow(const NodePatches& patches, std::span<const std::uint32_t> was) {
  const PatchInverses before = std::exchange(*this, {});
  begin(patches);
  parallel_for(was.size(), 64, [&](std::size_t begin, std::size_t end) {
    for (std::size_t p = begin; p < end; ++p) {
      const std::size_t o = was[p];
      if (o >= before.count() || !before.known_[o]) continue;
      std::copy_n(before.matrix(o), before.first_[o + 1] - before.first_[o], matrix(p));
      std::copy(&before.besides_[before.node_[o]], &before.besides_[0] + before.node_[o + 1], &besides_[node_[p]]);
      moduli_[p] = before.moduli_[o], known_[p] = 1;
    }
  });
}

bool PatchInverses::knows(std::size_t p, std::span<const Besides> besides, const Moduli& moduli) const {
  return known_[p] && moduli_[p] == moduli &&
         std::equal(besides.begin(), besides.end(), besides_.begin() + static_cast<std::ptrdiff_t>(node_[p]),
                    besides_.begin() + static_cast<std::ptrdiff_t>(node_[p + 1]));
}

void PatchInverses::tell(std::size_t p, std::span<const Besides> besides, const Moduli& moduli) {
  known_[p] = !besides.empty(), moduli_[p] = moduli;
  std::copy(besides.begin(), besides.end(), besides_.begin() + static_cast<std::ptrdiff_t>(node_[p]));
}

}  // namespace geo
