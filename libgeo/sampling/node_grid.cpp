#include "sampling/node_grid.h"

#include <algorithm>
#include <cmath>

namespace geo {

NodeGrid::NodeGrid(double cell, std::span<const Vec3> positions) : cell_(cell) {
  cells_.reserve(positions.size());
  for (std::uint32_t i = 0; i < positions.size(); ++i) insert(i, positions[i]);
}

std::int64_t NodeGrid::coordinate(double x) const { return static_cast<std::int64_t>(std::floor(std::clamp(x / cell_, -1e15, 1e15))); }

void NodeGrid::insert(std::uint32_t row, const Vec3& p) {
  cells_[key(coordinate(p.x()), coordinate(p.y()), coordinate(p.z()))].push_back(row);
  box_.add(p);
  ++size_;
}

void NodeGrid::erase(std::uint32_t row, const Vec3& p) {
  auto& rows = cells_[key(coordinate(p.x()), coordinate(p.y()), coordinate(p.z()))];
  rows.erase(std::find(rows.begin(), rows.end(), row));
  --size_;
}

void NodeGrid::within(std::span<const Vec3> positions, const Vec3& p, double radius, std::vector<std::uint32_t>& out) const {
  const std::size_t first = out.size();
  std::int64_t lo[3], hi[3];
  double cells = 1;
  for (int i = 0; i < 3; ++i) {
    lo[i] = coordinate(std::max(p[i] - radius, box_.lo[i])), hi[i] = coordinate(std::min(p[i] + radius, box_.hi[i]));
    cells *= double(std::max<std::int64_t>(0, hi[i] - lo[i] + 1));
  }
  const double r2 = radius * radius;
  const auto take = [&](std::uint32_t row) {
    if ((positions[row] - p).squaredNorm() <= r2) out.push_back(row);
  };
  if (cells > 2.0 * double(cells_.size())) {
    for (const auto& [k, rows] : cells_)
      for (const auto row : rows) take(row);
  } else {
    for (auto x = lo[0]; x <= hi[0]; ++x)
      for (auto y = lo[1]; y <= hi[1]; ++y)
        for (auto z = lo[2]; z <= hi[2]; ++z)
          if (const auto it = cells_.find(key(x, y, z)); it != cells_.end())
            for (const auto row : it->second) take(row);
  }
  std::sort(out.begin() + static_cast<std::ptrdiff_t>(first), out.end());
}

}  // namespace geo
