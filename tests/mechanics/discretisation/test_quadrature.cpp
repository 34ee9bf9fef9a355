// Quadrature cells: exactness, volumes, groups and updates.
#include "mechanics/discretisation/quadrature.h"

#include <catch2/catch.hpp>

#include "mechanics/bodies.h"
#include "sampling/octree.h"

using namespace geo;

TEST_CASE("the four points of a whole cell integrate quadratic functions exactly", "[quadrature]") {
  const Body body = block_body({1, 1, 1}, 0.2);
  const QuadratureCells cells(body);
  std::size_t whole = 0;
  for (const QuadratureCell& cell : cells.cells()) {
    if (!cell.whole) continue;
    ++whole;
    Vec3 mean = Vec3::Zero();
    for (const Vec3& p : cell.point) mean += 0.25 * p;
    Mat3 moments = Mat3::Zero();
    for (const Vec3& p : cell.point) moments += 0.25 * (p - mean) * (p - mean).transpose();
    // A cube of edge h: its centre, and h²/12 in each direction.
    const double h = std::cbrt(cell.unscaled_volume);
    CHECK((moments - h * h / 12 * Mat3::Identity()).norm() < 1e-12);
  }
  CHECK(whole > 10);
}

TEST_CASE("cells have the nodes' volume, and points lie inside the body", "[quadrature]") {
  const Body body = block_body({1, 0.7, 0.5}, 0.17);
  const QuadratureCells cells(body);
  double volume = 0, nodes = 0;
  for (const QuadratureCell& cell : cells.cells()) {
    volume += cell.volume;
    CHECK(cell.volume > 0);
    for (const Vec3& p : cell.point) CHECK(Box3{Vec3::Zero(), Vec3(1, 0.7, 0.5)}.meets({p, p}));
  }
  for (const double v : body.nodes.volume) nodes += v;
  CHECK(volume == Approx(nodes).epsilon(1e-12));
}

TEST_CASE("groups cover all cells in order, none larger than its bound", "[quadrature]") {
  const QuadratureCells cells(block_body({1, 0.7, 0.5}, 0.12));
  for (std::size_t k = 1; k < cells.cells().size(); ++k)
    REQUIRE(morton(cells.cells()[k - 1].cell.corner) < morton(cells.cells()[k].cell.corner));
  for (const std::size_t bound : {1u, 7u, 64u, 100000u}) {
    const auto groups = cells.groups(bound);
    REQUIRE(groups.front() == 0);
    REQUIRE(groups.back() == cells.cells().size());
    for (std::size_t k = 0; k + 1 < groups.size(); ++k) {
      CHECK(groups[k] < groups[k + 1]);
      CHECK(groups[k + 1] - groups[k] <= bound);
    }
  }
}

TEST_CASE("an update after finer nodes gives the cells of a build from scratch", "[quadrature]") {
  Body body = block_body({1, 0.7, 0.5}, 0.2);
  QuadratureCells cells(body);
  REQUIRE_FALSE(cells.update(body));
  // Nodes in one corner become finer; the first one, which decides the lattice, stays.
  std::size_t finer = 0;
  for (std::size_t i = 1; i < body.nodes.size(); ++i)
    if (body.nodes.position[i].x() > 0.6) {
      body.nodes.spacing[i] /= 2;
      ++finer;
    }
  REQUIRE(finer > 0);
  const std::size_t before = cells.cells().size();
  CHECK(cells.update(body));
  CHECK(cells.cells().size() > before);
  const QuadratureCells scratch(body);
  REQUIRE(cells.cells().size() == scratch.cells().size());
  for (std::size_t k = 0; k < scratch.cells().size(); ++k) {
    const QuadratureCell &a = cells.cells()[k], &b = scratch.cells()[k];
    CHECK((a.cell.corner == b.cell.corner && a.cell.level == b.cell.level && a.half == b.half && a.volume == b.volume &&
           a.point == b.point));
  }
}

TEST_CASE("whole cells beside finer ones appear twice, with an even lattice of eight points", "[quadrature]") {
  SampleOptions options;
  options.spacing = 0.08;
  options.levels = 2;
  const TriangleMesh mesh = make_block({1, 1, 1}, 0.2);
  const QuadratureCells all(build_body(Complex::from_skin(mesh), sample_nodes(mesh, options)));
  const auto& cells = all.cells();
  std::size_t twice = 0;
  for (std::size_t k = 0; k < cells.size(); ++k) {
    if (cells[k].half != 1) continue;
    ++twice;
    REQUIRE(k + 1 < cells.size());
    REQUIRE(cells[k + 1].half == 2);
    REQUIRE(cells[k + 1].cell.corner == cells[k].cell.corner);
    CHECK(cells[k].volume == cells[k + 1].volume);
    const double edge = std::cbrt(2 * cells[k].volume);
    for (std::size_t i = 0; i < 8; ++i)
      for (std::size_t j = 0; j < i; ++j) {
        const Vec3 offset = cells[k + i / 4].point[i % 4] - cells[k + j / 4].point[j % 4];
        for (int a = 0; a < 3; ++a) CHECK((std::abs(offset[a]) < 1e-12 || std::abs(offset[a]) == Approx(edge / 2)));
        CHECK(offset.norm() > 0.4 * edge);
      }
  }
  CHECK(twice > 50);
}
