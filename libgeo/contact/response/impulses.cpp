#include "contact/response/impulses.h"

#include <algorithm>
#include <cmath>

#include "kerf/parallel.h"

namespace geo {

std::vector<RelativeStencil> relative_stencils(const SurfaceWeights& weights,
                                               std::span<const ContactConstraint> touching, const Copies& stands_for,
                                               const std::vector<double>& inverse_mass) {
  std::vector<RelativeStencil> rows(touching.size());
  parallel_for(touching.size(), 64, [&](std::size_t begin, std::size_t end) {
    RelativeStencilBuilder maker(weights, stands_for, inverse_mass);
    for (std::size_t i = begin; i < end; ++i) rows[i] = maker.make(touching[i].a, touching[i].b);
  });
  return rows;
}

ImpulseStats apply_impulses(const SurfaceWeights& weights, std::span<const ContactConstraint> touching,
                            const Copies& stands_for, const std::vector<double>& inverse_mass,
                            const ImpulseOptions& options, std::vector<Vec3>& velocity) {
  ImpulseStats report;
  const std::vector<RelativeStencil> rows = relative_stencils(weights, touching, stands_for, inverse_mass);
  std::vector<double> pressed(touching.size(), 0);
  std::vector<Vec3> rubbed(touching.size(), Vec3::Zero());
  const auto kick = [&](const RelativeStencil& row, const Vec3& impulse) {
    for (const auto& e : row.entries) velocity[e.node] += e.weight * inverse_mass[e.node] * impulse;
  };
  for (report.sweeps = 0; report.sweeps < options.sweeps; ++report.sweeps) {
    double change = 0, speed = 0;
    for (std::size_t i = 0; i < touching.size(); ++i) {
      const RelativeStencil& row = rows[i];
      const Vec3& n = touching[i].normal;
      const double softness = options.softness * row.of_a, mobility = row.mobility + softness;
      if (!(mobility > 0)) continue;
      Vec3 v = weighted_sum(row.entries, velocity);
      const double lack = -touching[i].approach - n.dot(v) - softness * pressed[i];
      const double before = pressed[i];
      if (lack <= 0 && before == 0) continue;
      pressed[i] = std::max(0.0, before + lack / mobility);
      Vec3 impulse = (pressed[i] - before) * n;
      if (options.friction > 0) {
        const Vec3 slip = v - n.dot(v) * n;
        Vec3 rub = rubbed[i] - (slip + softness * rubbed[i]) / mobility;
        rub -= n.dot(rub) * n;
        if (const double most = options.friction * pressed[i], is = rub.norm(); is > most)
          rub *= is > 0 ? most / is : 0.0;
        impulse += rub - rubbed[i];
        rubbed[i] = rub;
      }
      kick(row, impulse);
      change = std::max(change, impulse.norm() * mobility), speed = std::max(speed, v.norm());
    }
    if (change <= options.tolerance * speed || change == 0) break;
  }
  for (const double p : pressed) report.touching += p > 0;
  return report;
}

}  // namespace geo
