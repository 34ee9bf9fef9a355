// Solid angles are those of van Oosterom and Strackee (1983). Nodes are halved at the median of the
// longest axis of their centroids, down to eight triangles.
#include "crack/winding_number.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace geo::crack {
namespace {

constexpr std::uint32_t leaf_size = 8;

// Half the solid angle of a triangle at a point.
double half_angle(const std::array<Vec3, 3>& t, const Vec3& at) {
  const Vec3 a = t[0] - at, b = t[1] - at, c = t[2] - at;
  const double la = a.norm(), lb = b.norm(), lc = c.norm();
  return std::atan2(a.dot(b.cross(c)), la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
}

Vec3 area_vector(const std::array<Vec3, 3>& t) { return 0.5 * (t[1] - t[0]).cross(t[2] - t[0]); }
Vec3 middle(const std::array<Vec3, 3>& t) { return (t[0] + t[1] + t[2]) / 3; }

}  // namespace

WindingNumber::WindingNumber(std::vector<std::array<Vec3, 3>> triangles) : triangles_(std::move(triangles)) {
  if (!triangles_.empty()) add_node(0, static_cast<std::uint32_t>(triangles_.size()));
}

void WindingNumber::add_node(std::uint32_t first, std::uint32_t end) {
  const std::size_t index = nodes_.size();
  Node node{.centroid = Vec3::Zero(), .area = Vec3::Zero(), .radius = 0, .first = first, .end = end, .next = 0};
  Box3 box;
  double weight = 0;
  for (auto t = first; t < end; ++t) {
    const Vec3 area = area_vector(triangles_[t]), at = middle(triangles_[t]);
    node.area += area;
    node.centroid += area.norm() * at;
    weight += area.norm();
    box.add(at);
  }
  if (weight > 0)
    node.centroid /= weight;
  else
    node.centroid = box.center();
  for (auto t = first; t < end; ++t)
    for (const Vec3& p : triangles_[t]) node.radius = std::max(node.radius, (p - node.centroid).norm());
  nodes_.push_back(node);
  if (end - first > leaf_size) {
    int axis = 0;
    (box.hi - box.lo).maxCoeff(&axis);
    const auto half = first + (end - first) / 2;
    std::nth_element(triangles_.begin() + first, triangles_.begin() + half, triangles_.begin() + end,
                     [&](const auto& s, const auto& t) { return middle(s)[axis] < middle(t)[axis]; });
    add_node(first, half);
    add_node(half, end);
  }
  nodes_[index].next = static_cast<std::uint32_t>(nodes_.size());
}

double WindingNumber::value(const Vec3& at, double opening) const {
  double sum = 0;  // half of the solid angle
  for (std::size_t i = 0; i < nodes_.size();) {
    const Node& node = nodes_[i];
    const Vec3 to = node.centroid - at;
    const double distance = to.norm();
    if (opening > 0 && distance > opening * node.radius) {
      sum += node.area.dot(to) / (2 * distance * distance * distance);
      i = node.next;
    } else {
      if (node.end - node.first <= leaf_size)
        for (auto t = node.first; t < node.end; ++t) sum += half_angle(triangles_[t], at);
      ++i;
    }
  }
  return sum / (2 * std::numbers::pi);
}

bool WindingNumber::exceeds_half(const Vec3& at) const {
  // Dipoles at four radii are off by some hundredths in all.
  const double nearly = value(at, 4);
  return (std::abs(nearly - 0.5) > 0.25 ? nearly : value(at, 0)) > 0.5;
}

}  // namespace geo::crack
