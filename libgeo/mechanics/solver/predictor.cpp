// ũ + τ² a, with the acceleration a of the last step where an affine field explains it.
// Then the minimiser of a parabola towards u₀, or the finite rotation, where the potential is less
// there.
#include "mechanics/solver/predictor.h"

#include <algorithm>

#include "geometry/affine_fit.h"
#include "mechanics/solver/fixed_nodes.h"

namespace geo {
namespace {

// Nodal accelerations of an island are used where an affine field explains this share of their
// squares. Bodies that fall or swing have such accelerations; those of vibrations change from step
// to step. Measured in docs/decisions/049.
constexpr double affine_share = 0.8;

// Per node: τ² a with the acceleration a of the last step, or of the loads where that is unknown.
// Zero where it is too long to be trusted: half a spacing, or a spacing for loads.
std::vector<Vec3> accelerated(const IncrementalPotential& potential, const ActiveIslands& all) {
  const StepProblem& problem = potential.problem();
  const SolidDiscretisation& solid = problem.solid;
  const bool is_known = problem.start.acceleration.size() == solid.size();
  std::vector<Vec3> added(solid.size(), Vec3::Zero());
  all.each_node([&](std::size_t i) {
    const Vec3 d = potential.squared_time(potential.islands().of(i)) *
                   (is_known ? problem.start.acceleration[i] : Vec3(potential.load()[i] / solid.mass[i]));
    if (!is_fixed(problem.environment, i) && d.norm() < (is_known ? 0.5 : 1.0) * solid.spacing[i]) added[i] = d;
  });
  return added;
}

// Per island: whether the affine field ā + G (x − c) nearest to a nodal field a, weighted by mass,
// has most of its squares: Σm |ā|² + G : Σ m a (x − c)ᵀ > affine_share Σ m |a|².
std::vector<char> mostly_affine(const IncrementalPotential& potential, const ActiveIslands& all,
                                const std::vector<Vec3>& field) {
  const StepProblem& problem = potential.problem();
  const SolidDiscretisation& solid = problem.solid;
  const Islands& islands = potential.islands();
  std::vector<double> mass, squares;
  std::vector<Vec3> centre, mean;
  std::vector<Mat3> moment, product;
  const auto m = [&](std::size_t i) { return is_fixed(problem.environment, i) ? 0.0 : solid.mass[i]; };
  const auto arm = [&](std::size_t i) -> Vec3 { return solid.position[i] - centre[islands.of(i)]; };
  all.sum(mass, 0.0, m);
  all.sum(centre, Vec3(Vec3::Zero()), [&](std::size_t i) -> Vec3 { return m(i) * solid.position[i]; });
  all.sum(mean, Vec3(Vec3::Zero()), [&](std::size_t i) -> Vec3 { return m(i) * field[i]; });
  all.sum(squares, 0.0, [&](std::size_t i) { return m(i) * field[i].squaredNorm(); });
  for (std::size_t p = 0; p < mass.size(); ++p)
    if (mass[p] > 0) {
      centre[p] /= mass[p];
      mean[p] /= mass[p];
    }
  all.sum(moment, Mat3(Mat3::Zero()), [&](std::size_t i) -> Mat3 { return m(i) * arm(i) * arm(i).transpose(); });
  all.sum(product, Mat3(Mat3::Zero()), [&](std::size_t i) -> Mat3 { return m(i) * field[i] * arm(i).transpose(); });
  std::vector<char> affine(mass.size());
  for (std::size_t p = 0; p < mass.size(); ++p) {
    constexpr double regularisation = 1e-9;  // of the trace: islands on a plane or line have a singular moment
    const double linear =
        moment[p].trace() > 0 ? linear_fit(product[p], moment[p], regularisation).cwiseProduct(product[p]).sum() : 0;
    affine[p] = mass[p] * mean[p].squaredNorm() + linear > affine_share * squares[p];
  }
  return affine;
}

// Velocities continue; accelerations do where they are mostly affine.
std::vector<Vec3> inertial_prediction(const IncrementalPotential& potential, const ActiveIslands& all) {
  std::vector<Vec3> u = potential.inertial_target();
  const std::vector<Vec3> added = accelerated(potential, all);
  const std::vector<char> affine = mostly_affine(potential, all, added);
  all.each_node([&](std::size_t i) {
    if (affine[potential.islands().of(i)]) u[i] += added[i];
  });
  return u;
}

// Line search from the inertial prediction (share 0) back to the start of the step (share 1): an
// impact, a cut or a load makes the prediction wrong. With E_0, E_1 the potential at both ends and
// g the decrease that the forces at 0 promise, a parabola has its minimum at g / (2 (E_1 − E_0 +
// g)). Candidates: islands with g greater than the inertial energy of the whole way. Islands that
// rotate begin after their finite rotation if the potential is less there than at both ends.
// Returns per island whether its nodes were moved.
std::vector<char> warm_start(IncrementalPotential& potential, const FiniteRotation& rotation, ActiveIslands all,
                             NewtonIterate& at) {
  constexpr double least_way_back = 0.2;  // a shorter way back gains less than its evaluation costs
  const StepProblem& problem = potential.problem();
  const SolidDiscretisation& solid = problem.solid;
  const std::vector<Vec3>& start = problem.start.displacement;
  const std::size_t islands = potential.islands().count();
  std::vector<double> decrease, inertia, value_at_start, value_rotated, share(islands, 0);
  std::vector<char> candidate(islands), rotates, moved(islands);
  const auto back = [&](std::size_t i) -> Vec3 { return start[i] - at.u[i]; };
  all.sum(decrease, 0.0, [&](std::size_t i) { return back(i).dot(at.force[i]); });
  all.sum(inertia, 0.0, [&](std::size_t i) {
    return 0.5 * solid.mass[i] / potential.squared_time(potential.islands().of(i)) * back(i).squaredNorm();
  });
  for (std::size_t p = 0; p < islands; ++p) candidate[p] = decrease[p] > inertia[p];
  all.select(candidate);
  potential.evaluate(all, start, value_at_start);
  const std::vector<Vec3> rotated = rotation.predict(at.u, rotates);
  for (std::size_t p = 0; p < islands; ++p) rotates[p] = rotates[p] && candidate[p];
  if (!rotated.empty()) {
    all.select(rotates);
    potential.evaluate(all, rotated, value_rotated);
  }
  for (std::size_t p = 0; p < islands; ++p) {
    rotates[p] = rotates[p] && value_rotated[p] < std::min(at.value[p], value_at_start[p]);
    if (!candidate[p] || rotates[p]) continue;
    const double bend = 2 * (value_at_start[p] - at.value[p] + decrease[p]),
                 best = bend > decrease[p] ? decrease[p] / bend : 1;
    if (best > least_way_back) share[p] = best > 1 - least_way_back ? 1 : best;
  }
  for (std::size_t p = 0; p < islands; ++p) moved[p] = rotates[p] || share[p] > 0;
  all.select(moved);
  all.each_node([&](std::size_t i) {
    const auto p = potential.islands().of(i);
    at.u[i] = rotates[p] ? rotated[i] : share[p] == 1 ? start[i] : Vec3((1 - share[p]) * at.u[i] + share[p] * start[i]);
  });
  return moved;
}

}  // namespace

NewtonIterate predict(IncrementalPotential& potential, const FiniteRotation& rotation, ActiveIslands all) {
  NewtonIterate at;
  at.u = inertial_prediction(potential, all);
  at.force.resize(at.u.size());
  potential.evaluate(all, at.u, at.value, &at.response);
  potential.force(all, at.u, at.response, at.force);
  all.select(warm_start(potential, rotation, all, at));
  if (all.none()) return at;
  potential.evaluate(all, at.u, at.value, &at.response);
  potential.force(all, at.u, at.response, at.force);
  return at;
}

}  // namespace geo
