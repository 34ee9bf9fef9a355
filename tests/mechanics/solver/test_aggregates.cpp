// Aggregates of cut blocks: connected, in one component and one box each, numbered along the body.
#include "mechanics/solver/aggregates.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <set>

#include "base/random.h"
#include "cases.h"
#include "mechanics/bodies.h"
#include "mechanics/solver/solid_discretisation.h"

using namespace geo;

TEST_CASE("aggregates are connected sets of nodes of one component, of bounded size, in order along it",
          "[mechanics]") {
  const auto [first, count] = seeds(8);
  std::size_t divided = 0;
  for (std::uint64_t seed = first; seed < first + static_cast<std::uint64_t>(count); ++seed) {
    INFO("KERF_CASE=" << seed);
    Random random(seed);
    Vec3 size(0.4, 0.4, 0.4);
    size[static_cast<int>(random.below(3))] = 1.2;
    Body body = block_body(size, 0.1);
    // A cut from above, part of the way or all of it.
    const double x = random.uniform(0.3, 0.7) * size.x(), deep = random.uniform(0.3, 1.4) * size.z();
    const Vec3 a(x, -0.1, size.z() + 0.1), b(x, size.y() + 0.1, size.z() + 0.1);
    FrontState front = begin_front(std::vector<Vec3>{a, b}, false, 1);
    split(body, front, {a - Vec3(0, 0, deep), b - Vec3(0, 0, deep)});
    const Solid owner(body, Material());
    const SolidDiscretisation& solid = SolidDiscretisation::of(owner);
    const Aggregates::Size bounds{10 + random.below(60), 4 + random.below(60)};
    const Aggregates aggregates(solid.position, solid.mls, solid.component, solid.components, bounds);
    REQUIRE(aggregates.of.size() == solid.size());
    CHECK(std::is_sorted(aggregates.component.begin(), aggregates.component.end()));
    std::vector<std::vector<std::uint32_t>> nodes(aggregates.count());
    std::vector<std::size_t> component_size(solid.components, 0);
    std::vector<Box3> component_box(solid.components);
    for (std::uint32_t i = 0; i < solid.size(); ++i) {
      REQUIRE(aggregates.of[i] < aggregates.count());
      nodes[aggregates.of[i]].push_back(i);
      ++component_size[solid.component[i]];
      component_box[solid.component[i]].add(solid.position[i]);
    }
    double last = 0;
    for (std::size_t k = 0; k < nodes.size(); ++k) {
      const auto component = aggregates.component[k];
      REQUIRE_FALSE(nodes[k].empty());
      const std::size_t most = std::max(bounds.least_nodes, component_size[component] / bounds.max_per_component);
      CHECK(nodes[k].size() <= most);
      divided += nodes[k].size() < component_size[component];
      // Connected: a search from the first node along neighbours reaches all.
      std::set<std::uint32_t> reached{nodes[k][0]};
      std::vector<std::uint32_t> stack{nodes[k][0]};
      while (!stack.empty()) {
        const auto i = stack.back();
        stack.pop_back();
        for (const auto j : solid.mls[i].neighbors)
          if (aggregates.of[j] == k && reached.insert(j).second) stack.push_back(j);
      }
      CHECK(reached.size() == nodes[k].size());
      Eigen::Index axis;
      (component_box[component].hi - component_box[component].lo).maxCoeff(&axis);
      double mean = 0;
      for (const auto i : nodes[k]) {
        CHECK(solid.component[i] == component);
        mean += solid.position[i][axis] / double(nodes[k].size());
      }
      if (k > 0 && aggregates.component[k - 1] == component) CHECK(mean >= last - 1e-12);
      last = mean;
    }
    // Boxes are halved: one as small as half the bound is a connected part of a box that cuts have
    // divided, so most are larger.
    for (std::uint32_t c = 0; c < solid.components; ++c) {
      const std::size_t most = std::max(bounds.least_nodes, component_size[c] / bounds.max_per_component);
      const auto parts =
          static_cast<std::size_t>(std::count(aggregates.component.begin(), aggregates.component.end(), c));
      CHECK(parts >= component_size[c] / most);
      CHECK(parts <= std::max<std::size_t>(1, 4 * component_size[c] / most + 4));
    }
  }
  CHECK(divided > 100);
}
