#include "contact/response/blade_penalty.h"

#include <algorithm>
#include <cmath>

namespace geo {

void BladePenalty::add(std::size_t blade, const Blade& shape, const Pose& pose, const std::vector<Vec3>& x,
                       const std::vector<Vec3>& u, const std::vector<double>& clearance,
                       const std::vector<double>& mass, double stiffness) {
  const Vec3 back = pose.rotation * shape.back;
  const double width = back.norm(), slope = 0.5 * shape.thickness / width;
  const std::size_t n = shape.points.size(), segments = shape.closed ? n : n - 1;
  Box3 box;
  for (const Vec3& p : shape.points) box.add(pose * p), box.add(pose * p + back);
  box = box.grown(shape.thickness + *std::max_element(clearance.begin(), clearance.end()));
  // In the plane of a flank: r = α along + β back + d normal.
  struct Flank {
    Vec3 a, along, normal;
    double aa, ab, det;
  };
  const double bb = width * width;
  std::vector<Flank> flanks;
  for (std::size_t s = 0; s < segments; ++s) {
    const Vec3 a = pose * shape.points[s], along = pose * shape.points[(s + 1) % n] - a;
    const double aa = along.squaredNorm(), ab = along.dot(back);
    flanks.push_back({a, along, along.cross(back).normalized(), aa, ab, aa * bb - ab * ab});
  }
  for (std::size_t i = 0; i < x.size(); ++i) {
    const Vec3 world = x[i] + u[i];
    if (!box.meets({world, world})) continue;
    // The segment behind which the node is, the nearest one of several.
    Contact found{{static_cast<std::uint32_t>(i), 1}, blade, Vec3::Zero(), mass[i] * stiffness, 0};
    double least = 0.5 * shape.thickness + clearance[i];
    for (const Flank& f : flanks) {
      const Vec3 r = world - f.a;
      const double d = r.dot(f.normal);
      if (!(std::abs(d) < least)) continue;
      const double ra = r.dot(f.along), rb = r.dot(back);
      const double alpha = (ra * bb - rb * f.ab) / f.det, beta = (rb * f.aa - ra * f.ab) / f.det;
      if (!(alpha >= 0 && alpha <= 1 && beta >= 0 && beta <= 1)) continue;
      least = std::abs(d);
      found.normal = ((d < 0 ? -1.0 : 1.0) * f.normal - slope * back / width).normalized();
      found.offset = clearance[i] - found.normal.dot(r - u[i]);
    }
    if (found.normal != Vec3::Zero()) contacts_.push_back(found);
  }
}

double BladePenalty::energy(std::size_t r, const Vec3& way) const {
  return 0.5 * contacts_[r].stiffness * std::pow(contacts_[r].depth(way), 2);
}

Potential::Derivatives BladePenalty::derivatives(std::size_t r, const Vec3& way) {
  const Contact& c = contacts_[r];
  const double depth = c.depth(way);
  return {c.stiffness * depth * c.normal,
          depth > 0 ? Mat3(c.stiffness * c.normal * c.normal.transpose()) : Mat3(Mat3::Zero())};
}

std::vector<Vec3> BladePenalty::reaction(const std::vector<Vec3>& u, std::size_t blades) const {
  std::vector<Vec3> sum(blades, Vec3::Zero());
  for (const Contact& c : contacts_) sum[c.blade] -= c.stiffness * c.depth(u[c.at.node]) * c.normal;
  return sum;
}

}  // namespace geo
