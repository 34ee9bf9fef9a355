// Checkpoints hold the positions of living surface vertices alone; SelfContact holds one per index,
// dead ones included. Implicit steps add a potential, explicit steps get impulses afterwards.
#include "simulation/collisions.h"

#include <stdexcept>

#include "kerf/error.h"
#include "simulation/timed.h"

namespace geo {

Collisions::Collisions(const Scene& scene, const Body& body, const Solid& solid, const std::vector<Vec3>& positions)
    : implicit_(scene.implicit) {
  if (!scene.self_contact) return;
  std::vector<Vec3> all;
  if (!positions.empty()) {
    all.assign(body.surface.surface_vertex_count(), Vec3::Zero());
    std::size_t next = 0;
    for (std::uint32_t v = 0; v < all.size(); ++v)
      if (body.surface.alive(SurfaceVertexId(v)) && next++ < positions.size()) all[v] = positions[next - 1];
    if (next != positions.size()) throw InputError("the checkpoint's surface does not belong to its body");
  }
  surface_.emplace(body, solid, scene.contact, std::move(all));
}

std::optional<ContactStep> Collisions::begin_step(const Body& body, const Solid& solid, const State& motion, double dt,
                                                  const ContactPace& pace, Environment& environment) {
  if (!surface_ || !implicit_) return {};
  ContactStep step = surface_->begin_step(body, solid, motion, dt, environment, pace);
  if (Potential* potential = step.potential()) environment.contact.push_back(potential);
  return step;
}

ContactStats Collisions::finish_step(std::optional<ContactStep> step, const Body& body, const Solid& solid,
                                     const std::vector<Vec3>& before, double dt, const Environment& environment,
                                     State& motion) {
  if (!surface_) return {};
  return step ? surface_->finish_step(std::move(*step), solid, motion.displacement)
              : surface_->finish_step_with_impulses(body, solid, before, dt, environment.fixed, motion);
}

StepVeto Collisions::embedding_check(const Body& body, const Solid& solid, const State& motion,
                                     std::optional<EmbeddingPlan>& plan, double& seconds) {
  if (!surface_) return {};
  return [&](const Complex& grown, const CrackDelta& crack) {
    const Timed timed(seconds);
    plan = surface_->plan_embedding(body, solid, motion, grown, crack);
  };
}

void Collisions::update_weights(const Body& body, const Solid& solid, const State& motion) {
  if (surface_) return surface_->update_weights(body, solid, motion.displacement);
  if (weights_.size() == 0) weights_.rebuild(body, solid);
  if (weights_.has_changes()) targets_.invalidate(weights_.update(body, solid));
  if (weights_.set_rotations(solid, motion.displacement)) targets_ = {};
}

void Collisions::commit(std::optional<EmbeddingPlan> plan, const Body& body, const BodyDelta& delta) {
  if (delta.crack.empty()) return;
  if (!surface_) {
    if (weights_.size() > 0) weights_.mark_changed(body, delta);
    return;
  }
  if (!plan) throw std::logic_error("no embedding was planned for this crack step");
  surface_->commit(std::move(*plan), body, delta);
}

std::vector<Vec3> Collisions::living_positions(const Body& body) const {
  std::vector<Vec3> result;
  if (!surface_) return result;
  for (std::uint32_t v = 0; v < surface_->positions().size(); ++v)
    if (body.surface.alive(SurfaceVertexId(v))) result.push_back(surface_->positions()[v]);
  return result;
}

}  // namespace geo
