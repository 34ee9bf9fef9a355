// Random node sets and cracks for the graph's tests.
#pragma once

#include <array>
#include <vector>

#include "base/random.h"
#include "graph/guide_set.h"
#include "kerf/nodes.h"

using Soup = std::vector<std::array<geo::Vec3, 3>>;

/// n³ nodes around the points of a grid in the unit cube, off them by up to `jitter` spacings;
/// supports 1.8 to 2.2 wide, times up to `graded` along x.
inline geo::NodeSet jittered(geo::Random& random, int n, double jitter, double graded = 1) {
  geo::NodeSet nodes;
  const double h = 1.0 / n;
  for (int i = 0; i < n * n * n; ++i) {
    const geo::Vec3 p = h * (geo::Vec3(i % n, i / n % n, i / n / n) + geo::Vec3::Constant(0.5));
    nodes.position.push_back(p + jitter * h *
                                     geo::Vec3(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)));
    nodes.radius.push_back(h * (1.8 + 0.4 * p.x()) * (1 + (graded - 1) * p.x()));
    nodes.spacing.push_back(h);
    nodes.volume.push_back(h * h * h);
  }
  return nodes;
}

/// Guides anywhere in the cube, some of them beside faces' edges.
inline std::vector<geo::Guide> random_guides(geo::Random& random, int count, const Soup& faces) {
  std::vector<geo::Guide> guides;
  for (int g = 0; g < count; ++g) {
    geo::Vec3 p(random.uniform(), random.uniform(), random.uniform());
    if (!faces.empty() && g % 3 > 0) {
      const auto& t = faces[random.below(static_cast<std::uint32_t>(faces.size()))];
      const double share = random.uniform();
      p = share * t[0] + (1 - share) * t[1] + 0.01 * (t[0] + t[1] - 2 * t[2]);
    }
    guides.push_back({p, random.uniform(0.1, 0.4)});
  }
  return guides;
}

/// Triangles anywhere in the cube, as large as a few spacings up to all of it.
inline Soup random_faces(geo::Random& random, int count) {
  Soup soup;
  for (int t = 0; t < count; ++t) {
    const geo::Vec3 at(random.uniform(), random.uniform(), random.uniform());
    const double size = random.uniform(0.1, 0.7);
    soup.push_back({at + size * random.direction(), at + size * random.direction(), at + size * random.direction()});
  }
  return soup;
}
