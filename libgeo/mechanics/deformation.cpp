#include "mechanics/deformation.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "mechanics/kernel.h"

namespace geo {

Vec3 displacement_at(const Vec3& x, std::span<const std::pair<NodeId, double>> nodes, const NodeSet& set, const std::vector<Vec3>& u,
                     const std::vector<Mat3>& gradient) {
  double total = 0;
  Vec3 sum = Vec3::Zero();
  for (const auto& [id, distance] : nodes) {
    const std::size_t i = id.index();
    const double w = kernel(distance / set.radius[i], 1.0);
    total += w;
    sum += w * (u[i] + gradient[i] * (x - set.position[i]));
  }
  if (total > 0) return sum / total;
  const std::size_t i = nodes[0].first.index();
  return u[i] + gradient[i] * (x - set.position[i]);
}

InverseMap::InverseMap(const NodeSet& set, const std::vector<Vec3>& u, const std::vector<Mat3>& gradient) : set_(set) {
  for (std::size_t i = 0; i < set.size(); ++i) {
    world_.push_back(set.position[i] + u[i]);
    const Mat3 f = Mat3::Identity() + gradient[i];
    // A neighbourhood that is crushed or turned inside out maps back as if it were rigid.
    back_.push_back(f.determinant() > 0.05 ? Mat3(f.inverse()) : Mat3::Identity());
  }
  grid_ = NodeGrid(std::accumulate(set.spacing.begin(), set.spacing.end(), 0.0) / double(set.size()), world_);
}

Vec3 InverseMap::material(const Vec3& y) const {
  const double reach = *std::max_element(set_.radius.begin(), set_.radius.end());
  std::vector<std::uint32_t> near;
  grid_.within(world_, y, reach, near);
  double total = 0;
  Vec3 sum = Vec3::Zero();
  const auto add = [&](std::uint32_t i, double w) {
    total += w;
    sum += w * (set_.position[i] + back_[i] * (y - world_[i]));
  };
  for (const auto i : near) add(i, kernel((y - world_[i]).norm() / set_.radius[i], 1.0));
  if (total > 1e-9) return sum / total;
  total = 0, sum.setZero();
  for (const auto i : grid_.nearest(world_, y, 6, ~0u, [](auto) { return true; })) {
    const double d = (y - world_[i]).norm() + 1e-300, w = 1 / (d * d);
    total += w;
    sum += w * (y + set_.position[i] - world_[i]);  // far away only the translation is meant
  }
  return sum / total;
}

}  // namespace geo
