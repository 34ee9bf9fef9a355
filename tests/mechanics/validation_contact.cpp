// Obstacles against what is known of contact.
#include <cmath>
#include <numbers>

#include "contact/response/obstacle_penalty.h"
#include "contact/surface/surface_targets.h"
#include "mechanics/bodies.h"
#include "mechanics/disk.h"
#include "mechanics/validation.h"

namespace validation {
namespace {

using namespace geo;

Eigen::Isometry3d pose(const Vec3& place, const Vec3& normal) {
  Eigen::Isometry3d at = Eigen::Isometry3d::Identity();
  at.linear() = Eigen::Quaterniond::FromTwoVectors(Vec3::UnitZ(), normal).toRotationMatrix();
  at.translation() = place;
  return at;
}

// A body between two plates that face each other along z, each pressed in as far, without friction;
// the force between them.
class Press {
 public:
  Press(const TriangleMesh& mesh, const SampleOptions& sampling, const Material& material, double pressure)
      : body(build_body(Complex::from_skin(mesh), sample_nodes(mesh, sampling))),
        solid(body, material),
        pressure_(pressure),
        box_(bounding_box(mesh)) {
    weights_.rebuild(body, solid);
    const std::vector<Vec3> zero(body.nodes.size(), Vec3::Zero());
    state = {zero, zero};
    // The node nearest to the middle stays: nothing else keeps the body from drifting aside.
    std::size_t middle = 0;
    for (std::size_t i = 0; i < zero.size(); ++i)
      if ((body.nodes.position[i] - box_.center()).norm() < (body.nodes.position[middle] - box_.center()).norm())
        middle = i;
    environment_.fixed.assign(zero.size(), 0);
    environment_.fixed[middle] = 1;
    environment_.gravity.setZero();
  }
  double close(double depth) {
    const auto shape = std::make_shared<RigidShape>(RigidShape::half_space(Vec3::UnitZ()));
    const Vec3 middle = box_.center();
    const Eigen::Isometry3d low = pose({middle.x(), middle.y(), box_.lo.z() + depth}, Vec3::UnitZ()),
                            high = pose({middle.x(), middle.y(), box_.hi.z() - depth}, -Vec3::UnitZ());
    ObstaclePenalty below(shape, {pressure_, 0}, low, low), above(shape, {pressure_, 0}, high, high);
    environment_.contact = {&below, &above};
    // Nothing but inertia holds it from turning: steps no longer than that bounds this well, each
    // from rest.
    for (int k = 0; k < 3; ++k) {
      for (Vec3& v : state.velocity) v.setZero();
      state.acceleration.clear();
      for (ObstaclePenalty* o : {&below, &above})
        o->find_contacts(weights_, surface_targets(weights_, state.displacement), 0.2 * box_.diagonal(), 1);
      solid.step_implicit(state, 1, environment_, 1e-5);
    }
    return 0.5 * (above.reaction(state.displacement).force.z() - below.reaction(state.displacement).force.z());
  }

  Body body;
  Solid solid;
  State state;

 private:
  double pressure_;
  Box3 box_;
  SurfaceWeights weights_;
  Environment environment_;
};

Material soft() {
  Material m;
  m.young = 1e5;
  m.poisson = 0.3;
  m.density = 1000;
  m.damping = 0;
  return m;
}

}  // namespace

std::vector<Finding> hertz(int size) {
  const Material m = soft();
  const double stiff = m.young / (1 - m.poisson * m.poisson);
  std::vector<Finding> found;
  for (const double spacing : size ? std::vector{0.1, 0.07, 0.05} : std::vector{0.14, 0.1}) {
    SampleOptions sampling;
    sampling.spacing = spacing;
    sampling.levels = 3;
    Press press(make_sphere(int(std::lround(1.1 / spacing))), sampling, m, 300 * m.young);
    const double depth = 0.06;
    found.push_back(
        {"Sphere between two plates, nodes " + std::to_string(spacing).substr(0, 4) + " radii apart: force, N",
         "F = 4/3 E / (1 − ν²) √R δ^1.5 (Hertz)", press.close(depth), 4.0 / 3 * stiff * std::pow(depth, 1.5),
         spacing > 0.12 ? 0.2 : 0.06});
  }
  return found;
}

// A disk between two plates: it is pulled apart across the loaded diameter.
std::vector<Finding> brazilian_disk(int) {
  const Material m = soft();
  const double thickness = 0.2, spacing = 0.05;
  SampleOptions sampling;
  sampling.spacing = spacing;
  sampling.levels = 1;
  Press press(make_disk(thickness, spacing), sampling, m, 1000 * m.young);
  const double force = press.close(0.01);
  const Mat3 stress = press.solid.stress_at(press.state, {0.5, 0.5 * thickness, 0.5}, 0.1);
  const double pulled = 2 * force / (std::numbers::pi * thickness);
  return {{"Disk pressed between two plates: stress across in its middle, Pa", "σ = 2 P / (π D t)", stress(0, 0),
           pulled, 0.05},
          {"Disk pressed between two plates: stress along in its middle, Pa", "σ = −6 P / (π D t)", stress(2, 2),
           -3 * pulled, 0.05}};
}

}  // namespace validation
