#include "simulation/collisions.h"

#include "kerf/error.h"
#include "kerf/progress.h"

namespace geo {

Collisions::Collisions(const Scene& scene, const Body& body, const Solid& solid, const std::vector<Vec3>& rows)
    : implicit_(scene.implicit) {
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
}

void Collisions::begin(const Body& body, const Solid& solid, const State& motion, double dt, Environment& environment) {
  if (!surface_ || !implicit_) return;
  if (Potential* touch = surface_->begin(body, solid, motion, dt, environment.gravity, environment.fixed))
    environment.contact.push_back(touch);
}

Agreement Collisions::agreement(const Body& body, const Solid& solid, const State& motion, double& seconds) {
  if (!surface_) return {};
  return [&](const Complex& grown, const CrackDelta& crack) {
    Stopwatch watch;
    try {
      surface_->expect(body, solid, motion, grown, crack);
    } catch (...) {
      seconds += watch.lap();
      throw;
    }
    seconds += watch.lap();
  };
}

void Collisions::follow(const Body& body, const Solid& solid, const BodyDelta& delta) {
  if (surface_) surface_->follow(body, solid, delta);
}

void Collisions::resolve(const Body& body, const Solid& solid, const std::vector<Vec3>& before, double dt,
                         const Environment& environment, State& motion, ContactStats& work) {
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
