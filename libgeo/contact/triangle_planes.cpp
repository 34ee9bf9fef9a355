#include "contact/triangle_planes.h"

#include "base/parallel.h"

namespace geo {

TrianglePlanes::TrianglePlanes(std::span<const Triangle> triangles, const std::vector<Vec3>& from, const std::vector<Vec3>& to)
    : triangles_(triangles), from_(from), to_(to), planes_(triangles.size()) {
  parallel_for(planes_.size(), 512, [&](std::size_t begin, std::size_t end) {
    for (std::size_t t = begin; t < end; ++t) {
      const auto& [a, b, c] = triangles_[t];
      Vec3 n = (from_[b] - from_[a]).cross(from_[c] - from_[a]);
      if (const double length = n.norm(); length > 0) n /= length;
      const double x = n.dot(from_[a]), y = n.dot(from_[b]), z = n.dot(from_[c]);
      planes_[t] = {n, (from_[a] + from_[b] + from_[c]) / 3, std::min({x, y, z}), std::max({x, y, z}), 0, 0};
      renew_end(t);
    }
  });
}

void TrianglePlanes::renew_end(std::size_t i) {
  Plane& p = planes_[i];
  const auto& [a, b, c] = triangles_[i];
  const double x = p.normal.dot(to_[a]), y = p.normal.dot(to_[b]), z = p.normal.dot(to_[c]);
  p.last_low = std::min({x, y, z}), p.last_high = std::max({x, y, z});
}

double TrianglePlanes::left_by(std::size_t i, std::size_t j) const {
  const Plane& p = planes_[i];
  const auto& [a, b, c] = triangles_[j];
  const double x = p.normal.dot(to_[a]), y = p.normal.dot(to_[b]), z = p.normal.dot(to_[c]);
  return p.normal.dot(from_[a] + from_[b] + from_[c]) > 1.5 * (p.first_low + p.first_high) ? std::min({x, y, z}) - p.last_high : p.last_low - std::max({x, y, z});
}

}  // namespace geo
