// A held node follows its grip: u = c + pose · (x − c) − x with c the centre of the grip's box. Its
// velocity is the difference of two poses over the time step.
#include "simulation/grips.h"

#include <algorithm>

namespace geo {
namespace {

// One for each grip; identity for grips that do not move, which is not used.
std::vector<Pose> poses_at(const std::vector<Grip>& grips, double time) {
  std::vector<Pose> poses(grips.size());
  for (std::size_t g = 0; g < poses.size(); ++g)
    if (!grips[g].motion.keys.empty()) poses[g] = grips[g].motion.at(time);
  return poses;
}

bool holds_at(const Grip& grip, double time) {
  const bool is_released = grip.release && !grip.motion.keys.empty() && time > grip.motion.keys.back().time;
  return grip.active(time) && !is_released;
}

}  // namespace

bool GrippedNodes::change(const std::vector<Grip>& grips, double begin, double end) {
  return std::any_of(grips.begin(), grips.end(),
                     [&](const Grip& grip) { return holds_at(grip, begin) != holds_at(grip, end); });
}

GrippedNodes::GrippedNodes(const std::vector<Grip>& grips, const NodeSet& nodes) {
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const Vec3& x = nodes.position[i];
    for (std::size_t g = 0; g < grips.size(); ++g) {
      if ((x.array() < grips[g].lo.array()).any() || (x.array() > grips[g].hi.array()).any()) continue;
      inside_.push_back({NodeId(i), g});
    }
  }
}

template <class Each>
void GrippedNodes::each_held(const std::vector<Grip>& grips, double time, const Each& each) const {
  NodeId last;
  for (const auto& [i, g] : inside_) {
    if (i == last || !grips[g].active(time)) continue;
    last = i;
    if (holds_at(grips[g], time)) each(i, g);
  }
}

std::vector<HeldBox> GrippedNodes::boxes(const std::vector<Grip>& grips, double time) {
  std::vector<HeldBox> all;
  for (const Grip& grip : grips)
    if (grip.active(time))
      all.push_back({grip.lo, grip.hi, holds_at(grip, time) && (!grip.motion.keys.empty() || grip.from <= 0)});
  return all;
}

void GrippedNodes::place(const std::vector<Grip>& grips, const NodeSet& nodes, double time,
                         std::vector<std::uint8_t>& fixed, State& motion) const {
  std::fill(fixed.begin(), fixed.end(), 0);
  const std::vector<Pose> poses = poses_at(grips, time);
  each_held(grips, time, [&](NodeId i, std::size_t g) {
    const Grip& grip = grips[g];
    fixed[i.index()] = 1;
    const Vec3 &x = nodes.position[i.index()], middle = grip.middle();
    if (!grip.motion.keys.empty()) motion.displacement[i.index()] = middle + poses[g] * Vec3(x - middle) - x;
  });
}

void GrippedNodes::set_velocities(const std::vector<Grip>& grips, const NodeSet& nodes, double begin, double end,
                                  State& motion) const {
  const std::vector<Pose> from = poses_at(grips, begin), to = poses_at(grips, end);
  each_held(grips, end, [&](NodeId i, std::size_t g) {
    if (grips[g].motion.keys.empty()) return;
    const Vec3 arm = nodes.position[i.index()] - grips[g].middle();
    motion.velocity[i.index()] = (to[g] * arm - from[g] * arm) / (end - begin);
  });
}

}  // namespace geo
