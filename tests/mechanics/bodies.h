// Bodies that the tests of mechanics share: blocks, cut by planes, and their state at rest.
#pragma once

#include "kerf/body.h"
#include "kerf/mesh.h"
#include "kerf/nodes.h"
#include "kerf/solid.h"

namespace geo {

/// A block [0, size] with jittered nodes of one spacing.
inline Body block_body(const Vec3& size, double spacing, double edge = 0) {
  SampleOptions options;
  options.spacing = spacing;
  options.levels = 1;
  const TriangleMesh mesh = make_block(size, edge > 0 ? edge : 2 * spacing);
  return build_body(Complex::from_skin(mesh), sample_nodes(mesh, options));
}

/// A state without motion.
inline State at_rest(const Body& body) {
  return {std::vector<Vec3>(body.nodes.size(), Vec3::Zero()), std::vector<Vec3>(body.nodes.size(), Vec3::Zero())};
}

/// Front positions of a straight blade from a to b, which moves by `step` each time.
inline std::vector<Vec3> blade_at(const Vec3& a, const Vec3& b, const Vec3& step, int k, int points = 2) {
  std::vector<Vec3> front;
  for (int i = 0; i < points; ++i) front.push_back(a + (b - a) * i / (points - 1.0) + k * step);
  return front;
}

}  // namespace geo
