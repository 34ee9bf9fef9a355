// Angular momentum of what turns freely.
#include <cmath>
#include <cstdio>

#include "kerf/solid.h"
#include "mechanics/bodies.h"
#include "mechanics/validation.h"

namespace validation {
namespace {

using namespace geo;

constexpr double dt = 0.04, rate = 2;
constexpr int steps = 40;

// For a rigid body, backward Euler makes the turn that is nearest to where every node would go
// straight on. After one by φ that is where it was once more, and on by as much: by tan φ' = sin φ
// / (2 − cos φ). Velocities are from where nodes were, so the momentum is that of sin φ.
double kept() {
  double turn = std::atan(rate * dt);
  for (int k = 1; k < steps; ++k) turn = std::atan2(std::sin(turn), 2 - std::cos(turn));
  return std::sin(turn) / (rate * dt);
}

// The share of its angular momentum about its middle that a bar has left.
double left(const Body& body, double young, double poisson, double accuracy) {
  const std::size_t n = body.nodes.size();
  Material material;
  material.young = young;
  material.poisson = poisson;
  material.density = 1000;
  material.damping = 0;
  Solid solid(body, material);
  State state{std::vector<Vec3>(n, Vec3::Zero()), std::vector<Vec3>(n)};
  for (std::size_t i = 0; i < n; ++i) state.velocity[i] = Vec3(0, 0, rate).cross(body.nodes.position[i]);
  Environment env;
  env.gravity.setZero();
  const auto momentum = [&] {
    Vec3 middle = Vec3::Zero();
    double mass = 0;
    for (std::uint32_t i = 0; i < n; ++i) {
      middle += solid.mass(NodeId(i)) * (body.nodes.position[i] + state.displacement[i]);
      mass += solid.mass(NodeId(i));
    }
    return (solid.angular_momentum(state) - (middle / mass).cross(solid.momentum(state))).z();
  };
  const double before = momentum();
  for (int k = 0; k < steps; ++k) solid.step_implicit(state, dt, env, accuracy);
  return momentum() / before;
}

}  // namespace

std::vector<Finding> spin(int size) {
  const Body body = block_body({2, 0.4, 0.4}, 0.1);
  std::vector<Finding> found;
  for (const double young : {1e7, 1e9, 2e11})
    for (const double poisson : {0.3, 0.485})
      for (const double accuracy : {1e-3, 4e-3, 0.02}) {
        if (size > 0 && (poisson != 0.3 || accuracy == 4e-3)) continue;
        char what[120];
        std::snprintf(what, sizeof what,
                      "Bar that spins, E = %.0e Pa, ν = %.3g, accuracy %.3g: angular momentum left after 40 steps",
                      young, poisson, accuracy);
        found.push_back({what, "sin φₙ / (ω Δt), tan φₙ₊₁ = sin φₙ / (2 − cos φₙ)",
                         left(body, young, poisson, accuracy), kept(), 0.01});
      }
  return found;
}

}  // namespace validation
