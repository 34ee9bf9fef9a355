#include "graph/node_tree.h"

#include <algorithm>
#include <array>
#include <utility>

#include "base/parallel.h"

namespace geo {
namespace {

constexpr int code_bits = 30, axis_bits = 10;

std::uint32_t spread(std::uint32_t x) {
  x = (x | x << 16) & 0x30000ff;
  x = (x | x << 8) & 0x300f00f;
  x = (x | x << 4) & 0x30c30c3;
  return (x | x << 2) & 0x9249249;
}

// Codes and rows, Morton code in the high half.
using Keyed = std::vector<std::uint64_t>;

Box3 box_of_nodes(std::span<const Vec3> positions, const std::uint64_t* begin, const std::uint64_t* end) {
  Box3 box;
  for (auto k = begin; k < end; ++k) box.add(positions[static_cast<std::uint32_t>(*k)]);
  return box;
}

// Codes of the nodes within a box that holds them.
void encode(std::span<const Vec3> positions, const Box3& box, std::uint64_t* begin, std::uint64_t* end) {
  const double extent = (box.hi - box.lo).maxCoeff();
  parallel_for(static_cast<std::size_t>(end - begin), 4096, [&](std::size_t from, std::size_t to) {
    for (std::size_t i = from; i < to; ++i) {
      const auto row = static_cast<std::uint32_t>(begin[i]);
      std::uint32_t code = 0;
      for (int axis = 0; axis < 3; ++axis) {
        const double share = (positions[row][axis] - box.lo[axis]) / extent * (1 << axis_bits);
        code |= spread(static_cast<std::uint32_t>(std::clamp(share, 0.0, double((1 << axis_bits) - 1)))) << axis;
      }
      begin[i] = std::uint64_t(code) << 32 | row;
    }
  });
}

// By digits, lowest first: rows that ascend stay so among equal codes.
void sort_by_digits(Keyed& keyed) {
  constexpr int digit = 10, values = 1 << digit;
  Keyed other(keyed.size());
  for (int pass = 0; pass < code_bits / digit; ++pass) {
    const auto place = [&](std::uint64_t k) { return k >> (32 + digit * pass) & (values - 1); };
    std::array<std::uint32_t, values> start{};
    for (const auto k : keyed) ++start[place(k)];
    std::uint32_t sum = 0;
    for (auto& s : start) sum += std::exchange(s, sum);
    for (const auto k : keyed) other[start[place(k)]++] = k;
    keyed.swap(other);
  }
}

}  // namespace

NodeTree::NodeTree(std::span<const Vec3> positions) {
  const auto n = static_cast<std::uint32_t>(positions.size());
  Keyed keyed(n);
  for (std::uint32_t i = 0; i < n; ++i) keyed[i] = i;
  const Box3 all = box_of_nodes(positions, keyed.data(), keyed.data() + n);
  if (n > 0 && all.lo != all.hi) {
    encode(positions, all, keyed.data(), keyed.data() + n);
    sort_by_digits(keyed);
  }
  struct Job {
    std::uint32_t cell;
    int bit;
  };
  cells_.reserve(n / (leaf_size / 4) + 1);
  cells_.push_back({{0, 0, 0}, {0, 0, 0}, 0, n, 0});
  std::vector<Job> jobs{{0, code_bits - 1}};
  while (!jobs.empty()) {
    auto [at, bit] = jobs.back();
    jobs.pop_back();
    const auto begin = cells_[at].begin, end = cells_[at].end;
    if (end - begin <= leaf_size) continue;
    const auto first = keyed.begin() + begin, last = keyed.begin() + end;
    // The highest bit in which the first code and the last differ splits the cell.
    const std::uint64_t differ = (*first ^ *(last - 1)) >> 32;
    while (bit >= 0 && !(differ >> bit & 1)) --bit;
    if (bit < 0) {
      const Box3 box = box_of_nodes(positions, keyed.data() + begin, keyed.data() + end);
      if (box.lo == box.hi) continue;
      encode(positions, box, keyed.data() + begin, keyed.data() + end);
      std::sort(first, last);
      jobs.push_back({at, code_bits - 1});
      continue;
    }
    const auto middle = static_cast<std::uint32_t>(
        std::partition_point(first, last, [bit = bit](std::uint64_t k) { return !(k >> (32 + bit) & 1); }) - keyed.begin());
    const auto left = static_cast<std::uint32_t>(cells_.size());
    cells_[at].children = left;
    cells_.push_back({{}, {}, begin, middle, at});
    cells_.push_back({{}, {}, middle, end, at});
    jobs.push_back({left + 1, bit - 1});
    jobs.push_back({left, bit - 1});
  }

  node_.resize(n);
  for (auto& c : coordinate_) c.resize(n + 16);
  parallel_for(n, 4096, [&](std::size_t from, std::size_t to) {
    for (std::size_t slot = from; slot < to; ++slot) {
      node_[slot] = static_cast<std::uint32_t>(keyed[slot]);
      for (int axis = 0; axis < 3; ++axis) coordinate_[axis][slot] = positions[node_[slot]][axis];
    }
  });
  if (n == 0) return;
  parallel_for(cells_.size(), 1024, [&](std::size_t from, std::size_t to) {
    for (Cell& cell : std::span(cells_).subspan(from, to - from)) {
      if (!cell.leaf()) continue;
      for (int axis = 0; axis < 3; ++axis) {
        const auto [lo, hi] = std::minmax_element(along(axis) + cell.begin, along(axis) + cell.end);
        cell.lo[axis] = *lo, cell.hi[axis] = *hi;
      }
    }
  });
  for (std::size_t c = cells_.size(); c-- > 0;) {
    Cell& cell = cells_[c];
    if (cell.leaf()) continue;
    const Cell &l = cells_[cell.children], &r = cells_[cell.children + 1];
    for (int axis = 0; axis < 3; ++axis) cell.lo[axis] = std::min(l.lo[axis], r.lo[axis]), cell.hi[axis] = std::max(l.hi[axis], r.hi[axis]);
  }
}

}  // namespace geo
