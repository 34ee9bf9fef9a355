#include "contact/mutual_contact.h"

#include <algorithm>
#include <cmath>

#include "contact/friction.h"

namespace geo {

void MutualContact::begin(const std::vector<Vec3>& u, double, double) {
  for (Row& row : rows_) row.start = row.at(u), row.pressed = row.stiffness * row.depth(u);
}

void MutualContact::each_row(const VisitRow& visit) const {
  for (const Row& row : rows_) visit(row.apart, row.curvature);
}

void MutualContact::add_energy(const std::vector<Vec3>& u, std::span<const std::uint32_t> part, std::vector<double>& sums) const {
  for (const Row& row : rows_) {
    if (row.apart.empty()) continue;
    double& sum = sums[part[row.apart[0].node]];
    sum += 0.5 * row.stiffness * std::pow(row.depth(u), 2);
    if (row.pressed > 0) sum += friction_energy(friction_ * row.pressed, row.along(row.at(u) - row.start).norm(), slow_);
  }
}

void MutualContact::force(const std::vector<Vec3>& u, std::vector<Vec3>& out) {
  for (Row& row : rows_) {
    const double depth = row.depth(u);
    const Mat3 across = row.normal * row.normal.transpose();
    Vec3 f = row.stiffness * depth * row.normal;
    row.curvature = depth > 0 ? Mat3(row.stiffness * across) : Mat3(Mat3::Zero());
    if (row.pressed > 0) {
      const Vec3 slide = row.along(row.at(u) - row.start);
      const double drag = friction_drag(friction_ * row.pressed, slide.norm(), slow_);
      f -= drag * slide;
      row.curvature += drag * (Mat3::Identity() - across);
    }
    if (f.isZero(0)) continue;
    for (const auto& e : row.apart) out[e.node] += e.weight * f;
  }
}

void MutualContact::each_stiffness(const VisitStiffness& visit) const {
  for (const Row& row : rows_) visit(row.apart, row.stiffness);
}

void MutualContact::impulse(const std::vector<Vec3>& u, double h, const std::vector<double>& inverse_mass, std::vector<Vec3>& velocity) {
  for (const Row& row : rows_) {
    const double push = h * row.stiffness * row.depth(u);
    double lightness = 0;
    for (const auto& e : row.apart) lightness += e.weight * e.weight * inverse_mass[e.node];
    if (!(push > 0 && lightness > 0)) continue;
    const Vec3 slide = row.along(row.at(velocity));
    const double speed = slide.norm(), most = friction_ * push;
    const Vec3 total = push * row.normal - (speed > most * lightness ? most / speed : 1 / lightness) * slide;
    for (const auto& e : row.apart) velocity[e.node] += inverse_mass[e.node] * e.weight * total;
  }
}

double MutualContact::depth(const std::vector<Vec3>& u) const {
  double most = 0;
  for (const Row& row : rows_) most = std::max(most, row.depth(u));
  return most;
}

}  // namespace geo
