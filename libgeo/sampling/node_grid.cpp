#include "sampling/node_grid.h"

namespace geo {

NodeGrid::NodeGrid(double cell, std::span<const Vec3> positions) : cell_(cell) {
  Box3 box;
  for (const Vec3& p : positions) box.add(p);
  if (positions.empty()) return;
  next_.reserve(positions.size());
  begin_anew(positions, box);
  for (std::uint32_t i = 0; i < positions.size(); ++i) put(positions, i);
}

NodeGrid::Place NodeGrid::leaf_of(const Vec3& p) const {
  Place at = root();
  while (cells_[at.cell].count == inner) at = child(at, at.octant(p));
  return at;
}

void NodeGrid::begin_anew(std::span<const Vec3> positions, const Box3& box) {
  std::vector<std::uint32_t> rows;
  for (const Cell& cell : cells_)
    if (cell.count != inner)
      for (auto row = cell.first; row != none; row = next_[row]) rows.push_back(row);
  middle_ = box.center();
  half_ = std::max(0.5 * (box.hi - box.lo).maxCoeff(), 0.5 * cell_);
  cells_.assign(1, {});
  size_ = 0;
  for (const auto row : rows) put(positions, row);
}

void NodeGrid::put(std::span<const Vec3> positions, std::uint32_t row) {
  if (next_.size() <= row) next_.resize(row + 1, none);
  ++size_;
  for (Place at = leaf_of(positions[row]);; at = child(at, at.octant(positions[row]))) {
    Cell& cell = cells_[at.cell];
    if (cell.count < most_in_leaf || at.depth == deepest) {
      next_[row] = std::exchange(cell.first, row);
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

void NodeGrid::insert(std::span<const Vec3> positions, std::uint32_t row) {
  const Vec3& p = positions[row];
  const double out = cells_.empty() ? 0 : (p - middle_).cwiseAbs().maxCoeff();
  if (cells_.empty() || out > half_) {
    // Points outside would be found all the same, but in leaves too large. Twice as far as needed: seldom again.
    Box3 box{p, p};
    if (!cells_.empty()) box = Box3{middle_, middle_}.grown(2 * out);
    begin_anew(positions, box);
  }
  put(positions, row);
}

void NodeGrid::erase(std::uint32_t row, const Vec3& p) {
  Cell& cell = cells_[leaf_of(p).cell];
  auto* link = &cell.first;
  while (*link != row) link = &next_[*link];
  *link = next_[row];
  --cell.count;
  --size_;
}

void NodeGrid::within(std::span<const Vec3> positions, const Vec3& p, double radius,
                      std::vector<std::uint32_t>& out) const {
  if (cells_.empty()) return;
  const auto first = static_cast<std::ptrdiff_t>(out.size());
  const double reach = radius * radius;
  visit(root(), p, Vec3::Zero(), reach, [&](std::uint32_t row) {
    if ((positions[row] - p).squaredNorm() <= reach) out.push_back(row);
  });
  std::sort(out.begin() + first, out.end());
}

}  // namespace geo
