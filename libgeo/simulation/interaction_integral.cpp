// I = ∫ (σ : ∇uᵃ e₁ + σᵃ : ∇u e₁ − σᵃ : ε e₁) · ∇q dV with the fields uᵃ of a unit stress
// intensity, e₁ ahead. The weight q is 1 at the tip, falls to 0 at the rim, and along the front as
// 1 − z² / w². Per length of front, I is 2 K (1 − ν²) / E for modes I and II, K / μ for mode III.
#include "simulation/interaction_integral.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "base/elementary.h"
#include "body/incremental_cache.h"
#include "body/locate.h"
#include "geometry/distance.h"
#include "mechanics/solver/relaxation.h"
#include "mechanics/solver/solid_discretisation.h"
#include "simulation/fracture_front.h"
#include "simulation/fracture_tip.h"

namespace geo {
namespace {

// In node spacings: the measures of the domain, and its least radius, for which some points lie
// between it and the core.
constexpr double core = 1, outer = 3, half_width = 1.5, least_outer = 1.5;
// The slope of a face against the plane across the front, below which the face only ends the front:
// it takes no part in that plane.
constexpr double end_slope = 0.5;
// With fewer points, the integral is a sum of few samples of fields that vary by their size.
constexpr std::size_t least_points = 24;

}  // namespace

// The cylinder about a point of a front, in the frame of the tip: x ahead, y normal, z along.
struct InteractionIntegral::Domain {
  TipFrame tip;
  Mat3 axes;  // columns: ahead, normal, along
  double core, radius, width;

  Vec3 local(const Vec3& x) const { return axes.transpose() * (x - tip.at); }
  bool holds(const Vec3& x) const { return x.head<2>().norm() < radius && std::abs(x.z()) < width; }
  double along(double z) const { return std::max(0.0, 1 - z * z / (width * width)); }
  double across(double r) const { return r < core ? 1 : (radius - r) / (radius - core); }
  double reach() const { return std::sqrt(radius * radius + width * width); }
  double weight(const Vec3& x) const { return across(x.head<2>().norm()) * along(x.z()); }
  // Gradient of the weight at a point that the domain holds.
  Vec3 gradient(const Vec3& x) const {
    const double r = x.head<2>().norm();
    const Vec3 ends(0, 0, -2 * across(r) * x.z() / (width * width));
    return r < core ? ends : Vec3(ends - along(x.z()) / ((radius - core) * r) * Vec3(x.x(), x.y(), 0));
  }
};

namespace {

using Domain = InteractionIntegral::Domain;

// Whether a face is nearly across the front, by its corners in the frame of the tip. Slivers have
// no normal to tell that by.
bool ends_front(const std::array<Vec3, 3>& corners) {
  double along = 0, across = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3 edge = corners[(k + 1) % 3] - corners[k];
    along = std::max(along, std::abs(edge.z()));
    across = std::max(across, edge.head<2>().norm());
  }
  return along < end_slope * across;
}

// The distance of the axis of a domain from the nearest surface that is not the front's own crack
// and does more than end the front.
double distance_to_others(const Complex& complex, const Domain& domain, std::int32_t crack) {
  std::vector<FaceId> near;
  complex.faces_near(Box3{domain.tip.at, domain.tip.at}.grown(domain.radius), near);
  double nearest = domain.radius;
  for (const FaceId face : near) {
    if (complex.face(face).crack == crack) continue;
    const auto [a, b, c] = complex.corners(face);
    if (ends_front({domain.local(a), domain.local(b), domain.local(c)})) continue;
    const Vec3 x = domain.local(closest_point_on_triangle(domain.tip.at, a, b, c));
    if (std::abs(x.z()) < domain.width) nearest = std::min(nearest, x.head<2>().norm());
  }
  return nearest;
}

// How far the crack goes straight back from the tip, up to the domain's radius, by six samples.
double crack_length(const Complex& complex, const Domain& domain) {
  constexpr int samples = 6;
  for (int k = 1; k <= samples; ++k) {
    const Vec3 back = domain.tip.at - (k - 0.5) / samples * domain.radius * domain.tip.ahead;
    const Vec3 across = 0.1 * domain.radius * domain.tip.normal;
    if (!is_blocked(complex, back + across, back - across)) return (k - 1.0) / samples * domain.radius;
  }
  return domain.radius;
}

// How far the crack lies in the plane of the tip, up to the domain's radius: a tenth of its
// distance beside it, an angle of six degrees, the most that a front turns without a new direction.
double straight_length(const Complex& complex, const Domain& domain, std::int32_t crack) {
  std::vector<FaceId> near;
  complex.faces_near(Box3{domain.tip.at, domain.tip.at}.grown(domain.radius), near);
  double length = domain.radius;
  for (const FaceId face : near) {
    if (complex.face(face).crack != crack) continue;
    for (const Vec3& corner : complex.corners(face)) {
      const Vec3 x = domain.local(corner);
      if (domain.holds(x) && std::abs(x.y()) > 0.1 * x.norm()) length = std::min(length, x.head<2>().norm());
    }
  }
  return length;
}

// ∫ of the weight along the part of the front that is in the material and in the domain.
double weighted_length(const FrontState& front, const Domain& domain) {
  double length = 0;
  for (const auto& segment : front.segments)
    for (std::size_t k = 1; k < segment.size(); ++k) {
      if (!segment[k - 1].id.valid() || !segment[k].id.valid()) continue;
      const Vec3 a = domain.local(segment[k - 1].position), b = domain.local(segment[k].position);
      constexpr int parts = 8;  // of a segment, by the midpoint rule: within 1 % of a parabola
      for (int p = 0; p < parts; ++p) {
        const Vec3 x = a + (p + 0.5) / parts * (b - a);
        if (domain.holds(x)) length += (b - a).norm() / parts * domain.along(x.z());
      }
    }
  return length;
}

}  // namespace

std::optional<Vec3> InteractionIntegral::at(const GrowingFront& front, std::size_t i, const Mat3& rotation) const {
  const TipFrame tip = tip_frame(front, i);
  const auto nearest = body_.cache->grid.nearest(body_.nodes.position, tip.at, 1, ~0u, [](auto) { return true; });
  if (nearest.empty()) return {};
  const double h = body_.nodes.spacing[nearest[0]];
  Domain domain{.tip = tip,
                .axes = (Mat3() << tip.ahead, tip.normal, tip.along()).finished(),
                .core = core * h,
                .radius = outer * h,
                .width = half_width * h};
  domain.radius = distance_to_others(body_.surface, domain, front.front.crack);
  domain.radius = straight_length(body_.surface, domain, front.front.crack);
  domain.radius = crack_length(body_.surface, domain);
  const double length = weighted_length(front.front, domain);
  if (!(domain.radius > least_outer * h) || !(length > 0.1 * h)) return {};

  Sum sum;
  add_points(domain, rotation, sum);
  if (sum.points < least_points) return {};
  add_inertia(domain, rotation, h, sum);
  return sum.factor.cwiseProduct(sum.integral) / length;
}

void InteractionIntegral::add_points(const Domain& domain, const Mat3& rotation, Sum& sum) const {
  const MaterialPoints& points = SolidDiscretisation::of(solid_).points;
  const Vec3& tip = domain.tip.at;
  const Box3 box = Box3{tip, tip}.grown(domain.reach());
  std::vector<Mat3> gradient;
  PointRelaxation relaxation;
  for (std::size_t b = 0; b < points.blocks.size(); ++b) {
    const PointBlock& block = points.blocks[b];
    if (!block.box.meets(box)) continue;
    gradient.clear();
    for (std::size_t p = 0; p < block.points.size(); ++p) {
      const MaterialPoint& point = block.points[p];
      const Vec3 x = domain.local(point.position);
      if (!domain.holds(x) || point.quality == MomentQuality::singular) continue;
      if (gradient.empty()) {
        gradient = points.gradients(b, motion_.displacement);
        relaxation = relaxation_of(points, b, {.prestretch = motion_.prestretch});
      }
      const Material& material = solid_.materials()[point.material];
      const Mat3 slope =
          domain.axes.transpose() *
          (rotation.transpose() * (Mat3::Identity() + gradient[p]) * relaxation.at(p) - Mat3::Identity()) * domain.axes;
      const Mat3 strain = 0.5 * (slope + slope.transpose());
      const Mat3 stress = material.lambda() * strain.trace() * Mat3::Identity() + 2 * material.mu() * strain;
      const double r = x.head<2>().norm(), angle = angle_of(x.y(), x.x());
      const Vec3 falls = domain.gradient(x);
      const Mat3 ahead = mode_slope(material, r, angle);
      for (int mode = 0; mode < 3; ++mode) {
        const Mat3 unit = mode_stress(material.poisson, mode, r, angle);
        sum.integral[mode] += point.volume * ((stress * ahead.col(mode) + unit * slope.col(0)).dot(falls) -
                                              unit.cwiseProduct(strain).sum() * falls.x());
      }
      const double plane = 0.5 * material.young / (1 - material.poisson * material.poisson);
      sum.factor = Vec3(plane, plane, material.mu());
      ++sum.points;
    }
  }
}

// ∫ ρ ü · ∇uᵃ e₁ q dV, by the masses of the nodes. A node nearer to the tip than a tenth of a
// spacing stands for material that is farther away.
void InteractionIntegral::add_inertia(const Domain& domain, const Mat3& rotation, double spacing, Sum& sum) const {
  if (motion_.acceleration.size() != body_.nodes.size()) return;
  std::vector<std::uint32_t> near;
  body_.cache->grid.within(body_.nodes.position, domain.tip.at, domain.reach(), near);
  for (const std::uint32_t i : near) {
    const Vec3 x = domain.local(body_.nodes.position[i]);
    if (!domain.holds(x)) continue;
    const double r = std::max(x.head<2>().norm(), 0.1 * spacing);
    const Vec3 force = solid_.mass(NodeId(i)) * (rotation * domain.axes).transpose() * motion_.acceleration[i];
    sum.integral +=
        domain.weight(x) * mode_slope(solid_.materials().of(i), r, angle_of(x.y(), x.x())).transpose() * force;
  }
}

}  // namespace geo
