// A table of blocks of cells gives the range of leaves in each block; codes are sorted, so a binary
// search within the range finds a leaf.
#include "sampling/leaf_index.h"

namespace geo {

LeafIndex::LeafIndex(std::vector<std::uint64_t> codes, std::vector<std::uint8_t> levels)
    : codes_(std::move(codes)), levels_(std::move(levels)) {
  std::array<std::int32_t, 3> most{0, 0, 0};
  for (std::size_t i = 0; i < codes_.size(); ++i) {
    const auto c = corner_of(codes_[i]);
    for (int k = 0; k < 3; ++k) most[k] = std::max(most[k], c[k]);
    block_ = std::max<int>(block_, levels_[i]);
  }
  // As fine as a table of an eighth of the leaves' number allows.
  const auto count = [&] {
    return std::size_t((most[0] >> block_) + 1) * std::size_t((most[1] >> block_) + 1) *
           std::size_t((most[2] >> block_) + 1);
  };
  while (count() > codes_.size() / 8 + 4096) ++block_;
  for (int k = 0; k < 3; ++k) blocks_[k] = (most[k] >> block_) + 1;
  begin_.resize(count());
  end_.resize(count());
  for (std::uint32_t i = 0; i < codes_.size(); ++i) {
    const auto c = corner_of(codes_[i] >> 3 * block_);
    const auto block =
        (std::size_t(c[2]) * std::size_t(blocks_[1]) + std::size_t(c[1])) * std::size_t(blocks_[0]) + std::size_t(c[0]);
    if (begin_[block] == end_[block]) begin_[block] = i;
    end_[block] = i + 1;
  }
}

}  // namespace geo
