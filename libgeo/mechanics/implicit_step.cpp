#include "mechanics/implicit_step.h"

#include <cmath>
#include <numeric>

#include "base/error.h"
#include "mechanics/ground.h"
#include "mechanics/plasticity.h"

namespace geo {

ImplicitStep::ImplicitStep(const Solid& solid, const State& state, double dt, const Environment& env, double accuracy)
    : s_(solid), state_(state), env_(env), dt_(dt), accuracy_(accuracy), n_(solid.size()), relaxed_(solid.relaxed(state)),
      u_(n_), target_(n_), load_(n_), drag_(n_, 0), gradient_(solid.points_.blocks.size()), modes_(gradient_.size()), weight_(gradient_.size()), local_(n_) {
  const double keep = 1 / (1 + s_.material_.damping * dt);
  for (std::size_t i = 0; i < n_; ++i) {
    target_[i] = state.displacement[i];
    load_[i] = s_.mass_[i] * env.gravity;
    if (!env.load.empty()) load_[i] += env.load[i];
    if (!is_fixed(env, i)) target_[i] += dt * keep * state.velocity[i];
  }
  // Newton begins where nodes come to if they accelerate as in the step before, or, where that is unknown, fly on their own,
  // unless that is too far from anything.
  u_ = target_;
  const bool known = state.acceleration.size() == n_;
  for (std::size_t i = 0; i < n_; ++i) {
    const Vec3 more = dt * dt * (known ? state.acceleration[i] : Vec3(load_[i] / s_.mass_[i]));
    if (!is_fixed(env, i) && more.norm() < (known ? 0.5 : 1.0) * s_.spacing_[i]) u_[i] += more;
  }
  // Drag along the ground: lagged, from where the step began.
  if (env.ground)
    for (std::size_t i = 0; i < n_; ++i)
      if (depth(env, i, s_.position_[i] + state.displacement[i]) > 0) drag_[i] = s_.mass_[i] * env.friction / (0.01 * dt);
  for (std::size_t b = 0; b < weight_.size(); ++b) {
    const auto& points = s_.points_.blocks[b].points;
    weight_[b].assign((points.size() + 7) / 8 * 8, 0);
    for (std::size_t i = 0; i < points.size(); ++i) weight_[b][i] = points[i].rung == Rung::rigid ? 0.0f : float(points[i].volume);
    if (s_.material_.viscosity > 0) before_.push_back(s_.points_.gradients(b, state.displacement));
  }
}

double ImplicitStep::evaluate(const std::vector<Vec3>& u, std::vector<Vec3>* force) {
  const Material& m = s_.material_;
  std::vector<double> energy(gradient_.size(), 0);
  s_.points_.transform(u, [&](std::size_t b, std::span<Mat3> g) {
    Columns<float>& kept = gradient_[b];
    kept.resize(g.size());
    for (std::size_t i = 0; i < g.size(); ++i) {
      const MaterialPoint& p = s_.points_.blocks[b].points[i];
      Mat3 f = Mat3::Identity() + g[i];
      if (!relaxed_.empty()) f = f * relaxed_[s_.points_.first(b) + i];
      for (int c = 0; c < 3; ++c)
        for (int r = 0; r < 3; ++r) kept.column[c][4 * i + static_cast<std::size_t>(r)] = float(f(r, c) - (r == c));
      if (p.rung == Rung::rigid) {
        g[i].setZero();
        continue;
      }
      energy[b] += p.volume * energy_density(m, f);
      Mat3 pull = stress(m, f);
      if (!relaxed_.empty()) pull = pull * relaxed_[s_.points_.first(b) + i];
      if (!before_.empty()) {
        const Mat3 whole = Mat3::Identity() + g[i], was = Mat3::Identity() + before_[b][i];
        const Mat3 rate = 0.5 / dt_ * (whole.transpose() * whole - was.transpose() * was);
        energy[b] += 0.5 * dt_ * p.volume * m.viscosity * rate.squaredNorm();
        pull += m.viscosity * whole * rate;
      }
      g[i] = p.volume * pull;
    }
  }, force);
  double sum = std::accumulate(energy.begin(), energy.end(), 0.0);
  if (s_.penalty_) sum += s_.penalty_->add(s_.rows_, u, force);
  elastic_ = sum;
  if (force)
    for (Vec3& f : *force) f = -f;
  for (const Potential* p : env_.contact) sum += p->energy(u);
  for (std::size_t i = 0; i < n_; ++i) {
    sum += 0.5 * s_.mass_[i] / (dt_ * dt_) * (u[i] - target_[i]).squaredNorm() - load_[i].dot(u[i] - state_.displacement[i]);
    if (!env_.ground) continue;
    const double d = depth(env_, i, s_.position_[i] + u[i]);
    if (d > 0) sum += 0.5 * s_.mass_[i] * env_.ground_stiffness * d * d;
    if (drag_[i] > 0) sum += 0.5 * drag_[i] * tangential(u[i] - state_.displacement[i]).squaredNorm();
  }
  return sum;
}

// Internal forces do not change the mean motion of a part that nothing holds: neither must rounding or an unfinished solve.
// The direction takes such a part to where inertia and loads alone bring its middle.
void ImplicitStep::keep_momentum(std::vector<Vec3>& direction) const {
  if (!env_.contact.empty()) return;
  std::vector<char> held(s_.parts_, 0);
  std::vector<Vec3> mean(s_.parts_, Vec3::Zero());
  std::vector<double> mass(s_.parts_, 0);
  for (std::size_t i = 0; i < n_; ++i) {
    const auto part = s_.part_[i];
    held[part] |= is_fixed(env_, i) || (env_.ground && (drag_[i] > 0 || depth(env_, i, s_.position_[i] + u_[i]) > 0));
    mean[part] += s_.mass_[i] * (u_[i] + direction[i] - target_[i]) - dt_ * dt_ * load_[i], mass[part] += s_.mass_[i];
  }
  for (std::size_t i = 0; i < n_; ++i)
    if (const auto part = s_.part_[i]; !held[part]) direction[i] -= mean[part] / mass[part];
}

bool ImplicitStep::run(StepReport& report) {
  std::vector<Vec3> force, elastic, direction(n_), trial(n_), next;
  double value = evaluate(u_, &force), moved = 1e300;
  for (int newton = 0; newton < 20; ++newton, ++report.newton) {
    elastic = force;
    for (Potential* p : env_.contact) p->force(u_, force);
    // The stiffness of points is used again while they have hardly strained since.
    if (moved > 0.15) linearise(), moved = 0;
    precondition();
    for (std::size_t i = 0; i < n_; ++i) {
      Vec3& r = force[i];
      r += load_[i] - s_.mass_[i] / (dt_ * dt_) * (u_[i] - target_[i]);
      if (env_.ground) {
        const double d = depth(env_, i, s_.position_[i] + u_[i]);
        if (d > 0) r += s_.mass_[i] * env_.ground_stiffness * d * env_.ground_normal;
        if (drag_[i] > 0) r -= drag_[i] * tangential(u_[i] - state_.displacement[i]);
      }
      if (is_fixed(env_, i)) r.setZero();
    }
    // Once Newton has made a step, no more than the accuracy asks for.
    report.cg += solve(force, direction, newton > 0 ? 0.5 * accuracy_ : 0);
    keep_momentum(direction);
    const double longest = most(direction);
    double step = 1, tried = 0;
    if (!std::isfinite(longest)) return false;
    // What is left after the direction is a fraction of it or less than the accuracy, as the solve ends there.
    const bool last = longest < 10 * accuracy_;
    const double rounding = 1e-14 * std::abs(value);
    int halvings = 0;
    for (;; ++halvings, step *= 0.5) {
      for (std::size_t i = 0; i < n_; ++i) trial[i] = u_[i] + step * direction[i];
      if (last) break;  // too small a change for the potential to tell
      tried = evaluate(trial, &next);
      if (tried <= value + rounding || halvings == 16) break;
    }
    if (!last && !(tried <= value + rounding)) return longest * step < accuracy_;
    u_.swap(trial);
    moved += step * longest;
    if (last) {
      // To second order: the stiffness times the direction is the force less inertia.
      double energy = elastic_;
      for (std::size_t i = 0; i < n_; ++i)
        energy += direction[i].dot(0.5 * force[i] - elastic[i] - 0.5 * s_.mass_[i] / (dt_ * dt_) * direction[i]);
      report.energy = energy;
      return ++report.newton, true;
    }
    value = tried, force.swap(next);
  }
  return false;
}

std::vector<Vec3> Solid::stiffness_product(const std::vector<Vec3>& u, const std::vector<Vec3>& p) const {
  const State still{u, std::vector<Vec3>(size(), Vec3::Zero()), {}};
  const Environment nothing;
  return ImplicitStep(*this, still, 1, nothing, 1).product(u, p);
}

std::vector<Mat3> Solid::relaxed(const State& state) const {
  if (!state.plastic.empty() && state.plastic.size() != points_.size()) throw InputError("the plastic strains are not those of this solid");
  std::vector<Mat3> all(material_.yield > 0 ? state.plastic.size() : 0);
  parallel_for(all.size(), 256, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) all[i] = relaxation(state.plastic[i]);
  });
  return all;
}

void Solid::update_plasticity(State& state, double dt) const {
  if (material_.yield == 0) return;
  state.plastic.resize(points_.size(), Mat3::Zero());
  parallel_for(points_.blocks.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t b = begin; b < end; ++b) {
      const auto gradient = points_.gradients(b, state.displacement);
      for (std::size_t i = 0; i < gradient.size(); ++i) {
        Mat3& plastic = state.plastic[points_.first(b) + i];
        if (points_.blocks[b].points[i].rung != Rung::rigid) plastic = flow(material_, plastic, Mat3::Identity() + gradient[i], dt);
      }
    }
  });
}

StepReport Solid::step_implicit(State& state, double dt, const Environment& env, double accuracy) const {
  StepReport report;
  // Time steps in a row, each divided in two where Newton does not converge, down to a thousandth.
  const auto advance = [&](const auto& self, double from, double h) -> void {
    for (Potential* p : env.contact) p->begin(state.displacement, from / dt, (from + h) / dt);
    ImplicitStep step(*this, state, h, env, accuracy);
    const bool converged = step.run(report);
    if (!converged && h > dt / 1024) {
      self(self, from, h / 2);
      self(self, from + h / 2, h / 2);
      return;
    }
    ++report.substeps;
    state.acceleration.resize(size());
    for (std::size_t i = 0; i < size(); ++i) {
      const Vec3 velocity = (step.displacement()[i] - state.displacement[i]) / h;
      state.acceleration[i] = (velocity - state.velocity[i]) / h, state.velocity[i] = velocity;
    }
    state.displacement = step.displacement();
    update_plasticity(state, h);
  };
  advance(advance, 0, dt);
  if (material_.yield > 0) report.energy = elastic_force(state.displacement, nullptr, relaxed(state));
  return report;
}

}  // namespace geo
