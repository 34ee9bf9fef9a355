// Rotations are those nearest to Σ w (x_j − x_i) (X_j − X_i)ᵀ, X at rest and x now, plus a small
// multiple of last rotations. That multiple decides about directions without nodes.
#include "mechanics/solver/debris.h"

#include <algorithm>

#include "geometry/nearest_rotation.h"
#include "geometry/principal_inertia.h"

namespace geo {
namespace {

// Share of the last rotation in a fit, of the trace of Σ w (X_j − X_i) (X_j − X_i)ᵀ. It decides
// about directions in which nodes extend less than a sixth of their extent.
constexpr double memory = 0.03;

// The rotation nearest to `fit`, whose trace at rest is `size`.
Mat3 rotation_of(const Mat3& fit, double size, const Mat3& last) {
  return size > 0 ? nearest_rotation(fit / size + memory * last).rotation : last;
}

// Per component: whether a material point has strain in it.
std::vector<char> strained_components(const SolidDiscretisation& solid) {
  std::vector<char> strained(solid.components, 0);
  for (const PointBlock& block : solid.points.blocks)
    for (std::size_t p = 0; p < block.points.size(); ++p)
      if (block.points[p].quality != MomentQuality::singular)
        strained[solid.component[block.nodes[block.entry_node[block.entry_begin[p]]]]] = 1;
  return strained;
}

// Nodes of a rigid body, and those that decide its motion.
struct RigidBody {
  std::vector<std::uint32_t> nodes;
  std::vector<std::uint32_t> deciding;
};

// Single nodes are rigid as they are.
std::vector<RigidBody> rigid_bodies(const SolidDiscretisation& solid, const std::vector<std::uint8_t>& fixed) {
  const std::vector<char> strained = strained_components(solid);
  std::vector<RigidBody> bodies;
  std::vector<std::uint32_t> body_of(solid.components, ~0u);
  for (std::uint32_t i = 0; i < solid.size(); ++i) {
    const auto c = solid.component[i];
    if (strained[c]) continue;
    if (body_of[c] == ~0u) {
      body_of[c] = static_cast<std::uint32_t>(bodies.size());
      bodies.emplace_back();
    }
    bodies[body_of[c]].nodes.push_back(i);
  }
  std::erase_if(bodies, [](const RigidBody& body) { return body.nodes.size() == 1; });
  for (RigidBody& body : bodies) {
    if (!fixed.empty())
      std::copy_if(body.nodes.begin(), body.nodes.end(), std::back_inserter(body.deciding),
                   [&](auto i) { return fixed[i] != 0; });
    if (body.deciding.empty()) body.deciding = body.nodes;
  }
  return bodies;
}

// Moves a rigid body by the fit to its deciding nodes, and gives it their momenta.
void make_rigid(const SolidDiscretisation& solid, const RigidBody& body, State& state) {
  constexpr double rounding = 1e-9;  // of the largest moment of inertia
  const auto at = [&](std::uint32_t i) { return Vec3(solid.position[i] + state.displacement[i]); };
  double mass = 0;
  Vec3 rest = Vec3::Zero(), now = rest, momentum = rest;
  for (const auto i : body.deciding) {
    const double m = solid.mass[i];
    mass += m;
    rest += m * solid.position[i];
    now += m * at(i);
    momentum += m * state.velocity[i];
  }
  rest /= mass;
  now /= mass;
  Mat3 fit = Mat3::Zero();
  double size = 0;
  for (const auto i : body.deciding) {
    const Vec3 from = solid.position[i] - rest;
    fit += solid.mass[i] * (at(i) - now) * from.transpose();
    size += solid.mass[i] * from.squaredNorm();
  }
  const bool turns = body.deciding.size() > 1;  // else the rest is rounding
  const Mat3 rotation = rotation_of(fit, turns ? size : 0, state.rotation[body.nodes[0]]);
  Vec3 angular = Vec3::Zero();
  Mat3 inertia = Mat3::Zero();
  for (const auto i : body.deciding) {
    const Vec3 arm = rotation * (solid.position[i] - rest);
    angular += solid.mass[i] * arm.cross(state.velocity[i]);
    inertia += solid.mass[i] * (arm.squaredNorm() * Mat3::Identity() - arm * arm.transpose());
  }
  const PrincipalInertia principal(inertia);
  const Vec3 spin = turns ? Vec3(principal.axes * principal.angular_velocity(angular, rounding * principal.moments[2]))
                          : Vec3(Vec3::Zero());
  for (const auto i : body.nodes) {
    state.rotation[i] = rotation;
    const Vec3 arm = rotation * (solid.position[i] - rest);
    state.displacement[i] = now + arm - solid.position[i];
    state.velocity[i] = momentum / mass + spin.cross(arm);
  }
}

// The rotation about a node by its neighbours; where they do not determine it, the mean of the last
// rotations of it and them. So the rotation of a flap's base reaches its tip, from node to node.
Mat3 rotation_about(const SolidDiscretisation& solid, std::uint32_t i, const std::vector<Vec3>& u,
                    const std::vector<Mat3>& last) {
  const auto& node = solid.mls[i];
  Mat3 fit = Mat3::Zero(), mean = last[i];
  double size = 0;
  for (std::size_t q = 0; q < node.neighbors.size(); ++q) {
    const auto j = node.neighbors[q];
    const Vec3& rest = node.offset[q];
    const double w = node.normalised_weight[q];
    fit += w * (rest + u[j] - u[i]) * rest.transpose();
    size += w * rest.squaredNorm();
    mean += last[j];
  }
  return rotation_of(fit, size, mean / double(node.neighbors.size() + 1));
}

// State::rotation, with those of complete neighbours of incomplete nodes, which their gradients
// give.
std::vector<Mat3> last_rotations(const SolidDiscretisation& solid, std::span<const std::uint32_t> incomplete,
                                 const State& state) {
  std::vector<std::uint32_t> complete;
  for (const auto i : incomplete)
    for (const auto j : solid.mls[i].neighbors)
      if (solid.mls.quality(j) == MomentQuality::good) complete.push_back(j);
  std::sort(complete.begin(), complete.end());
  complete.erase(std::unique(complete.begin(), complete.end()), complete.end());
  std::vector<Mat3> last = state.rotation;
  const std::vector<Mat3> rotations = rotations_at(solid.mls, complete, state.displacement);
  for (std::size_t k = 0; k < complete.size(); ++k) last[complete[k]] = rotations[k];
  return last;
}

}  // namespace

void keep_debris_rigid(const SolidDiscretisation& solid, const std::vector<std::uint8_t>& fixed, State& state) {
  std::vector<std::uint32_t> incomplete;  // nodes without a full gradient
  for (std::uint32_t i = 0; i < solid.size(); ++i)
    if (solid.mls.quality(i) != MomentQuality::good) incomplete.push_back(i);
  if (incomplete.empty()) return;
  state.rotation.resize(solid.size(), Mat3::Identity());
  for (const RigidBody& body : rigid_bodies(solid, fixed)) make_rigid(solid, body, state);
  const std::vector<Mat3> last = last_rotations(solid, incomplete, state);
  for (const auto i : incomplete) state.rotation[i] = rotation_about(solid, i, state.displacement, last);
}

std::vector<Mat3> rotations_at(const NodalGradientOperator& mls, std::span<const std::uint32_t> nodes,
                               const std::vector<Vec3>& u) {
  std::vector<Mat3> rotations;
  for (const auto i : nodes)
    rotations.push_back(nearest_rotation(Mat3::Identity() + mls.displacement_gradient(i, u)).rotation);
  return rotations;
}

}  // namespace geo
