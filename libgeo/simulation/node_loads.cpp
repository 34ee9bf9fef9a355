// Grips come first: nodes that they hold are where they will be at the step's end. Potentials
// follow in a fixed order: wedges, pulls, stitches.
#include "simulation/node_loads.h"

namespace geo {

NodeLoads::NodeLoads(const Scene& scene, const Body& body) : scene_(scene), body_(body) { follow_scene(); }

void NodeLoads::follow_scene() {
  is_behind_ = false;
  environment_.gravity = scene_.gravity;
  environment_.fixed.assign(body_.nodes.size(), 0);
  gripped_ = GrippedNodes(scene_.grips, body_.nodes);
}

void NodeLoads::follow_crack() {
  is_behind_ = true;
  pulls_.invalidate();
  stitches_.invalidate();
}

void NodeLoads::begin_step(const TimeStep& step, const Solid& solid, State& motion) {
  if (is_behind_) follow_scene();
  gripped_.place(scene_.grips, body_.nodes, step.end, environment_.fixed, motion);
  environment_.contact.clear();
  add_wedges(step, solid, motion);
  pulls_.begin_step(scene_.pulls, body_, solid, step.begin, step.end);
  stitches_.begin_step(scene_.stitches, body_, solid, step.begin, step.end);
  if (!wedges_.empty()) environment_.contact.push_back(&wedges_);
  if (!pulls_.empty()) environment_.contact.push_back(&pulls_);
  if (!stitches_.empty()) environment_.contact.push_back(&stitches_);
}

// The wedges of thick blades are where their cut is: the edge cuts on at the end of the step.
void NodeLoads::add_wedges(const TimeStep& step, const Solid& solid, const State& motion) {
  wedges_ = {};
  const BladeNodes nodes{.position = body_.nodes.position,
                         .displacement = motion.displacement,
                         .radius = body_.nodes.radius,
                         .surface = [&](std::size_t i) { return surface_distance(body_, NodeId(i)); },
                         .mass = [&](std::size_t i) { return solid.mass(NodeId(i)); }};
  for (std::size_t b = 0; b < scene_.blades.size(); ++b) {
    const Blade& blade = scene_.blades[b];
    if (!(blade.thickness > 0) || !blade.active(step.begin)) continue;
    const Pose begin = blade.motion.at(step.begin), end = blade.motion.at(step.end);
    const BladeWedge wedge{.edge = blade.at(step.begin),
                           .closed = blade.closed,
                           .back = begin.rotation * blade.back,
                           .thickness = blade.thickness,
                           .stiffness = blade.stiffness,
                           .friction = blade.friction,
                           .way = [=](const Vec3& x) {
                             const Vec3 local = begin.rotation.conjugate() * (x - begin.position);
                             return Vec3(end * local - x);
                           }};
    wedges_.add(b, wedge, nodes);
  }
}

void NodeLoads::end_step(const TimeStep& step, double share, State& motion, FrameStats& stats) {
  gripped_.set_velocities(scene_.grips, body_.nodes, step.begin, step.end, motion);
  stats.blade_force.resize(scene_.blades.size(), Vec3::Zero());
  const auto on_blades = wedges_.reaction(motion.displacement, scene_.blades.size());
  for (std::size_t b = 0; b < on_blades.size(); ++b) stats.blade_force[b] += share * on_blades[b];
  stats.pull_force.resize(scene_.pulls.size(), Vec3::Zero());
  stats.stitch_force.resize(scene_.stitches.size(), 0);
  stats.work += pulls_.work(motion.displacement) + wedges_.work(motion.displacement);
  stats.work += stitches_.work(motion.displacement);
  const auto on_pulls = pulls_.reaction(motion.displacement, scene_.pulls.size());
  for (std::size_t p = 0; p < on_pulls.size(); ++p) stats.pull_force[p] += share * on_pulls[p];
  const auto tension = stitches_.tension(motion.displacement, scene_.stitches.size());
  for (std::size_t t = 0; t < tension.size(); ++t) stats.stitch_force[t] += share * tension[t];
}

}  // namespace geo
