#include "contact/response/body_contact_penalty.h"

#include <algorithm>
#include <cmath>

#include "mechanics/terms/contact_law.h"

namespace geo {

void BodyContactPenalty::begin_substep(const std::vector<Vec3>& u, double, double) {
  for (Row& row : rows_) row.start = row.at(u), row.pressed = row.stiffness * row.depth(row.start);
}

double BodyContactPenalty::energy(std::size_t r, const Vec3& apart) const {
  const Row& row = rows_[r];
  const double normal = 0.5 * row.stiffness * std::pow(row.depth(apart), 2);
  return row.pressed > 0 ? normal + friction_energy(friction_ * row.pressed, row.along(apart - row.start).norm(), slow_)
                         : normal;
}

Potential::Derivatives BodyContactPenalty::derivatives(std::size_t r, const Vec3& apart) {
  const Row& row = rows_[r];
  const double depth = row.depth(apart);
  const Mat3 across = row.normal * row.normal.transpose();
  Derivatives result{row.stiffness * depth * row.normal, depth > 0 ? Mat3(row.stiffness * across) : Mat3(Mat3::Zero())};
  if (row.pressed > 0) {
    const Vec3 slide = row.along(apart - row.start);
    const double drag = friction_drag(friction_ * row.pressed, slide.norm(), slow_);
    result.force -= drag * slide, result.hessian += drag * (Mat3::Identity() - across);
  }
  return result;
}

void BodyContactPenalty::apply_impulse(const std::vector<Vec3>& u, double h, const std::vector<double>& inverse_mass,
                                       std::vector<Vec3>& velocity) {
  for (const Row& row : rows_) {
    const double push = h * row.stiffness * row.depth(row.at(u));
    double lightness = 0;
    for (const auto& e : row.apart) lightness += e.weight * e.weight * inverse_mass[e.node];
    if (!(push > 0 && lightness > 0)) continue;
    const Vec3 slide = row.along(row.at(velocity));
    const double speed = slide.norm(), most = friction_ * push;
    const Vec3 total = push * row.normal - (speed > most * lightness ? most / speed : 1 / lightness) * slide;
    for (const auto& e : row.apart) velocity[e.node] += inverse_mass[e.node] * e.weight * total;
  }
}

double BodyContactPenalty::depth(const std::vector<Vec3>& u) const {
  double most = 0;
  for (const Row& row : rows_) most = std::max(most, row.depth(row.at(u)));
  return most;
}

}  // namespace geo
