#include "simulation/collide.h"

#include <algorithm>

#include "base/error.h"

namespace geo {

Collisions::Collisions(const Scene& scene, const Body& body, const Solid& solid, const std::vector<Vec3>& rows) {
  if (!scene.self_contact) return;
  std::vector<Vec3> positions;
  if (!rows.empty()) {
    positions.assign(body.surface.surface_vertex_count(), Vec3::Zero());
    std::size_t next = 0;
    for (std::uint32_t v = 0; v < positions.size(); ++v)
      if (body.surface.alive(SurfaceVertexId(v)) && next++ < rows.size()) positions[v] = rows[next - 1];
    if (next != rows.size()) throw InputError("the checkpoint's surface does not belong to its body");
  }
  surface_.emplace(body, solid, scene.contact, std::move(positions));
  if (scene.ground && scene.implicit) ground_options_ = GroundOptions{scene.ground_point, scene.ground_normal, scene.ground_stiffness, scene.friction};
}

void Collisions::begin(const Body& body, const Solid& solid, const State& motion, double dt, Environment& environment) {
  if (!ground_options_) return;
  // As stiff as the same penalty on each node of the lowest layer: acceleration times mass over area; by the nodes there are now,
  // so that a run taken up does the same.
  double layer = 0;
  for (std::size_t i = 0; i < solid.size(); ++i) layer += solid.mass(NodeId(i)) / (body.nodes.spacing[i] * body.nodes.spacing[i]);
  GroundOptions options = *ground_options_;
  options.pressure *= layer / double(solid.size());
  ground_.emplace(options);
  double fastest = 0;
  for (const Vec3& v : motion.velocity) fastest = std::max(fastest, v.norm());
  const double fall = dt * environment.gravity.norm();
  ground_->begin(body, surface_->weights(), motion.displacement, 2 * dt * (fastest + fall) + surface_->surface().edge, 1e-2 * dt * fall + 1e-9 * surface_->surface().edge);
  environment.ground = false;
  environment.contact.push_back(&*ground_);
}

Agreement Collisions::agreement(const Body& body, const Solid& solid, const State& motion) {
  if (!surface_) return {};
  return [&](const Complex& grown, const CrackDelta& crack) { surface_->expect(body, solid, motion, grown, crack); };
}

void Collisions::follow(const Body& body, const Solid& solid) {
  if (surface_) surface_->follow(body, solid);
}

void Collisions::resolve(const Body& body, const Solid& solid, const std::vector<Vec3>& before, double dt, const Environment& environment, State& motion,
                         ContactWork& work) {
  if (surface_) surface_->resolve(body, solid, before, dt, environment.fixed, motion, &work);
}

std::vector<Vec3> Collisions::rows(const Body& body) const {
  std::vector<Vec3> result;
  if (!surface_) return result;
  for (std::uint32_t v = 0; v < surface_->positions().size(); ++v)
    if (body.surface.alive(SurfaceVertexId(v))) result.push_back(surface_->positions()[v]);
  return result;
}

}  // namespace geo
