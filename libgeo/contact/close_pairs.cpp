#include "contact/close_pairs.h"

#include <bit>
#include <cmath>

#include "base/parallel.h"

namespace geo {
namespace {

struct Cells {
  std::int32_t lo[3], hi[3];
  double count() const { return double(hi[0] - lo[0] + 1) * double(hi[1] - lo[1] + 1) * double(hi[2] - lo[2] + 1); }
};

std::uint64_t key_of(std::int32_t x, std::int32_t y, std::int32_t z) {
  constexpr std::uint64_t mask = (1u << 21) - 1;
  return (std::uint64_t(std::uint32_t(x)) & mask) << 42 | (std::uint64_t(std::uint32_t(y)) & mask) << 21 | (std::uint64_t(std::uint32_t(z)) & mask);
}

}  // namespace

std::vector<std::pair<std::uint32_t, std::uint32_t>> close_pairs(const std::vector<Box3>& boxes, const std::vector<std::uint8_t>* only) {
  const auto wanted = [only](std::uint32_t i, std::uint32_t j) { return !only || (*only)[i] || (*only)[j]; };
  std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs;
  Box3 all;
  double size = 0;
  std::size_t filled = 0;
  for (const Box3& b : boxes)
    if (!b.empty()) all.add(b), size += (b.hi - b.lo).maxCoeff(), ++filled;
  if (filled < 2) return pairs;
  // Neither so small that keys run out of their 21 bits, nor zero.
  const double cell = std::max({1.5 * size / double(filled), (all.hi - all.lo).maxCoeff() / double(1 << 20), 1e-300});
  std::vector<Cells> cells(boxes.size());
  std::vector<std::uint32_t> large;  // they would fill too many cells: compared with everything
  constexpr double most = 64;
  std::vector<std::uint8_t> is_large(boxes.size(), 0);
  std::size_t entries = 0;
  for (std::uint32_t i = 0; i < boxes.size(); ++i) {
    if (boxes[i].empty()) continue;
    for (int k = 0; k < 3; ++k) {
      cells[i].lo[k] = static_cast<std::int32_t>((boxes[i].lo[k] - all.lo[k]) / cell);
      cells[i].hi[k] = static_cast<std::int32_t>((boxes[i].hi[k] - all.lo[k]) / cell);
    }
    if (cells[i].count() > most)
      is_large[i] = 1, large.push_back(i);
    else
      entries += static_cast<std::size_t>(cells[i].count());
  }
  const int bits = std::bit_width(entries | 1) + 1;
  const auto bucket_of = [bits](std::uint64_t key) { return static_cast<std::size_t>(key * 0x9e3779b97f4a7c15ull >> (64 - bits)); };
  const auto each_cell = [&](std::uint32_t i, const auto& take) {
    for (std::int32_t x = cells[i].lo[0]; x <= cells[i].hi[0]; ++x)
      for (std::int32_t y = cells[i].lo[1]; y <= cells[i].hi[1]; ++y)
        for (std::int32_t z = cells[i].lo[2]; z <= cells[i].hi[2]; ++z) take(key_of(x, y, z));
  };
  struct Entry {
    std::uint64_t key;
    std::uint32_t id;
  };
  std::vector<std::uint32_t> first((std::size_t(1) << bits) + 1, 0);
  const auto each_entry = [&](const auto& take) {
    for (std::uint32_t i = 0; i < boxes.size(); ++i)
      if (!boxes[i].empty() && !is_large[i]) each_cell(i, [&](std::uint64_t key) { take(key, i); });
  };
  each_entry([&](std::uint64_t key, std::uint32_t) { ++first[bucket_of(key) + 1]; });
  for (std::size_t b = 1; b < first.size(); ++b) first[b] += first[b - 1];
  std::vector<Entry> sorted(entries);
  std::vector<std::uint32_t> next(first.begin(), first.end() - 1);
  each_entry([&](std::uint64_t key, std::uint32_t i) { sorted[next[bucket_of(key)]++] = {key, i}; });
  // A pair belongs to the lowest cell that both are in.
  constexpr std::size_t stretch = 4096;
  const std::size_t buckets = first.size() - 1, stretches = (buckets + stretch - 1) / stretch;
  std::vector<std::vector<std::pair<std::uint32_t, std::uint32_t>>> found(stretches);
  parallel_for(stretches, 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t s = begin; s < end; ++s)
      for (std::size_t b = s * stretch; b < std::min(buckets, (s + 1) * stretch); ++b)
        for (std::uint32_t p = first[b]; p < first[b + 1]; ++p)
          for (std::uint32_t q = p + 1; q < first[b + 1]; ++q) {
            const auto i = sorted[p].id, j = sorted[q].id;
            if (sorted[p].key != sorted[q].key || !wanted(i, j) || !boxes[i].meets(boxes[j])) continue;
            const auto &c = cells[i].lo, &d = cells[j].lo;
            if (key_of(std::max(c[0], d[0]), std::max(c[1], d[1]), std::max(c[2], d[2])) == sorted[p].key) found[s].push_back({i, j});
          }
  });
  for (const auto& f : found) pairs.insert(pairs.end(), f.begin(), f.end());
  for (const auto i : large)
    for (std::uint32_t j = 0; j < boxes.size(); ++j)
      if (i != j && !(is_large[j] && j < i) && wanted(i, j) && boxes[i].meets(boxes[j])) pairs.push_back({std::min(i, j), std::max(i, j)});
  return pairs;
}

}  // namespace geo
