#include <catch2/catch.hpp>

#include "base/random.h"
#include "cases.h"
#include "sampling/count.h"
#include "sampling/leaf_index.h"
#include "solids.h"

using namespace geo;

namespace {

SpacedLeaves leaves_of(const TriangleMesh& mesh, const SampleOptions& options) {
  const LeafFinder finder(mesh, options, {});
  SampleReport report;
  return *finder.at(options.spacing, finder.thin_levels(), ~std::size_t(0), report);
}

std::vector<Leaf> in_one(const LeafLists& lists) {
  std::vector<Leaf> all;
  for (const auto& list : lists) all.insert(all.end(), list.begin(), list.end());
  return all;
}

bool touch(const Cell& a, const Cell& b) {
  for (int i = 0; i < 3; ++i)
    if (a.corner[i] > b.corner[i] + (1 << b.level) || b.corner[i] > a.corner[i] + (1 << a.level)) return false;
  return true;
}

}  // namespace

TEST_CASE("a cell has one name") {
  Random random(1);
  for (int i = 0; i < 1000; ++i) {
    const std::array<std::int32_t, 3> c{static_cast<std::int32_t>(random.below(1 << 21)),
                                        static_cast<std::int32_t>(random.below(1 << 21)),
                                        static_cast<std::int32_t>(random.below(1 << 21))};
    REQUIRE(corner_of(morton(c)) == c);
  }
}

TEST_CASE("leaves are in order, apart, and differ from those they touch by one level at most") {
  for (const auto& [name, mesh] : solids::all())
    for (const int across : {0, 3})
      for (const int levels : {1, 2, 4}) {
        SampleOptions options;
        options.spacing = 0.05 * bounding_box(mesh).diagonal();
        options.levels = levels;
        options.across = across;
        const auto leaves = in_one(leaves_of(mesh, options).lists);
        INFO(name << ", across " << across << ", levels " << levels << ", " << leaves.size() << " leaves");
        REQUIRE(leaves.size() > 100);
        for (std::size_t i = 0; i + 1 < leaves.size(); ++i)
          REQUIRE(morton(leaves[i].cell.corner) + (std::uint64_t(1) << 3 * leaves[i].cell.level) <=
                  morton(leaves[i + 1].cell.corner));
        std::size_t graded = 0;
        if (leaves.size() < 4000)
          for (std::size_t i = 0; i < leaves.size(); ++i)
            for (std::size_t j = 0; j < i; ++j)
              if (leaves[i].cell.level != leaves[j].cell.level && touch(leaves[i].cell, leaves[j].cell)) {
                ++graded;
                REQUIRE(std::abs(leaves[i].cell.level - leaves[j].cell.level) == 1);
              }
        if (levels == 1 && across == 0) CHECK(graded == 0);
      }
}

TEST_CASE("five levels in a block leave few nodes in the depth and fine ones at the skin") {
  const auto mesh = make_block({1, 1, 1}, 0.5);
  SampleOptions options;
  options.spacing = 0.02;
  options.levels = 5;
  std::vector<std::size_t> by_level(5, 0);
  for (const Leaf& leaf : in_one(leaves_of(mesh, options).lists)) {
    ++by_level[static_cast<std::size_t>(leaf.cell.level)];
    if (!leaf.whole) REQUIRE(leaf.cell.level == 0);
  }
  CHECK(by_level[0] > 10000);
  CHECK(by_level[1] > 1000);
  CHECK(by_level[1] < by_level[0] / 4);
  CHECK(by_level[2] + by_level[3] + by_level[4] > 10);
  CHECK(by_level[3] + by_level[4] < by_level[2]);
}

TEST_CASE("regions know exactly what is inside, on faces and edges too") {
  Random random(7);
  for (const auto& [name, mesh] : solids::all()) {
    CAPTURE(name);
    const RegionTree tree(mesh);
    const Box3 box = bounding_box(mesh);
    // Cells from the box's corner: those of the block have faces, edges and corners in its own.
    const Lattice lattice{box.lo - Vec3::Constant(0.25), 0.03125};
    std::size_t asked = 0, inside = 0;
    const auto descend = [&](const auto& self, const Region& region) -> void {
      REQUIRE(region.inside == tree.tree().inside(region.probe));
      if (region.cell.level > 2 || (region.cell.level > 0 && random.below(4) == 0))
        return tree.divide(lattice, region, [&](Region&& part) { self(self, part); });
      if (random.below(8) != 0) return;
      const Box3 b = lattice.box(region.cell);
      std::vector<Vec3> points;
      for (int i = 0; i < 27; ++i) points.push_back(b.lo + Vec3(i % 3, i / 3 % 3, i / 9).cwiseProduct(b.hi - b.lo) / 2);
      std::vector<char> answers(points.size());
      tree.inside(region, points, answers);
      for (std::size_t i = 0; i < points.size(); ++i, ++asked) {
        REQUIRE(bool(answers[i]) == tree.tree().inside(points[i]));
        REQUIRE(tree.inside(region, points[i]) == bool(answers[i]));
        inside += static_cast<std::size_t>(answers[i]);
      }
    };
    descend(descend, tree.root(lattice, {{0, 0, 0}, 7}));
    CHECK(asked > 500);
    CHECK(inside > asked / 10);
    CHECK(inside < asked);
  }
}

TEST_CASE("a box and a triangle are called apart only when they are") {
  Random random(11);
  int apart = 0;
  for (int i = 0; i < cases(20000); ++i) {
    // On a coarse grid, so that many touch by a corner, an edge or a plane.
    const auto point = [&] { return Vec3(random.below(9), random.below(9), random.below(9)); };
    const Vec3 a = point(), b = point(), c = point(), lo = point();
    const Box3 box{lo, lo + Vec3(1 + random.below(2), 1 + random.below(2), 1 + random.below(2))};
    if (may_meet(box, a, b, c)) continue;
    ++apart;
    for (int k = 0; k < 100; ++k) {  // no point of the triangle is in the box
      double u = random.below(9) / 8.0, v = random.below(9) / 8.0;
      if (u + v > 1) {
        u = 1 - u;
        v = 1 - v;
      }
      const Vec3 p = a + u * (b - a) + v * (c - a);
      INFO(i);
      REQUIRE_FALSE(Box3{p, p}.meets(box));
    }
  }
  CHECK(apart > 5000);
}

TEST_CASE("the leaves around a cell are those that touch it") {
  const auto mesh = make_polyp(8);
  SampleOptions options;
  options.spacing = 0.1;
  options.levels = 3;
  options.across = 4;
  const auto leaves = in_one(leaves_of(mesh, options).lists);
  std::vector<std::uint64_t> codes;
  std::vector<std::uint8_t> levels;
  for (const Leaf& leaf : leaves) {
    codes.push_back(morton(leaf.cell.corner));
    levels.push_back(static_cast<std::uint8_t>(leaf.cell.level));
  }
  const LeafIndex index(codes, levels);
  Random random(3);
  for (int k = 0; k < 300; ++k) {
    const Cell cell = leaves[random.below(static_cast<std::uint32_t>(leaves.size()))].cell;
    const int level = cell.level + static_cast<int>(random.below(3));
    std::vector<std::uint32_t> found, expected;
    index.around(cell, level, [&](std::uint32_t row) { found.push_back(row); });
    std::sort(found.begin(), found.end());
    for (std::uint32_t row = 0; row < leaves.size(); ++row) {
      bool meets = true;
      for (int i = 0; i < 3; ++i) {
        const int at = cell.corner[i] >> level << level, edge = 1 << level;
        meets &= leaves[row].cell.corner[i] < at + 2 * edge &&
                 leaves[row].cell.corner[i] + (1 << leaves[row].cell.level) > at - edge;
      }
      if (meets) expected.push_back(row);
    }
    REQUIRE(found == expected);
  }
}
