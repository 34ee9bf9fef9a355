#include "geometry/triangle_index.h"

#include <algorithm>
#include <cmath>

namespace geo {
namespace {

// A box that covers more cells than this is kept in the list of large ones.
constexpr std::int64_t most_cells = 512;

std::uint64_t cell_key(std::int64_t x, std::int64_t y, std::int64_t z) {
  constexpr std::uint64_t mask = (1u << 21) - 1;
  return (static_cast<std::uint64_t>(x) & mask) << 42 | (static_cast<std::uint64_t>(y) & mask) << 21 |
         (static_cast<std::uint64_t>(z) & mask);
}

}  // namespace

TriangleIndex::Range TriangleIndex::cells_of(const Box3& box) const {
  Range r;
  for (int i = 0; i < 3; ++i) {
    // Clamped so that a far query does not overflow; keys wrap around, boxes decide.
    r.lo[i] = static_cast<std::int64_t>(std::floor(std::clamp(box.lo[i] / cell_, -1e15, 1e15)));
    r.hi[i] = static_cast<std::int64_t>(std::floor(std::clamp(box.hi[i] / cell_, -1e15, 1e15)));
  }
  return r;
}

void TriangleIndex::insert(std::uint32_t id, const Box3& box) {
  if (boxes_.size() <= id) boxes_.resize(id + 1);
  boxes_[id] = box;
  const Range r = cells_of(box);
  const double cells = double(r.hi[0] - r.lo[0] + 1) * double(r.hi[1] - r.lo[1] + 1) * double(r.hi[2] - r.lo[2] + 1);
  if (cells > most_cells) {
    large_.push_back(id);
    return;
  }
  for (auto x = r.lo[0]; x <= r.hi[0]; ++x)
    for (auto y = r.lo[1]; y <= r.hi[1]; ++y)
      for (auto z = r.lo[2]; z <= r.hi[2]; ++z) cells_[cell_key(x, y, z)].push_back(id);
}

void TriangleIndex::erase(std::uint32_t id) {
  const Box3 box = boxes_[id];
  boxes_[id] = Box3{};
  if (const auto it = std::find(large_.begin(), large_.end(), id); it != large_.end()) {
    large_.erase(it);
    return;
  }
  const Range r = cells_of(box);
  for (auto x = r.lo[0]; x <= r.hi[0]; ++x)
    for (auto y = r.lo[1]; y <= r.hi[1]; ++y)
      for (auto z = r.lo[2]; z <= r.hi[2]; ++z) {
        const auto cell = cells_.find(cell_key(x, y, z));
        auto& ids = cell->second;
        ids.erase(std::find(ids.begin(), ids.end(), id));
        if (ids.empty()) cells_.erase(cell);
      }
}

void TriangleIndex::find(const Box3& box, std::vector<std::uint32_t>& out) const {
  if (box.empty()) return;
  const std::size_t first = out.size();
  const auto take = [&](std::uint32_t id) {
    if (boxes_[id].meets(box)) out.push_back(id);
  };
  const Range r = cells_of(box);
  const double cells = double(r.hi[0] - r.lo[0] + 1) * double(r.hi[1] - r.lo[1] + 1) * double(r.hi[2] - r.lo[2] + 1);
  if (cells > 4.0 * static_cast<double>(cells_.size()) + 64) {
    // The query is larger than what is there: asking each box is cheaper.
    for (std::uint32_t id = 0; id < boxes_.size(); ++id)
      if (!boxes_[id].empty()) take(id);
  } else {
    for (auto x = r.lo[0]; x <= r.hi[0]; ++x)
      for (auto y = r.lo[1]; y <= r.hi[1]; ++y)
        for (auto z = r.lo[2]; z <= r.hi[2]; ++z)
          if (const auto cell = cells_.find(cell_key(x, y, z)); cell != cells_.end())
            for (const std::uint32_t id : cell->second) take(id);
    for (const std::uint32_t id : large_) take(id);
  }
  std::sort(out.begin() + static_cast<std::ptrdiff_t>(first), out.end());
  out.erase(std::unique(out.begin() + static_cast<std::ptrdiff_t>(first), out.end()), out.end());
}

bool TriangleIndex::contains(std::uint32_t id) const { return id < boxes_.size() && !boxes_[id].empty(); }

}  // namespace geo
