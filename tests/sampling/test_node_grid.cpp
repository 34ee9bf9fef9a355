#include <catch2/catch.hpp>
#include <map>

#include "base/random.h"
#include "cases.h"
#include "sampling/node_grid.h"

using namespace geo;

TEST_CASE("a node grid answers as a plain list of nodes does, whatever is put in and taken out") {
  const auto [first, count] = seeds(60);
  std::size_t found = 0;
  for (auto seed = first; seed < first + static_cast<std::uint64_t>(count); ++seed) {
    Random random(seed);
    CAPTURE(seed);
    // Even, graded over many scales, or on a lattice with several nodes at a place.
    const auto any = [&]() -> Vec3 {
      const Vec3 u(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
      if (seed % 3 == 0) return u;
      if (seed % 3 == 1) return std::exp2(-double(random.below(45))) * u + Vec3(3, 0, 0);
      return Vec3(random.below(4), random.below(4), random.below(4));
    };
    std::vector<Vec3> x;
    std::map<std::uint32_t, Vec3> model;
    const auto start = random.below(200);
    for (std::uint32_t i = 0; i < start; ++i) {
      x.push_back(any());
      model[i] = x[i];
    }
    NodeGrid grid(0.2, x);
    for (int step = 0; step < 400; ++step) {
      switch (random.below(4)) {
        case 0: {
          const auto row = static_cast<std::uint32_t>(x.size());
          x.push_back(random.below(20) ? any() : Vec3(100 * any()));
          grid.insert(x, row);
          model[row] = x[row];
          break;
        }
        case 1:
          if (!model.empty()) {
            const auto it = std::next(model.begin(), random.below(static_cast<std::uint32_t>(model.size())));
            const auto row = it->first;
            grid.erase(row, it->second);
            model.erase(it);
            if (random.below(2)) {
              x[row] = any();
              grid.insert(x, row);
              model[row] = x[row];
            }  // moved
          }
          break;
        case 2: {
          const Vec3 p = any();
          const double radius = std::exp2(-double(random.below(30))) * 4;
          std::vector<std::uint32_t> got{12345}, expected{12345};
          grid.within(x, p, radius, got);
          for (const auto& [row, at] : model)
            if ((at - p).squaredNorm() <= radius * radius) expected.push_back(row);
          REQUIRE(got == expected);
          found += got.size() - 1;
          break;
        }
        default: {
          const Vec3 p = any();
          const auto k = random.below(30);
          const auto self = random.below(100);
          const auto accept = [](std::uint32_t row) { return row % 3 != 0; };
          std::vector<std::pair<double, std::uint32_t>> all;
          for (const auto& [row, at] : model)
            if (row != self && accept(row)) all.push_back({(at - p).squaredNorm(), row});
          std::sort(all.begin(), all.end());
          std::vector<std::uint32_t> expected;
          for (std::size_t i = 0; i < std::min<std::size_t>(k, all.size()); ++i) expected.push_back(all[i].second);
          REQUIRE(grid.nearest(x, p, k, self, accept) == expected);
        }
      }
      REQUIRE(grid.size() == model.size());
    }
  }
  CHECK(found > 1000);
}

TEST_CASE("a node grid takes few bytes a node") {
  Random random(1);
  std::vector<Vec3> x;
  for (int i = 0; i < 20000; ++i) x.push_back({random.uniform(), random.uniform(), random.uniform()});
  CHECK(NodeGrid(0.03, x).bytes() <= 24 * x.size());
}
