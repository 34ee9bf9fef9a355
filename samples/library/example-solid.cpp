// Time steps of an elastic block that hangs from its top, cut between two steps; stress and
// positions.
#include <algorithm>
#include <cstdio>
#include <vector>

#include <kerf/body.h>
#include <kerf/mesh.h>
#include <kerf/solid.h>

int main() {
  const geo::TriangleMesh block = geo::make_block({1, 1, 1}, 0.25);
  geo::Body body = geo::build_body(geo::Complex::from_skin(block), geo::sample_nodes(block, {.spacing = 0.2}));

  geo::Material material;
  material.young = 1e5;
  geo::Solid solid(body, material);
  const std::size_t n = body.nodes.size();
  geo::State state{std::vector<geo::Vec3>(n, geo::Vec3::Zero()), std::vector<geo::Vec3>(n, geo::Vec3::Zero())};
  geo::Environment environment;
  for (const geo::Vec3& x : body.nodes.position) environment.fixed.push_back(x.z() > 0.85);
  for (int step = 0; step < 4; ++step) solid.step_implicit(state, 1.0 / 24, environment);

  // A vertical cut from the bottom to half of the height. The solid follows the body.
  geo::FrontState front = geo::begin_front(std::vector<geo::Vec3>{{0.51, -0.1, -0.1}, {0.49, 1.1, -0.1}}, false, 1);
  const geo::BodyDelta delta = geo::split(body, front, {{0.51, -0.1, 0.5}, {0.49, 1.1, 0.5}});
  solid.update(body, delta, state);
  environment.fixed.resize(body.nodes.size(), 0);
  solid.step_implicit(state, 1.0 / 24, environment);

  const std::vector<double> stress = geo::von_mises_stress(solid, body.nodes, state);
  const std::vector<geo::Vec3> moved = geo::material_displacement(solid, body.nodes, body.graph, state);
  double lowest = 0;
  for (const geo::Vec3& u : moved) lowest = std::min(lowest, u.z());
  std::printf("%zu nodes, %zu of them new; sag %.4f m, stress up to %.0f Pa\n", body.nodes.size(),
              body.nodes.size() - n, -lowest, *std::max_element(stress.begin(), stress.end()));
  return lowest < 0 ? 0 : 1;
}
