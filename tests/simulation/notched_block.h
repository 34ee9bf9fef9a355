// A block with a flat crack from its left side, and the front of that crack.
#pragma once

#include "kerf/body.h"
#include "kerf/mesh.h"
#include "kerf/nodes.h"
#include "simulation/fracture_front.h"

struct Notched {
  geo::Body body;
  geo::GrowingFront front;
};

/// The block [0, size], cut in the plane y = `height` from x = 0 to x = `depth`. The front runs
/// along −z, its normal is +y.
inline Notched notched_block(const geo::Vec3& size, double spacing, double depth, double height,
                             std::uint64_t seed = 1) {
  using namespace geo;
  SampleOptions sampling;
  sampling.spacing = spacing;
  sampling.levels = 1;
  sampling.seed = seed;
  const TriangleMesh mesh = make_block(size, 2 * spacing);
  Body body = build_body(Complex::from_skin(mesh), sample_nodes(mesh, sampling));
  const int points = std::max(2, static_cast<int>(size.z() / (0.7 * spacing))) + 1;
  const auto line = [&](double x) {
    std::vector<Vec3> p;
    for (int i = 0; i < points; ++i) p.push_back({x, height, size.z() * (1.04 - 1.08 * i / (points - 1))});
    return p;
  };
  FrontState front = begin_front(line(-0.1), false, 1);
  split(body, front, line(depth));
  return {std::move(body), growing(front, std::vector<Vec3>(front.points.size(), Vec3(0, 1, 0)))};
}
