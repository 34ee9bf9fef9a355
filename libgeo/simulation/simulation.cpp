#include "simulation/simulation.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "base/error.h"
#include "base/parallel.h"
#include "mechanics/deformation.h"

namespace geo {
namespace {

double since(std::chrono::steady_clock::time_point& last) {
  const auto now = std::chrono::steady_clock::now();
  const double seconds = std::chrono::duration<double>(now - last).count();
  last = now;
  return seconds;
}

Body make_body(const Scene& scene, const TriangleMesh& solid, const Progress& progress) {
  SampleOptions sampling = scene.sampling;
  sampling.seed = scene.seed;
  if (sampling.spacing <= 0 && sampling.count == 0) sampling.spacing = scene.spacing_percent / 100 * bounding_box(solid).diagonal();
  return build_body(Complex::from_skin(solid), sample_nodes(solid, sampling, progress), {scene.k, NeighborMethod::automatic}, progress);
}

}  // namespace

std::vector<Vec3> Blade::at(double time) const {
  std::size_t i = 0;
  while (i + 2 < keys.size() && keys[i + 1].time <= time) ++i;
  const Key &a = keys[i], &b = keys[i + 1];
  const double t = std::clamp((time - a.time) / (b.time - a.time), 0.0, 1.0);
  const auto rotation = [](const Key& k) { return Eigen::Quaterniond(Eigen::AngleAxisd(k.angle * 3.14159265358979323846 / 180, k.axis.normalized())); };
  const Eigen::Quaterniond q = rotation(a).slerp(t, rotation(b));
  const Vec3 position = a.position + t * (b.position - a.position);
  std::vector<Vec3> world;
  for (const Vec3& p : points) world.push_back(position + q * p);
  return world;
}

FrameWork& FrameWork::operator+=(const FrameWork& o) {
  split.crack += o.split.crack;
  split.edges_cut += o.split.edges_cut, split.edges_added += o.split.edges_added, split.nodes_updated += o.split.nodes_updated;
  split.nodes_added += o.split.nodes_added, split.nodes_moved += o.split.nodes_moved, split.orphans += o.split.orphans;
  split.resample_seconds += o.split.resample_seconds, split.graph_seconds += o.split.graph_seconds, split.binding_seconds += o.split.binding_seconds;
  refused += o.refused, newton += o.newton, cg += o.cg, steps += o.steps;
  front_seconds += o.front_seconds, mechanics_seconds += o.mechanics_seconds, surface_seconds += o.surface_seconds, fracture_seconds += o.fracture_seconds;
  fracture.begun += o.fracture.begun, fracture.divided += o.fracture.divided, fracture.advanced += o.fracture.advanced, fracture.refused += o.fracture.refused;
  return *this;
}

Simulation::Simulation(const Scene& scene, const TriangleMesh& solid, const Progress& progress)
    : scene_(scene), body_(make_body(scene, solid, progress)), solid_(body_.nodes, body_.graph, scene.material) {
  state_.motion.displacement.assign(body_.nodes.size(), Vec3::Zero());
  state_.motion.velocity.assign(body_.nodes.size(), scene.velocity);
  state_.fronts.resize(scene.blades.size());
  prepare();
}

Simulation::Simulation(const Scene& scene, Body body, RunState state)
    : scene_(scene), body_(std::move(body)), state_(std::move(state)), solid_(body_.nodes, body_.graph, scene.material) {
  if (state_.motion.displacement.size() != body_.nodes.size() || state_.motion.velocity.size() != body_.nodes.size() || state_.fronts.size() != scene.blades.size())
    throw InputError("the checkpoint does not belong to this scene");
  prepare();
}

void Simulation::prepare() {
  environment_.gravity = scene_.gravity;
  environment_.ground = scene_.ground;
  environment_.ground_point = scene_.ground_point;
  environment_.ground_normal = scene_.ground_normal.normalized();
  environment_.ground_stiffness = scene_.ground_stiffness;
  environment_.friction = scene_.friction;
  environment_.fixed.assign(body_.nodes.size(), 0);
  environment_.clearance.assign(body_.nodes.size(), 0);
  for (std::size_t i = 0; i < body_.nodes.size(); ++i) {
    const Vec3& x = body_.nodes.position[i];
    for (const auto& [lo, hi] : scene_.fixed) environment_.fixed[i] |= (x.array() >= lo.array()).all() && (x.array() <= hi.array()).all();
    if (const auto v = body_.binding.closest[i]; v.valid() && body_.surface.alive(v)) environment_.clearance[i] = (body_.surface.point(body_.surface.site(v)) - x).norm();
  }
}

void Simulation::cut(FrameWork& work) {
  for (std::size_t b = 0; b < scene_.blades.size(); ++b) {
    const Blade& blade = scene_.blades[b];
    if (!blade.active(state_.time)) continue;
    auto clock = std::chrono::steady_clock::now();
    const auto gradient = solid_.gradients(state_.motion.displacement);
    const InverseMap inverse(body_.nodes, state_.motion.displacement, gradient);
    std::vector<Vec3> next;
    for (const Vec3& p : blade.at(state_.time)) next.push_back(inverse.material(p));
    work.front_seconds += since(clock);
    auto& front = state_.fronts[b];
    if (!front) {
      front = begin_front(next, blade.closed, body_.surface.crack_count() + 1 + static_cast<std::int32_t>(b));
      front->name = blade.name;
      continue;
    }
    split_step(*front, next, work);
  }
}

bool Simulation::split_step(FrontState& front, const std::vector<Vec3>& next, FrameWork& work) {
  CrackOptions options;
  options.seed = scene_.seed;
  try {
    const BodyDelta delta = split(body_, front, next, options, &work.split);
    if (delta.crack.empty()) return true;
    solid_.update(body_.nodes, body_.graph, delta.first_new_node, delta.donors, delta.updated_nodes, state_.motion);
    prepare();
    return true;
  } catch (const GeometryError&) {
    ++work.refused;
    return false;
  }
}

void Simulation::fracture(FrameWork& work, double dt) {
  if (!scene_.fracture.on || state_.time < scene_.fracture.start) return;
  auto clock = std::chrono::steady_clock::now();
  double splitting = 0;
  step_fracture(scene_.fracture, body_, solid_, state_.motion, dt, state_.fracture, [&](FrontState& front, const std::vector<Vec3>& next) {
    auto inner = std::chrono::steady_clock::now();
    const bool made = split_step(front, next, work);
    splitting += since(inner);
    return made;
  }, &work.fracture);
  work.fracture_seconds += since(clock) - splitting;
}

FrameWork Simulation::advance_frame() {
  FrameWork work;
  const double frame_time = 1 / scene_.frame_rate;
  const int steps = std::max(1, static_cast<int>(std::ceil(frame_time / scene_.dt - 1e-9)));
  const double dt = frame_time / steps;
  for (int s = 0; s < steps; ++s) {
    cut(work);
    auto clock = std::chrono::steady_clock::now();
    const StepReport report = scene_.implicit ? solid_.step_implicit(state_.motion, dt, environment_) : solid_.step_explicit(state_.motion, dt, environment_);
    work.newton += static_cast<std::size_t>(report.newton), work.cg += static_cast<std::size_t>(report.cg), ++work.steps;
    work.mechanics_seconds += since(clock);
    state_.time = (state_.frame + (s + 1.0) / steps) * frame_time;
    fracture(work, dt);
    for (std::size_t i = 0; i < state_.motion.displacement.size(); ++i)
      if (!state_.motion.displacement[i].allFinite())
        throw GeometryError("node " + std::to_string(i) + " has left all bounds at time " + std::to_string(state_.time) + "; reduce the time step");
  }
  ++state_.frame;
  return work;
}

TriangleMesh Simulation::surface(const TriangleMesh* model) const {
  std::vector<std::uint32_t> rows;
  TriangleMesh mesh = body_.surface.two_sided(&rows);
  if (model) carry(*model, mesh);
  mesh.attributes.normal.clear();
  const auto gradient = solid_.gradients(state_.motion.displacement);
  parallel_for(rows.size(), 256, [&](std::size_t begin, std::size_t end) {
    std::vector<std::pair<NodeId, double>> nodes;
    for (std::size_t v = begin; v < end; ++v) {
      if (rows[v] == ~0u) continue;
      bound_nodes(body_, SurfaceVertexId(v), nodes);
      Vec3& x = mesh.vertices[rows[v]];
      if (!nodes.empty()) x += displacement_at(x, nodes, body_.nodes, state_.motion.displacement, gradient);
    }
  });
  return mesh;
}

}  // namespace geo
