// As rsync (Tridgell and Mackerras 1996): blocks of `before` are hashed, and windows of `after` are
// looked up among them. Rows at their own place are compared first, so most arrays need no hashes.
#include <algorithm>
#include <utility>

#include "io/kerf_delta.h"

namespace geo::kerf {
namespace {

// Bytes of a window, rounded to rows. A run costs 16 bytes, so copying shorter stretches saves
// little. Larger: fewer hashes, more literal rows.
constexpr std::size_t window_bytes = 256;

// The blocks of an array by hash. Queries ascend: a block is found while it begins at or after
// `least`.
class Blocks {
 public:
  explicit Blocks(std::span<const std::byte> bytes, std::size_t size) : bytes_(bytes), size_(size) {
    const std::size_t count = bytes.size() / size;
    first_.assign(std::bit_ceil(2 * count + 1), none);
    next_.resize(count);
    for (std::size_t b = count; b-- > 0;) {
      auto& first = first_[bucket(bytes.data() + b * size)];
      next_[b] = std::exchange(first, static_cast<std::uint32_t>(b));
    }
  }
  // First byte of a block equal to the one at `wanted` that begins at `least` or later; else the
  // end.
  std::size_t find(const std::byte* wanted, std::size_t least) {
    auto& first = first_[bucket(wanted)];
    while (first != none && first * size_ < least) first = next_[first];
    int tries = 8;  // in a bucket: arrays with few values have many equal blocks
    for (auto b = first; b != none && tries-- > 0; b = next_[b])
      if (std::memcmp(bytes_.data() + b * size_, wanted, size_) == 0) return b * size_;
    return bytes_.size();
  }

 private:
  static constexpr std::uint32_t none = ~0u;
  std::size_t bucket(const std::byte* at) const { return hash_of(at, size_) & (first_.size() - 1); }
  std::span<const std::byte> bytes_;
  std::size_t size_;
  std::vector<std::uint32_t> first_, next_;
};

std::size_t common_bytes(const std::byte* a, const std::byte* b, std::size_t limit) {
  std::size_t n = 0;
  for (const std::size_t step : {std::size_t(4096), std::size_t(64), std::size_t(1)})
    while (n + step <= limit && std::memcmp(a + n, b + n, step) == 0) n += step;
  return n;
}

}  // namespace

std::vector<Run> difference(std::span<const std::byte> before, std::span<const std::byte> after, std::size_t width) {
  const std::size_t rows = std::max<std::size_t>(1, window_bytes / width), window = rows * width;
  std::vector<Run> runs;
  const auto add_literal = [&](std::size_t bytes) {
    if (bytes > 0) runs.push_back({literal, bytes / width});
  };
  const auto same = [&](std::size_t i, std::size_t j) {
    return std::memcmp(after.data() + i, before.data() + j, width) == 0;
  };
  std::vector<Blocks> moved;       // built on first use
  std::size_t done = 0, used = 0;  // bytes of `after` covered by runs; of `before` that are copied or passed
  while (done < after.size()) {
    // The next window that is equal at its own place, or, after two windows, anywhere.
    std::size_t i = done, j = before.size(), in_place = 0;
    for (; i + width <= after.size(); i += width) {
      const std::size_t opposite = used + (i - done);
      in_place = opposite + width <= before.size() && same(i, opposite) ? in_place + width : 0;
      if (in_place == window || (in_place > 0 && i + width == after.size())) {
        i -= in_place - width;
        j = used + (i - done);
        break;
      }
      if (i - done < 2 * window || i + window > after.size()) continue;
      if (moved.empty()) moved.emplace_back(before, window);
      j = moved[0].find(after.data() + i, used);
      if (j < before.size()) break;
    }
    if (j == before.size()) break;
    while (i > done && j > used && same(i - width, j - width)) {
      i -= width;
      j -= width;
    }
    const std::size_t length =
        common_bytes(after.data() + i, before.data() + j, std::min(after.size() - i, before.size() - j)) / width *
        width;
    add_literal(i - done);
    runs.push_back({j / width, length / width});
    done = i + length;
    used = j + length;
  }
  add_literal(after.size() - done);
  return runs;
}

}  // namespace geo::kerf
