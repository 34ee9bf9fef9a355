// 30-bit Morton codes are sorted by radix. A cell is split at the highest bit in which its first
// and last code differ, as in a binary radix tree (Lauterbach et al. 2009). Boxes are joined
// bottom-up.
#include "graph/node_tree.h"

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "kerf/parallel.h"

namespace geo {
namespace {

using Cell = NodeTree::Cell;

constexpr int code_bits = 30, axis_bits = 10;
constexpr std::uint32_t grain = 1 << 14;  // nodes that are worth a task

// Puts two zero bits between the lower ten bits of x.
std::uint32_t spread(std::uint32_t x) {
  x = (x | x << 16) & 0x30000ff;
  x = (x | x << 8) & 0x300f00f;
  x = (x | x << 4) & 0x30c30c3;
  return (x | x << 2) & 0x9249249;
}

std::size_t chunk_count(std::size_t nodes) { return (nodes + grain - 1) / grain; }

// Calls body(c, begin, end) for the c-th chunk of [0, nodes). Chunks do not depend on the number of
// threads.
template <class Body>
void in_chunks(std::size_t nodes, const Body& body) {
  parallel_for(chunk_count(nodes), 1, [&](std::size_t first, std::size_t last) {
    for (std::size_t c = first; c < last; ++c) body(c, c * grain, std::min<std::size_t>(nodes, (c + 1) * grain));
  });
}

// `row(i)`: of the i-th node.
template <class Row>
Box3 box_of_nodes(std::span<const Vec3> positions, std::size_t count, const Row& row) {
  std::vector<Box3> boxes(chunk_count(count));
  in_chunks(count, [&](std::size_t p, std::size_t begin, std::size_t end) {
    Box3 box;
    for (std::size_t i = begin; i < end; ++i) box.add(positions[row(i)]);
    boxes[p] = box;
  });
  Box3 all;
  for (const Box3& box : boxes) all.add(box);
  return all;
}

// Codes and rows of nodes, Morton code in the high half, within a box that holds the nodes.
template <class Row>
void encode(std::span<const Vec3> positions, const Box3& box, std::span<std::uint64_t> keyed, const Row& row) {
  const double extent = (box.hi - box.lo).maxCoeff();
  in_chunks(keyed.size(), [&](std::size_t, std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const std::uint32_t r = row(i);
      std::uint32_t code = 0;
      for (int axis = 0; extent > 0 && axis < 3; ++axis) {
        const double share = (positions[r][axis] - box.lo[axis]) / extent * (1 << axis_bits);
        code |= spread(static_cast<std::uint32_t>(std::clamp(share, 0.0, double((1 << axis_bits) - 1)))) << axis;
      }
      keyed[i] = std::uint64_t(code) << 32 | r;
    }
  });
}

// A stable radix sort, lowest digit first. Each chunk counts its digits, and then writes behind
// lower digits and behind equal digits of earlier chunks.
void sort_by_digits(UninitializedArray<std::uint64_t>& keyed) {
  // Three passes over 30 bits; the 1024 counters of a chunk (4 KiB) fit into the first cache.
  constexpr int digit = 10, values = 1 << digit;
  UninitializedArray<std::uint64_t> other(keyed.size());
  std::vector<std::array<std::uint32_t, values>> next(chunk_count(keyed.size()));
  for (int pass = 0; pass < code_bits / digit; ++pass) {
    const auto place = [&](std::uint64_t k) { return k >> (32 + digit * pass) & (values - 1); };
    in_chunks(keyed.size(), [&](std::size_t p, std::size_t begin, std::size_t end) {
      next[p].fill(0);
      for (std::size_t i = begin; i < end; ++i) ++next[p][place(keyed[i])];
    });
    std::uint32_t sum = 0;
    for (int value = 0; value < values; ++value)
      for (auto& part : next) sum += std::exchange(part[static_cast<std::size_t>(value)], sum);
    in_chunks(keyed.size(), [&](std::size_t p, std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) other[next[p][place(keyed[i])]++] = keyed[i];
    });
    std::swap(keyed, other);
  }
}

struct Job {
  std::uint32_t cell;
  int bit;  // its nodes' codes differ in this one at the highest
};

class Splitter {
 public:
  Splitter(std::span<const Vec3> positions, UninitializedArray<std::uint64_t>& keyed)
      : positions_(positions), keyed_(keyed) {}

  // Splits a cell at the highest bit in which its first and last code differ. Appends the jobs of
  // both children, the first child last. False when the cell stays a leaf.
  bool split(std::vector<Cell>& cells, Job job, std::vector<Job>& jobs) {
    const auto begin = cells[job.cell].begin, end = cells[job.cell].end;
    if (end - begin <= NodeTree::leaf_size) return false;
    auto* const first = keyed_.data() + begin;
    auto* const last = keyed_.data() + end;
    const auto highest = [&](int bit) {
      const std::uint64_t differ = (*first ^ *(last - 1)) >> 32;
      while (bit >= 0 && !(differ >> bit & 1)) --bit;
      return bit;
    };
    int bit = highest(job.bit);
    if (bit < 0) {  // their own box tells them apart
      const auto row = [&](std::size_t i) { return static_cast<std::uint32_t>(first[i]); };
      const Box3 box = box_of_nodes(positions_, end - begin, row);
      if (box.lo == box.hi) return false;
      encode(positions_, box, {first, last}, row);
      std::sort(first, last);
      bit = highest(code_bits - 1);
    }
    const auto middle = static_cast<std::uint32_t>(
        std::partition_point(first, last, [&](std::uint64_t k) { return !(k >> (32 + bit) & 1); }) - keyed_.data());
    const auto left = static_cast<std::uint32_t>(cells.size());
    cells[job.cell].children = left;
    cells.push_back({.lo = {}, .hi = {}, .begin = begin, .end = middle, .parent = job.cell});
    cells.push_back({.lo = {}, .hi = {}, .begin = middle, .end = end, .parent = job.cell});
    jobs.push_back({left + 1, bit - 1});
    jobs.push_back({left, bit - 1});
    return true;
  }

 private:
  std::span<const Vec3> positions_;
  UninitializedArray<std::uint64_t>& keyed_;
};

void join_boxes(Cell& cell, const Cell& l, const Cell& r) {
  for (int axis = 0; axis < 3; ++axis) {
    cell.lo[axis] = std::min(l.lo[axis], r.lo[axis]);
    cell.hi[axis] = std::max(l.hi[axis], r.hi[axis]);
  }
}

}  // namespace

NodeTree::NodeTree(std::span<const Vec3> positions) {
  const auto n = static_cast<std::uint32_t>(positions.size());
  const auto same = [](std::size_t i) { return static_cast<std::uint32_t>(i); };
  UninitializedArray<std::uint64_t> keyed(n);
  encode(positions, box_of_nodes(positions, n, same), {keyed.data(), n}, same);
  sort_by_digits(keyed);
  Splitter splitter(positions, keyed);
  node_ = UninitializedArray<std::uint32_t>(n);
  for (auto& c : coordinate_) {
    c = UninitializedArray<double>(n + 16);
    std::fill(c.end() - 16, c.end(), 0.0);
  }

  // Large cells are split one after another, the subtrees below them in parallel.
  std::vector<Cell> top{{.lo = {0, 0, 0}, .hi = {0, 0, 0}, .begin = 0, .end = n, .parent = 0}};
  std::vector<Job> jobs{{0, code_bits - 1}}, small;
  while (!jobs.empty()) {
    const Job job = jobs.back();
    jobs.pop_back();
    if (top[job.cell].count() <= grain || !splitter.split(top, job, jobs)) small.push_back(job);
  }
  std::vector<std::vector<Cell>> trees(small.size());
  parallel_for(trees.size(), 1, [&](std::size_t from, std::size_t to) {
    std::vector<Job> rest;
    for (std::size_t t = from; t < to; ++t) {
      auto& cells = trees[t];
      cells.reserve(top[small[t].cell].count() / (leaf_size / 4) + 1);
      cells.push_back(top[small[t].cell]);
      rest.assign(1, {0, small[t].bit});
      while (!rest.empty()) {
        const Job job = rest.back();
        rest.pop_back();
        splitter.split(cells, job, rest);
      }
      for (auto slot = cells[0].begin; slot < cells[0].end; ++slot) {
        node_[slot] = static_cast<std::uint32_t>(keyed[slot]);
        for (int axis = 0; axis < 3; ++axis) coordinate_[axis][slot] = positions[node_[slot]][axis];
      }
      for (std::size_t c = cells.size(); c-- > 0;) {
        Cell& cell = cells[c];
        if (!cell.leaf()) {
          join_boxes(cell, cells[cell.children], cells[cell.children + 1]);
          continue;
        }
        for (int axis = 0; axis < 3 && cell.count() > 0; ++axis) {
          const auto [lo, hi] = std::minmax_element(along(axis) + cell.begin, along(axis) + cell.end);
          cell.lo[axis] = *lo;
          cell.hi[axis] = *hi;
        }
      }
    }
  });

  // The cells of each subtree, without its root, follow the large cells.
  std::vector<std::uint32_t> place(trees.size() + 1, static_cast<std::uint32_t>(top.size()));
  for (std::size_t t = 0; t < trees.size(); ++t)
    place[t + 1] = place[t] + static_cast<std::uint32_t>(trees[t].size()) - 1;
  cells_ = UninitializedArray<Cell>(place.back());
  parallel_for(trees.size(), 1, [&](std::size_t from, std::size_t to) {
    for (std::size_t t = from; t < to; ++t) {
      const auto root = small[t].cell, shift = place[t] - 1;
      for (std::size_t c = 0; c < trees[t].size(); ++c) {
        Cell cell = trees[t][c];
        if (!cell.leaf()) cell.children += shift;
        if (c > 0) cell.parent = cell.parent == 0 ? root : cell.parent + shift;
        (c > 0 ? cells_[c + shift] : top[root]) = cell;
      }
    }
  });
  for (std::size_t c = top.size(); c-- > 0;) {
    if (!top[c].leaf() && top[c].children < top.size())
      join_boxes(top[c], top[top[c].children], top[top[c].children + 1]);
    cells_[c] = top[c];
  }
}

}  // namespace geo
