// The nearest nodes that are seen, of nodes together and apart, against all triangles one by one.
#include <catch2/catch.hpp>

#include "cases.h"
#include "clouds.h"
#include "geometry/predicates.h"
#include "graph/nearest_visible.h"
#include "kerf/parallel.h"

using namespace geo;

TEST_CASE("the nearest seen nodes are those of every triangle asked for every pair, whatever stands together") {
  const auto [first, count] = seeds(10 * cloud_kinds);
  std::size_t seen = 0, hidden = 0;
  for (auto seed = first; seed < first + static_cast<std::uint64_t>(count); ++seed) {
    CAPTURE(seed);
    Random random(seed);
    NodeSet nodes;
    nodes.position = cloud(random, static_cast<int>(seed % cloud_kinds), 150);
    const auto any = [&] { return nodes.position[random.below(150)]; };
    std::vector<std::array<Vec3, 3>> soup(random.below(40));
    for (auto& t : soup) {
      for (auto& corner : t) corner = 0.5 * (any() + any());
      if (random.below(3) == 0) t[2] = 0.5 * (t[0] + t[1]);
    }
    double size = 0;
    for (const Vec3& p : nodes.position) size = std::max(size, (p - nodes.position[0]).cwiseAbs().maxCoeff());
    for (int i = 0; i < 150; ++i) nodes.radius.push_back(size * std::exp2(-double(random.below(8))));
    const NodeGrid grid(size, nodes.position);
    const auto near = [&](const Box3& box, std::vector<std::array<Vec3, 3>>& out) {
      for (const auto& t : soup)
        if (box_of(t[0], t[1], t[2]).meets(box)) out.push_back(t);
    };
    std::vector<std::uint32_t> ids;
    for (std::uint32_t i = 0; i < 150; ++i)
      if (random.below(3) > 0) ids.push_back(i);
    const int k = 1 + static_cast<int>(random.below(40));
    for (const int thread_count : {1, 2}) {
      set_threads(thread_count);
      const auto found = nearest_visible(nodes, grid, ids, k, near);
      REQUIRE(found.size() == ids.size());
      for (std::size_t n = 0; n < ids.size(); ++n) {
        std::vector<std::uint32_t> expected;
        for (const auto j : grid.nearest(nodes.position, nodes.position[ids[n]], static_cast<std::size_t>(3 * k),
                                         ids[n], [](auto) { return true; })) {
          if (expected.size() == static_cast<std::size_t>(k)) break;
          const bool open = std::none_of(soup.begin(), soup.end(), [&](const auto& t) {
            return segment_meets_triangle(nodes.position[ids[n]], nodes.position[j], t[0], t[1], t[2]);
          });
          if (open) expected.push_back(j);
          ++(open ? seen : hidden);
        }
        CHECK(found[n] == expected);
      }
    }
    set_threads(0);
  }
  CHECK(seen > 1000);
  CHECK(hidden > 1000);
}

TEST_CASE("no nodes see none") {
  CHECK(nearest_visible({}, NodeGrid(), {}, 26, [](const auto&, auto&) {}).empty());
}
