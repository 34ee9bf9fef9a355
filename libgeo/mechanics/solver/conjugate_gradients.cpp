// Hestenes and Stiefel (1952) with preconditioner M, each island with its own α = r · z / p · Hp
// and β = r' · z' / r · z, where z = M⁻¹ r. An island that is done is left out of all later
// products.
#include "mechanics/solver/conjugate_gradients.h"

#include <utility>

namespace geo {
namespace {

constexpr int most_iterations = 500;  // ends a solve that rounding keeps from converging

// Reductions of r · M⁻¹ r, the square of the preconditioned norm of the residual: to about a half
// (docs/decisions/049) and a quarter (048) of that norm.
constexpr double first_direction_reduction = 0.3, inexact_reduction = 0.05;

}  // namespace

int conjugate_gradients(IncrementalPotential& potential, TwoLevelPreconditioner& preconditioner,
                        const ActiveIslands& active, const std::vector<Vec3>& force, const CgStopping& stopping,
                        NewtonDirection& direction) {
  const StepProblem& problem = potential.problem();
  const Islands& islands = potential.islands();
  const std::size_t n = force.size(), count = islands.count();
  ActiveIslands working = active;
  std::vector<char> mask = active.mask();
  std::vector<Vec3>& x = direction.step;
  std::vector<double>& residual = direction.residual;
  std::vector<Vec3> r(n), z(n), p(n, Vec3::Zero()), hp(n);
  std::vector<double> rz, next_rz, curvature, alpha(count), norm(count, 0);  // rz: r · z
  const auto apply_preconditioner = [&](std::vector<double>& product) {
    preconditioner.apply(working, r);
    working.sum_and_maximum(product, residual, [&](std::size_t i) {
      z[i] = preconditioner.at(i);
      return std::pair(r[i].dot(z[i]), problem.squared_in_spacings(z[i], i));
    });
    working.take_square_roots(residual);
  };
  working.each_node([&](std::size_t i) { x[i].setZero(), r[i] = force[i]; });
  apply_preconditioner(rz);
  working.each_node([&](std::size_t i) { p[i] = z[i]; });
  const std::vector<double> initial_rz = rz;
  const auto is_done = [&](std::size_t q, int iteration) {
    if (!(rz[q] > 0)) return true;
    const double tolerance = StepProblem::quadratic_tolerance(stopping.accuracy[q]);
    const bool accurate = iteration > 0 && residual[q] < 0.5 * stopping.accuracy[q];
    const bool needs_another = norm[q] * (norm[q] + stopping.moved[q]) > tolerance;
    return (accurate && (!stopping.first_direction || rz[q] <= first_direction_reduction * initial_rz[q])) ||
           (needs_another && rz[q] <= inexact_reduction * initial_rz[q]);
  };
  int k = 0;
  for (; k < most_iterations; ++k) {
    for (std::size_t q = 0; q < count; ++q)
      if (mask[q] && is_done(q, k)) mask[q] = 0;
    working.select(mask);
    if (working.none()) break;
    potential.multiply(working, p, hp, curvature);
    for (std::size_t q = 0; q < count; ++q) {
      if (mask[q] && !(curvature[q] > 0)) mask[q] = 0;
      alpha[q] = mask[q] ? rz[q] / curvature[q] : 0;
    }
    working.select(mask);
    working.maximum(norm, [&](std::size_t i) {
      const double a = alpha[islands.of(i)];
      x[i] += a * p[i], r[i] -= a * hp[i];
      return problem.squared_in_spacings(x[i], i);
    });
    working.take_square_roots(norm);
    apply_preconditioner(next_rz);
    working.each_node([&](std::size_t i) { p[i] = z[i] + next_rz[islands.of(i)] / rz[islands.of(i)] * p[i]; });
    for (std::size_t q = 0; q < count; ++q)
      if (mask[q]) rz[q] = next_rz[q];
  }
  return k;
}

}  // namespace geo
