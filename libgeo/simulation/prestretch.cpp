// A round lets the bodies come to equilibrium, adds its strain to the prestretch, and takes the
// bodies back to their shape.
#include "simulation/prestretch.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "geometry/distance.h"
#include "kerf/error.h"
#include "mechanics/solver/relaxation.h"
#include "mechanics/solver/solid_discretisation.h"
#include "simulation/scene_body.h"

namespace geo {
namespace {

const Prestretch& prestretch_of(const Scene& scene, std::size_t body) {
  const SceneBody& own = scene.bodies[body];
  return own.prestretch ? *own.prestretch : scene.prestretch;
}

// The stretch of the layer below the skin at material points: per point, as its matrix.
std::vector<Mat3> skin_stretches(const Prestretch& of, const TriangleMesh& skin, const std::vector<Vec3>& points) {
  std::vector<Mat3> result(points.size(), Mat3::Identity());
  const std::vector<std::uint32_t> nearest = nearest_triangles(skin, points);
  for (std::size_t k = 0; k < points.size(); ++k) {
    const Triangle& t = skin.triangles[nearest[k]];
    const Vec3 &a = skin.vertices[t[0]], &b = skin.vertices[t[1]], &c = skin.vertices[t[2]];
    const Vec3 normal = (b - a).cross(c - a).normalized();
    if ((points[k] - closest_point_on_triangle(points[k], a, b, c)).norm() > of.depth || !normal.allFinite()) continue;
    result[k] += (of.skin - 1) * (Mat3::Identity() - normal * normal.transpose());
  }
  return result;
}

// The scene as it is at time 0, at rest: nothing cuts, breaks, or moves by keys.
Scene held_still(const Scene& scene) {
  Scene still = scene;
  still.blades.clear();
  still.blows.clear();
  still.changes.clear();
  still.pulls.clear();
  still.stitches.clear();
  still.fracture.on = false;
  still.implicit = true;
  still.sleep = 0;
  std::erase_if(still.grips, [](const Grip& g) { return g.from >= 0; });
  for (Grip& g : still.grips) g = {.lo = g.lo, .hi = g.hi};
  std::erase_if(still.supports, [](const Support& s) { return s.from >= 0; });
  for (Support& s : still.supports) s = {.lo = s.lo, .hi = s.hi, .axes = s.axes};
  std::erase_if(still.loads, [](const Load& l) { return !(l.share(0) > 0); });
  for (Load& l : still.loads) l = {.lo = l.lo, .hi = l.hi, .traction = l.share(0) * l.traction};
  for (SceneObstacle& o : still.obstacles) {
    o.place = o.pose(0);
    o.motion = {};
  }
  return still;
}

// Time steps in which the slowest wave crosses the bodies four times: backward Euler takes five
// sixths of the slowest vibration of a compact body away in each.
double settling_step(const Scene& scene, const Body& body) {
  double slowest = std::sqrt(scene.material.young / scene.material.density);
  for (const SceneBody& b : scene.bodies)
    if (b.material) slowest = std::min(slowest, std::sqrt(b.material->young / b.material->density));
  return std::max(scene.dt, 4 * body.surface.extent().diagonal() / slowest);
}

// Adds the deformation of all points to their prestretch.
void add_deformation(const MaterialPoints& points, const std::vector<Vec3>& displacement,
                     std::vector<Mat3>& prestretch) {
  for (std::size_t b = 0; b < points.blocks.size(); ++b) {
    const std::vector<Mat3> gradient = points.gradients(b, displacement);
    for (std::size_t i = 0; i < gradient.size(); ++i) {
      Mat3& own = prestretch[points.first_point(b) + i];
      if (points.blocks[b].points[i].quality != MomentQuality::singular)
        own = left_stretch((Mat3::Identity() + gradient[i]) * own);
    }
  }
}

double largest_norm(const std::vector<Vec3>& vectors) {
  double largest = 0;
  for (const Vec3& v : vectors) largest = std::max(largest, v.norm());
  return largest;
}

// A node that supports a point.
std::uint32_t node_of(const PointBlock& block, std::size_t point) {
  const auto entry = block.entry_begin[point];
  return entry == block.entry_begin[point + 1] ? block.nodes.at(0) : block.nodes[block.entry_node[entry]];
}

}  // namespace

void begin_prestretch(const Scene& scene, const PlacedModels& models, const Body& body, RunState& state) {
  std::vector<Mat3>& prestretch = state.motion.prestretch;
  prestretch.clear();
  bool any = false;
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) any = any || prestretch_of(scene, b) != Prestretch{};
  if (!any) return;
  const Solid solid(body, materials_of(scene, state.body_index));
  const MaterialPoints& points = SolidDiscretisation::of(solid).points;
  prestretch.assign(points.size(), Mat3::Identity());
  std::vector<std::vector<Vec3>> positions(scene.bodies.size());
  std::vector<std::vector<std::size_t>> members(scene.bodies.size());
  for (std::size_t b = 0; b < points.blocks.size(); ++b)
    for (std::size_t i = 0; i < points.blocks[b].points.size(); ++i) {
      const auto body_of_point = state.body_index[node_of(points.blocks[b], i)];
      positions[body_of_point].push_back(points.blocks[b].points[i].position);
      members[body_of_point].push_back(points.first_point(b) + i);
    }
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
    const Prestretch& of = prestretch_of(scene, b);
    for (const auto i : members[b]) prestretch[i] = of.stretch.asDiagonal();
    if (of.skin == 1 || !(of.depth > 0)) continue;
    const std::vector<Mat3> skin = skin_stretches(of, models.bodies[b], positions[b]);
    for (std::size_t k = 0; k < skin.size(); ++k)
      prestretch[members[b][k]] = left_stretch(prestretch[members[b][k]] * skin[k]);
  }
}

void bear_load(const Scene& scene, RunStart& run, const Progress& progress) {
  constexpr int max_rounds = 60, steps = 4;
  constexpr int patience = 6;             // rounds without one that changes the shape less than all before
  constexpr double largest_change = 0.1;  // of the shape, node spacings
  Scene still = held_still(scene);
  still.dt = settling_step(scene, run.body);
  still.frame_rate = 1 / still.dt;
  const std::size_t nodes = run.body.nodes.size();
  RunState state = run.state;
  state.fronts.clear();
  state.glued = {};
  state.motion.displacement.assign(nodes, Vec3::Zero());
  state.motion.velocity.assign(nodes, Vec3::Zero());
  Simulation settling(still, run.body, state);
  double least = std::numeric_limits<double>::infinity();
  for (int round = 0, best = 0; round < std::min(max_rounds, best + patience); ++round) {
    report(progress, "settling", static_cast<std::size_t>(round), static_cast<std::size_t>(max_rounds));
    for (int s = 0; s < steps; ++s) settling.advance_frame();
    const State& end = settling.state().motion;
    const double change = largest_norm(end.displacement) / run.body.finest_spacing;
    if (change < largest_change) {
      run.state.motion.prestretch = state.motion.prestretch;
      run.state.motion.displacement = end.displacement;
      run.state.surface = settling.state().surface;
      return;
    }
    if (change < least) {
      least = change;
      best = round + 1;
    }
    const MaterialPoints& points = SolidDiscretisation::of(settling.solid()).points;
    state.motion.prestretch.resize(points.size(), Mat3::Identity());
    add_deformation(points, end.displacement, state.motion.prestretch);
    settling.restore(run.body, state);
  }
  throw GeometryError(
      "the bodies do not come to rest under their load in this shape; hold them by 'body.fixed' or a ground, make "
      "them stiffer, or leave out 'prestretch.loaded'");
}

}  // namespace geo
