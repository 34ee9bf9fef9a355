// Hestenes and Stiefel (1952) with preconditioner M, each island with its own α = r · z / p · Hp
// and β = r' · z' / r · z, where z = M⁻¹ r. An island that is done is left out of all later
// products.
#include "mechanics/solver/conjugate_gradients.h"

#include <utility>

namespace geo {
namespace {

constexpr int max_iterations = 500;  // ends a solve that rounding keeps from converging

// Reductions of r · M⁻¹ r, the square of the preconditioned norm of the residual: to about a half
// (docs/decisions/049) and a quarter (048) of that norm.
constexpr double first_direction_reduction = 0.3, inexact_reduction = 0.05;

// Share of r · M⁻¹ r from which on the coarse level moves an island first. It is 0.65 to 0.75 in
// free flight, and below 0.2 where contact acts (docs/decisions/065).
constexpr double coarse_share = 0.6;

class Solve {
 public:
  Solve(IncrementalPotential& potential, TwoLevelPreconditioner& preconditioner, const ActiveIslands& active,
        const CgStopping& stopping, NewtonDirection& direction)
      : potential_(potential),
        preconditioner_(preconditioner),
        stopping_(stopping),
        x_(direction.step),
        residual_(direction.residual),
        working_(active),
        mask_(active.mask()),
        r_(x_.size()),
        z_(x_.size()),
        p_(x_.size(), Vec3::Zero()),
        hp_(x_.size()),
        alpha_(mask_.size()),
        norm_(mask_.size(), 0) {}

  int run(const std::vector<Vec3>& force) {
    working_.each_node([&](std::size_t i) {
      x_[i].setZero();
      r_[i] = force[i];
    });
    precondition(working_, rz_);
    initial_rz_ = rz_;
    const bool coarse_moves = stopping_.first_direction && move_along_coarse_level();
    working_.each_node([&](std::size_t i) { p_[i] = z_[i]; });
    while (iterations_ < max_iterations && select_unconverged()) {
      iterate();
      ++iterations_;
    }
    return iterations_ + (coarse_moves ? 1 : 0);
  }

 private:
  // z = M⁻¹ r, product = r · z and the largest |z| in spacings, of the islands given.
  void precondition(const ActiveIslands& islands, std::vector<double>& product) {
    preconditioner_.apply(islands, r_);
    islands.sum_and_maximum(product, residual_, [&](std::size_t i) {
      z_[i] = preconditioner_.at(i);
      return std::pair(r_[i].dot(z_[i]), potential_.problem().squared_in_spacings(z_[i], i));
    });
    islands.take_square_roots(residual_);
  }

  // Minimises along the coarse part of z where it is most of z, and preconditions what remains. A
  // force that moves large parts as they are, weight in free flight above all, is answered by the
  // coarse level alone; subdomains would add motions within them, which take many iterations to
  // undo. False where no island moves.
  bool move_along_coarse_level() {
    std::vector<double> product;
    working_.sum(product, 0.0, [&](std::size_t i) {
      p_[i] = preconditioner_.coarse_at(i);
      return p_[i].dot(r_[i]);
    });
    std::vector<char> moves(mask_.size());
    for (std::size_t q = 0; q < mask_.size(); ++q) moves[q] = mask_[q] && product[q] > coarse_share * rz_[q];
    ActiveIslands moving = working_;
    moving.select(moves);
    if (moving.none()) return false;
    step_along(moving, moves, product);
    precondition(moving, rz_);
    return true;
  }

  // x += α p, r −= α Hp with α = product / p · Hp; leaves out of `mask` what has no curvature.
  void step_along(ActiveIslands& islands, std::vector<char>& mask, const std::vector<double>& product) {
    potential_.multiply(islands, p_, hp_, curvature_);
    for (std::size_t q = 0; q < mask.size(); ++q) {
      if (mask[q] && !(curvature_[q] > 0)) mask[q] = 0;
      alpha_[q] = mask[q] ? product[q] / curvature_[q] : 0;
    }
    islands.select(mask);
    islands.maximum(norm_, [&](std::size_t i) {
      const double a = alpha_[potential_.islands().of(i)];
      x_[i] += a * p_[i];
      r_[i] -= a * hp_[i];
      return potential_.problem().squared_in_spacings(x_[i], i);
    });
    islands.take_square_roots(norm_);
  }

  bool is_done(std::size_t q) const {
    if (!(rz_[q] > 0)) return true;
    const double tolerance = StepProblem::quadratic_tolerance(stopping_.accuracy[q]);
    const bool accurate = iterations_ > 0 && residual_[q] < 0.5 * stopping_.accuracy[q];
    const bool needs_another = norm_[q] * (norm_[q] + stopping_.moved[q]) > tolerance;
    return (accurate && (!stopping_.first_direction || rz_[q] <= first_direction_reduction * initial_rz_[q])) ||
           (needs_another && rz_[q] <= inexact_reduction * initial_rz_[q]);
  }

  // False where all islands are done.
  bool select_unconverged() {
    for (std::size_t q = 0; q < mask_.size(); ++q)
      if (mask_[q] && is_done(q)) mask_[q] = 0;
    working_.select(mask_);
    return !working_.none();
  }

  void iterate() {
    step_along(working_, mask_, rz_);
    precondition(working_, next_rz_);
    working_.each_node([&](std::size_t i) {
      const auto q = potential_.islands().of(i);
      p_[i] = z_[i] + next_rz_[q] / rz_[q] * p_[i];
    });
    for (std::size_t q = 0; q < mask_.size(); ++q)
      if (mask_[q]) rz_[q] = next_rz_[q];
  }

  IncrementalPotential& potential_;
  TwoLevelPreconditioner& preconditioner_;
  const CgStopping& stopping_;
  std::vector<Vec3>& x_;
  std::vector<double>& residual_;
  ActiveIslands working_;
  int iterations_ = 0;
  std::vector<char> mask_;                                                    // per island: not done
  std::vector<Vec3> r_, z_, p_, hp_;                                          // per node
  std::vector<double> rz_, next_rz_, initial_rz_, curvature_, alpha_, norm_;  // per island; rz: r · z
};

}  // namespace

int conjugate_gradients(IncrementalPotential& potential, TwoLevelPreconditioner& preconditioner,
                        const ActiveIslands& active, const std::vector<Vec3>& force, const CgStopping& stopping,
                        NewtonDirection& direction) {
  return Solve(potential, preconditioner, active, stopping, direction).run(force);
}

}  // namespace geo
