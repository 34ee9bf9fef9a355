// A leaf is divided when it has more than leaf_capacity indices; eight children are appended to the
// array of cells. A position outside the root rebuilds the tree with twice the extent.
#include "sampling/node_grid.h"

namespace geo {

NodeGrid::NodeGrid(double cell, std::span<const Vec3> positions) : cell_(cell) {
  Box3 box;
  for (const Vec3& p : positions) box.add(p);
  if (positions.empty()) return;
  next_.reserve(positions.size());
  rebuild(positions, box);
  for (std::uint32_t i = 0; i < positions.size(); ++i) put(positions, i);
}

NodeGrid::CellBounds NodeGrid::leaf_of(const Vec3& p) const {
  CellBounds at = root();
  while (cells_[at.cell].count == inner) at = child(at, at.octant(p));
  return at;
}

void NodeGrid::rebuild(std::span<const Vec3> positions, const Box3& box) {
  std::vector<std::uint32_t> indices;
  for (const Cell& cell : cells_)
    if (cell.count != inner)
      for (auto index = cell.first; index != none; index = next_[index]) indices.push_back(index);
  middle_ = box.center();
  half_ = std::max(0.5 * (box.hi - box.lo).maxCoeff(), 0.5 * cell_);
  cells_.assign(1, {});
  size_ = 0;
  for (const auto index : indices) put(positions, index);
}

void NodeGrid::put(std::span<const Vec3> positions, std::uint32_t index) {
  if (next_.size() <= index) next_.resize(index + 1, none);
  ++size_;
  for (CellBounds at = leaf_of(positions[index]);; at = child(at, at.octant(positions[index]))) {
    Cell& cell = cells_[at.cell];
    if (cell.count < leaf_capacity || at.depth == max_depth) {
      next_[index] = std::exchange(cell.first, index);
      ++cell.count;
      return;
    }
    const auto children = static_cast<std::uint32_t>(cells_.size());
    auto rest = std::exchange(cell.first, children);
    cell.count = inner;
    cells_.resize(children + 8);
    while (rest != none) {
      Cell& to = cells_[children + static_cast<std::uint32_t>(at.octant(positions[rest]))];
      const auto after = next_[rest];
      next_[rest] = std::exchange(to.first, rest);
      ++to.count;
      rest = after;
    }
  }
}

void NodeGrid::insert(std::span<const Vec3> positions, std::uint32_t index) {
  const Vec3& p = positions[index];
  const double out = cells_.empty() ? 0 : (p - middle_).cwiseAbs().maxCoeff();
  if (cells_.empty() || out > half_) {
    // Outside points would be found, but in leaves too large. Twice the extent needed: rebuilds are
    // rare.
    Box3 box{p, p};
    if (!cells_.empty()) box = Box3{middle_, middle_}.grown(2 * out);
    rebuild(positions, box);
  }
  put(positions, index);
}

void NodeGrid::erase(std::uint32_t index, const Vec3& p) {
  Cell& cell = cells_[leaf_of(p).cell];
  auto* link = &cell.first;
  while (*link != index) link = &next_[*link];
  *link = next_[index];
  --cell.count;
  --size_;
}

void NodeGrid::within(std::span<const Vec3> positions, const Vec3& p, double radius,
                      std::vector<std::uint32_t>& out) const {
  if (cells_.empty()) return;
  const auto first = static_cast<std::ptrdiff_t>(out.size());
  const double reach = radius * radius;
  visit_near(root(), p, Vec3::Zero(), reach, [&](std::uint32_t index) {
    if ((positions[index] - p).squaredNorm() <= reach) out.push_back(index);
  });
  std::sort(out.begin() + first, out.end());
}

}  // namespace geo
