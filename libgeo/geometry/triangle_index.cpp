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

// Where the key is, or the empty slot where it would go.
std::size_t TriangleIndex::slot_of(std::uint64_t key) const {
  const std::size_t mask = slots_.size() - 1;
  std::size_t at = static_cast<std::size_t>((key * 0x9e3779b97f4a7c15ull) >> 20) & mask;
  while (slots_[at].key != key && slots_[at].key != ~0ull) at = (at + 1) & mask;
  return at;
}

void TriangleIndex::grow() {
  std::vector<Slot> old(std::max<std::size_t>(64, 2 * slots_.size()));
  old.swap(slots_);
  used_ = 0;
  for (const Slot& s : old)
    if (s.first != none) slots_[slot_of(s.key)] = s, ++used_;  // cells that have emptied are forgotten
}

TriangleIndex::Range TriangleIndex::cells_of(const Box3& box) const {
  Range r;
  for (int i = 0; i < 3; ++i) {
    // Clamped so that a far query does not overflow; keys wrap around, boxes decide.
    r.lo[i] = static_cast<std::int64_t>(std::floor(std::clamp(box.lo[i] / cell_, -1e15, 1e15)));
    r.hi[i] = static_cast<std::int64_t>(std::floor(std::clamp(box.hi[i] / cell_, -1e15, 1e15)));
  }
  return r;
}

void TriangleIndex::reserve(std::size_t count) {
  boxes_.reserve(count);
  if (!boxes_.empty()) entries_.reserve(entries_.size() * count / boxes_.size());
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
      for (auto z = r.lo[2]; z <= r.hi[2]; ++z) {
        if (2 * (used_ + 1) > slots_.size()) grow();
        Slot& slot = slots_[slot_of(cell_key(x, y, z))];
        if (slot.key == ~0ull) slot.key = cell_key(x, y, z), ++used_;
        std::uint32_t entry = free_;
        if (entry != none)
          free_ = entries_[entry].next;
        else
          entry = static_cast<std::uint32_t>(entries_.size()), entries_.emplace_back();
        entries_[entry] = {id, slot.first};
        slot.first = entry;
      }
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
        std::uint32_t* at = &slots_[slot_of(cell_key(x, y, z))].first;
        while (entries_[*at].id != id) at = &entries_[*at].next;
        const std::uint32_t entry = *at;
        *at = entries_[entry].next;
        entries_[entry].next = free_;
        free_ = entry;
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
  if (cells > 4.0 * static_cast<double>(used_) + 64) {
    // The query is larger than what is there: asking each box is cheaper.
    for (std::uint32_t id = 0; id < boxes_.size(); ++id)
      if (!boxes_[id].empty()) take(id);
  } else {
    for (auto x = r.lo[0]; x <= r.hi[0]; ++x)
      for (auto y = r.lo[1]; y <= r.hi[1]; ++y)
        for (auto z = r.lo[2]; z <= r.hi[2]; ++z)
          if (!slots_.empty())
            for (auto e = slots_[slot_of(cell_key(x, y, z))].first; e != none; e = entries_[e].next) take(entries_[e].id);
    for (const std::uint32_t id : large_) take(id);
  }
  keep_each_once(out, first);
}

void TriangleIndex::keep_each_once(std::vector<std::uint32_t>& out, std::size_t first) {
  std::sort(out.begin() + static_cast<std::ptrdiff_t>(first), out.end());
  out.erase(std::unique(out.begin() + static_cast<std::ptrdiff_t>(first), out.end()), out.end());
}

void TriangleIndex::find_near_triangle(const Vec3& a, const Vec3& b, const Vec3& c, double reach, std::vector<std::uint32_t>& out) const {
  const Box3 box = box_of(a, b, c).grown(reach);
  const Vec3 n = (b - a).cross(c - a);
  const Range r = cells_of(box);
  const double cells = double(r.hi[0] - r.lo[0] + 1) * double(r.hi[1] - r.lo[1] + 1) * double(r.hi[2] - r.lo[2] + 1);
  int w = 0;
  n.cwiseAbs().maxCoeff(&w);
  const double size = box.hi.cwiseAbs().cwiseMax(box.lo.cwiseAbs()).maxCoeff();
  if (!(std::abs(n[w]) > 1e-200) || cells > 4.0 * static_cast<double>(used_) + 64) return find(box, out);
  const std::size_t first = out.size();
  // Both tests are for speed alone, so they keep what rounding leaves in doubt.
  const double slack = 1e-9 * n.cwiseAbs().sum() * (size + cell_) + reach * n.cwiseAbs().sum();
  const double d = n.dot(a);
  const auto take = [&](std::uint32_t id) {
    const Box3& other = boxes_[id];
    if (!other.meets(box)) return;
    const Vec3 middle = 0.5 * (other.lo + other.hi), half = 0.5 * (other.hi - other.lo);
    if (std::abs(n.dot(middle) - d) <= n.cwiseAbs().dot(half) + slack) out.push_back(id);
  };
  // Columns of cells along the axis that the plane is steepest to; in each, those between which it passes.
  const int u = (w + 1) % 3, v = (w + 2) % 3;
  std::int64_t at[3];
  for (at[u] = r.lo[u]; at[u] <= r.hi[u]; ++at[u])
    for (at[v] = r.lo[v]; at[v] <= r.hi[v]; ++at[v]) {
      const double pu = (static_cast<double>(at[u]) + 0.5) * cell_, pv = (static_cast<double>(at[v]) + 0.5) * cell_;
      const double middle = (d - n[u] * pu - n[v] * pv) / n[w];
      const double span = 0.5 * cell_ * (std::abs(n[u]) + std::abs(n[v])) / std::abs(n[w]) + 1e-9 * (size + cell_) + 2 * reach;
      const auto from = std::max(r.lo[w], static_cast<std::int64_t>(std::floor(std::clamp((middle - span) / cell_, -1e15, 1e15))));
      const auto to = std::min(r.hi[w], static_cast<std::int64_t>(std::floor(std::clamp((middle + span) / cell_, -1e15, 1e15))));
      for (at[w] = from; at[w] <= to; ++at[w])
        if (!slots_.empty())
          for (auto e = slots_[slot_of(cell_key(at[0], at[1], at[2]))].first; e != none; e = entries_[e].next) take(entries_[e].id);
    }
  for (const std::uint32_t id : large_) take(id);
  keep_each_once(out, first);
}

bool TriangleIndex::contains(std::uint32_t id) const { return id < boxes_.size() && !boxes_[id].empty(); }

}  // namespace geo
