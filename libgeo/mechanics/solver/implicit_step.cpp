#include "mechanics/solver/implicit_step.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "kerf/error.h"
#include "mechanics/discretisation/elastic_block.h"
#include "mechanics/material/plasticity.h"
#include "mechanics/solver/ground.h"

namespace geo {

namespace {

// Of what is nearly incompressible the pressure has what rounding makes of strain many times over,
// so that is done in double precision as well.
BlockStrain strain_of(const Materials& materials, const MaterialPoints& points, const std::vector<Vec3>& position,
                      const std::vector<std::uint32_t>& component, const std::vector<Vec3>& u, double accuracy) {
  constexpr double loose = 0.005, stiffer = 50;
  const bool exact = accuracy < loose ||
                     materials.any([](const Material& m) { return m.lambda() + m.volume_term > stiffer * m.mu(); });
  return exact ? BlockStrain(points) : BlockStrain(points, position, component, u);
}

}  // namespace

// Parts of the graph that contact, or the penalty of mueller04, makes depend on each other.
std::vector<std::pair<std::uint32_t, std::uint32_t>> ImplicitStep::couples() const {
  auto pairs = contact_.coupled_components(s_.part_);
  if (s_.penalty_)
    for (std::uint32_t p = 1; p < s_.parts_; ++p) pairs.emplace_back(p - 1, p);
  return pairs;
}

ImplicitStep::ImplicitStep(const Solid& solid, const State& state, double dt, const Environment& env, double accuracy)
    : s_(solid),
      state_(state),
      env_(env),
      dt_(dt),
      accuracy_(accuracy),
      n_(solid.size()),
      contact_(env.contact, state.displacement),
      parts_(solid.points_, solid.patches_, solid.part_, solid.parts_, couples()),
      u_(n_),
      target_(n_),
      load_(n_),
      drag_(n_, 0),
      strain_(strain_of(solid.materials_, solid.points_, solid.position_, solid.part_, state.displacement, accuracy)),
      relaxed_(solid.relaxed(state)),
      gradient_(solid.points_.blocks.size()),
      modes_(gradient_.size()),
      weight_(gradient_.size()),
      local_(n_) {
  std::vector<double> keep;  // per material
  for (const Material& m : s_.materials_.all()) {
    keep.push_back(1 / (1 + m.damping * dt));
    moduli_.push_back({float(m.mu() + m.viscosity / dt / 2), float(m.lambda() + m.volume_term)});
  }
  for (std::size_t i = 0; i < n_; ++i) {
    target_[i] = state.displacement[i];
    load_[i] = s_.mass_[i] * env.gravity;
    if (!env.load.empty()) load_[i] += env.load[i];
    if (!is_fixed(env, i)) target_[i] += dt * keep[s_.materials_.index(i)] * state.velocity[i];
  }
  find_pieces();
  // Drag along the ground: lagged, from where the step began.
  if (env.ground)
    for (std::size_t i = 0; i < n_; ++i)
      if (depth(env, i, s_.position_[i] + state.displacement[i]) > 0)
        drag_[i] = s_.mass_[i] * env.friction / (0.01 * dt);
  const bool viscous = s_.materials_.any([](const Material& m) { return m.viscosity > 0; });
  if (viscous) before_.resize(weight_.size());
  parallel_for(weight_.size(), 4, [&](std::size_t begin, std::size_t end) {
    BlockStrain::Scratch room;
    for (std::size_t b = begin; b < end; ++b) {
      const auto& points = s_.points_.blocks[b].points;
      weight_[b].assign((points.size() + 7) / 8 * 8, 0);
      for (std::size_t i = 0; i < points.size(); ++i)
        weight_[b][i] = points[i].quality == MomentQuality::singular ? 0.0f : float(points[i].volume);
      if (viscous) strain_.gradients(b, state.displacement, room, before_[b]);
    }
  });
}

void ImplicitStep::evaluate(const std::vector<Vec3>& u, std::vector<double>& value, std::vector<Vec3>* force) {
  if (std::find(parts_.chosen().begin(), parts_.chosen().end(), 1) == parts_.chosen().end()) return;
  const MaterialPoints& points = s_.points_;
  const auto blocks = parts_.blocks();
  energy_.resize(parts_.block_first(points.blocks.size())), pull_.resize(4 * points.scatter_size()),
      elastic_.resize(parts_.count());
  std::vector<double> elastic(parts_.count(), 0), contact(parts_.count(), 0);
  parallel_for(blocks.size(), 1, [&](std::size_t begin, std::size_t end) {
    thread_local ElasticBlock::Scratch
        room;  // a hundred bytes a point: too many to ask for, and to clear, block by block
    ElasticBlock work(room, strain_, s_.materials_, dt_);
    for (std::size_t at = begin; at < end; ++at) {
      const std::size_t b = blocks[at];
      const PointHistory history{relaxed_.empty() ? nullptr : &relaxed_[b], before_.empty() ? nullptr : &before_[b]};
      const auto& of_point = work.evaluate(b, u, history, force ? &gradient_[b] : nullptr,
                                           force ? &pull_[4 * points.scatter_offset(b)] : nullptr);
      double* const energy = &energy_[parts_.block_first(b)];
      std::fill_n(energy, parts_.of_block(b).size(), 0.0);
      for (std::size_t i = 0; i < points.blocks[b].points.size(); ++i)
        energy[parts_.slot(b, points.blocks[b], i)] += of_point[i];
    }
  });
  for (const auto b : blocks) {
    const double* energy = &energy_[parts_.block_first(b)];
    for (const auto p : parts_.of_block(b)) elastic[p] += *energy++;
  }
  if (force)
    parts_.each_node([&](std::size_t i) {
      const auto sum = points.sum_at_node<4>(pull_.data(), i);
      (*force)[i] = -Vec3(sum[0], sum[1], sum[2]);
    });
  if (s_.penalty_) {
    std::vector<Vec3> pull(force ? n_ : 0, Vec3::Zero());
    elastic[0] += s_.penalty_->add(s_.rows_, u, force ? &pull : nullptr);
    if (force)
      for (std::size_t i = 0; i < n_; ++i) (*force)[i] -= pull[i];
  }
  parts_.sums(value, 0.0, [&](std::size_t i) {
    double sum = 0.5 * s_.mass_[i] / (dt_ * dt_) * (u[i] - target_[i]).squaredNorm() -
                 load_[i].dot(u[i] - state_.displacement[i]);
    if (!env_.ground) return sum;
    const double d = depth(env_, i, s_.position_[i] + u[i]);
    if (d > 0) sum += 0.5 * s_.mass_[i] * env_.ground_stiffness * d * d;
    if (drag_[i] > 0) sum += 0.5 * drag_[i] * tangential(u[i] - state_.displacement[i]).squaredNorm();
    return sum;
  });
  contact_.add_energy(u, parts_.of_nodes(), parts_.chosen(), contact);
  for (std::size_t p = 0; p < parts_.count(); ++p) {
    if (!parts_.chosen()[p]) continue;
    value[p] += elastic[p] + contact[p];
    if (force) elastic_[p] = elastic[p];
  }
}

// Elastic forces at u_, where evaluate() was asked last, become all that acts on nodes; `elastic`
// keeps them.
void ImplicitStep::add_forces(std::vector<Vec3>& force, std::vector<Vec3>& elastic) {
  parts_.each_node([&](std::size_t i) { elastic[i] = force[i]; });
  contact_.update_derivatives(parts_.of_nodes(), parts_.chosen());
  parts_.each_node([&](std::size_t i) {
    Vec3& r = force[i];
    r += contact_.force_at(i);
    r += load_[i] - s_.mass_[i] / (dt_ * dt_) * (u_[i] - target_[i]);
    if (env_.ground) {
      const double d = depth(env_, i, s_.position_[i] + u_[i]);
      if (d > 0) r += s_.mass_[i] * env_.ground_stiffness * d * env_.ground_normal;
      if (drag_[i] > 0) r -= drag_[i] * tangential(u_[i] - state_.displacement[i]);
    }
    if (is_fixed(env_, i)) r.setZero();
  });
}

bool ImplicitStep::run(StepReport& report) {
  const std::size_t parts = parts_.count();
  std::vector<Vec3> force(n_), elastic(n_), direction(n_), next(n_), trial;
  std::vector<double> value, tried, moved(parts, 1e300), longest(parts, 0), left(parts, 0), step, more, along;
  std::vector<char> active(parts, 1), wanted;
  const auto any = [](const std::vector<char>& of) { return std::find(of.begin(), of.end(), 1) != of.end(); };
  start(value, force, elastic);
  trial = u_;
  for (int newton = 0; newton < 20; ++newton) {
    // The stiffness of points is used again while they have hardly strained since.
    wanted.assign(parts, 0);
    for (std::size_t p = 0; p < parts; ++p)
      if (active[p] && moved[p] > 0.1) wanted[p] = 1, moved[p] = 0;
    parts_.choose(wanted);
    linearise();
    parts_.choose(active);
    precondition();
    report.cg += solve(force, newton == 0, direction, moved, left);
    ++report.newton;
    keep_momentum(direction);
    most(direction, longest);
    // To second order, where a part is done: the stiffness times the direction is the force less
    // inertia.
    parts_.sums(more, 0.0, [&](std::size_t i) {
      return direction[i].dot(0.5 * force[i] - elastic[i] - 0.5 * s_.mass_[i] / (dt_ * dt_) * direction[i]);
    });
    const std::vector<RigidMotion> turns = turning_by(direction);
    std::vector<char> turning(parts, 0);
    for (std::size_t q = 0; q < turns.size(); ++q)
      if (!turns[q].turning.isZero(0)) turning[pieces_[q].part] = 1;
    wanted = active, step.assign(parts, 1);
    for (std::size_t p = 0; p < parts; ++p) {
      if (!active[p]) continue;
      if (!std::isfinite(longest[p])) return false;
      // What is left of a direction grows with its square, or with what the stiffness is behind.
      // Where that is less than the accuracy, and what the solve has left, too, the direction is
      // taken as it is: it changes the potential by too little to tell. Not so one that turns a
      // piece, of which rounding may strain what is stiff.
      if (!turning[p] && longest[p] * (longest[p] + moved[p]) < trusted() && left[p] < accuracy_)
        active[p] = wanted[p] = 0, elastic_[p] += more[p];
    }
    const auto go = [&](std::size_t i, double share) {
      trial[i] = u_[i] + share * direction[i] + turns[piece_of(i)].bend(s_.position_[i] + u_[i], direction[i], share);
    };
    parts_.each_node([&](std::size_t i) { go(i, 1); });
    for (int halvings = 0; any(wanted); ++halvings) {
      parts_.choose(wanted);
      if (halvings == 0) parts_.sums(along, 0.0, [&](std::size_t i) { return force[i].dot(direction[i]); });
      if (halvings > 0) parts_.each_node([&](std::size_t i) { go(i, step[parts_.of(i)]); });
      evaluate(trial, tried, &next);
      for (std::size_t p = 0; p < parts; ++p) {
        if (!wanted[p]) continue;
        if (tried[p] <= value[p] + 1e-14 * std::abs(value[p])) {
          wanted[p] = 0, value[p] = tried[p], moved[p] += step[p] * longest[p];
        } else if (halvings == 16) {
          if (!(longest[p] * step[p] < accuracy_)) return false;
          active[p] = wanted[p] = 0;
        } else {
          // Where a parabola through what is known of the way has its least; contact makes it
          // steep.
          const double rise = tried[p] - value[p] + step[p] * along[p], least = 0.5 * step[p] * along[p] / rise;
          step[p] *= std::isfinite(least) ? std::clamp(least, 0.2, 0.5) : 0.5;
        }
      }
    }
    u_.swap(trial), force.swap(next);
    trial = u_;
    if (!any(active)) {
      report.energy = std::accumulate(elastic_.begin(), elastic_.end(), 0.0);
      return true;
    }
    parts_.choose(active);
    add_forces(force, elastic);
  }
  return false;
}

std::vector<Vec3> Solid::stiffness_product(const std::vector<Vec3>& u, const std::vector<Vec3>& p) const {
  const State still{u, std::vector<Vec3>(size(), Vec3::Zero()), {}};
  const Environment nothing;
  return ImplicitStep(*this, still, 1, nothing, 1).product(u, p);
}

std::vector<PointMatrices<double>> Solid::relaxed(const State& state) const {
  if (!state.plastic.empty() && state.plastic.size() != points_.size())
    throw InputError("the plastic strains are not those of this solid");
  std::vector<PointMatrices<double>> all(flows() && !state.plastic.empty() ? points_.blocks.size() : 0);
  parallel_for(all.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t b = begin; b < end; ++b) {
      all[b].resize(points_.blocks[b].points.size());
      for (std::size_t i = 0; i < points_.blocks[b].points.size(); ++i) {
        const Mat3 back = inverse_plastic_stretch(state.plastic[points_.first_point(b) + i]);
        for (int c = 0; c < 3; ++c) Eigen::Map<Vec3>(&all[b].column[c][4 * i]) = back.col(c);
      }
    }
  });
  return all;
}

void Solid::update_plasticity(State& state, double dt) const {
  if (!flows()) return;
  state.plastic.resize(points_.size(), Mat3::Zero());
  parallel_for(points_.blocks.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t b = begin; b < end; ++b) {
      const auto gradient = points_.gradients(b, state.displacement);
      for (std::size_t i = 0; i < gradient.size(); ++i) {
        Mat3& plastic = state.plastic[points_.first_point(b) + i];
        const Material& of = materials_[points_.blocks[b].points[i].material];
        if (of.yield > 0 && points_.blocks[b].points[i].quality != MomentQuality::singular)
          plastic = plastic_flow(of, plastic, Mat3::Identity() + gradient[i], dt);
      }
    }
  });
}

StepReport Solid::step_implicit(State& state, double dt, const Environment& env, double accuracy) const {
  StepReport report;
  // Time steps in a row, each divided in two where Newton does not converge, down to a thousandth.
  const auto advance = [&](const auto& self, double from, double h) -> void {
    for (Potential* p : env.contact) p->begin_substep(state.displacement, from / dt, (from + h) / dt);
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
  if (flows()) report.energy = elastic_force(state.displacement, nullptr, relaxed(state));
  return report;
}

}  // namespace geo
