#include <catch2/catch.hpp>
#include <map>

#include "cases.h"
#include "geometry/bvh.h"
#include "kerf/check.h"
#include "kerf/crack.h"
#include "kerf/error.h"
#include "kerf/mesh.h"
#include "kerf/pieces.h"
#include "kerf/score.h"
#include "score/jagged.h"
#include "score/sound_pieces.h"

using namespace geo;

namespace {

std::vector<std::pair<std::string, TriangleMesh>> models() {
  return {{"block", make_block({2, 1, 1}, 0.25)},
          {"ball", make_sphere(6)},
          {"letter K", make_letter('K', 0.25, 16)},
          {"apple", make_apple(8)},
          {"plate", make_block({2, 1, 0.12}, 0.2)}};
}

// Pieces and chips of a score: closed, without self-intersection, and none is a speck.
void check_chips(const TriangleMesh& model, const ScoreOptions& options, std::uint32_t least_chips) {
  const Complex complex = Complex::from_skin(model);
  ScoreOptions plain = options;
  plain.chips.count = 0;
  const Score before = make_score(complex, plain);
  Complex made;
  const Score score = make_score(complex, options, {}, &made);
  CHECK(score.pieces == before.pieces);
  CHECK(score.chips >= least_chips);
  CHECK(score.chips <= std::uint32_t(options.chips.count));
  Complex cut = complex;
  insert_sheet(cut, score.sheet, 1);
  CHECK(check_complex(cut, SelfIntersections::find).first_problem == "");
  const Pieces pieces = find_pieces(cut);
  REQUIRE(pieces.count == score.pieces + score.chips);
  CHECK(find_pieces(made).volume == pieces.volume);
  const double had = signed_volume(model);
  const double length = options.chips.size * std::cbrt(had / score.pieces);
  // The chips are the smallest: the pieces have all of the rest.
  if (score.chips > 0) CHECK(pieces.volume.back() >= options.chips.least * 0.1 * std::pow(length / 2, 3));
  check_sound_pieces(cut, pieces, had, 0);
}

}  // namespace

TEST_CASE("Chips are pieces of their own beside those of the pattern", "[score][chips]") {
  const auto [first, count] = seeds(1);
  for (int c = 0; c < count; ++c)
    for (const auto& [name, model] : models())
      for (const double amplitude : {0.0, 0.01}) {
        ScoreOptions options;
        options.pattern.seed = options.jagged.seed = first + static_cast<std::uint64_t>(c);
        options.pieces = 6;
        options.jagged.amplitude = amplitude;
        options.jagged.frequency = 5;
        options.chips.count = 12;
        INFO(name << ", jagged " << amplitude << ", seed " << options.pattern.seed);
        check_chips(model, options, 6);
      }
}

TEST_CASE("Chips break off planes, curves and a model that is cut", "[score][chips]") {
  const TriangleMesh block = make_block({2, 1, 1}, 0.25);
  ScoreOptions options;
  options.chips.count = 10;
  options.chips.size = 0.15;
  options.pattern.pattern = Pattern::curves;
  options.pattern.curves = {{{0.7, -1, 0}, {0.8, 0.5, 0}, {0.7, 2, 0}}};
  check_chips(block, options, 8);
  options.pattern.curves.clear();
  options.pattern.pattern = Pattern::bricks;
  options.pieces = 8;
  check_chips(block, options, 8);
  Complex cut = Complex::from_skin(block);
  options.chips.count = 0;
  insert_sheet(cut, make_score(cut, options).sheet, 1);
  const std::uint32_t had = find_pieces(cut).count;
  options.chips.count = 10;
  options.pattern.pattern = Pattern::planes;
  options.pieces = int(had) + 8;
  const Score more = make_score(cut, options);
  CHECK(more.chips > 0);
  insert_sheet(cut, more.sheet, 2);
  CHECK(find_pieces(cut).count == more.pieces + more.chips);
}

TEST_CASE("Chips without sense are refused, and none are made where there is no edge", "[score][chips]") {
  const Complex ball = Complex::from_skin(make_sphere(4));
  const auto refused = [&](auto change) {
    ScoreOptions options;
    options.pieces = 3;
    options.chips.count = 2;
    change(options);
    CHECK_THROWS_AS(make_score(ball, options), InputError);
  };
  refused([](auto& o) { o.chips.count = -1; });
  refused([](auto& o) { o.chips.size = 0; });
  refused([](auto& o) { o.chips.size = 1.5; });
  refused([](auto& o) { o.chips.least = -0.1; });
  refused([](auto& o) { o.depth = 0.5; });
  ScoreOptions whole;
  whole.pieces = 1;
  whole.chips.count = 5;
  CHECK(make_score(ball, whole).chips == 0);
}

TEST_CASE("Detail at edges is near the skin alone", "[score][jagged]") {
  const TriangleMesh ball = make_sphere(8);
  const TriangleBvh skin(corners_of(ball));
  TriangleMesh walls;
  walls.vertices = {{-2, -2, 0}, {2, -2, 0}, {2, 2, 0}, {-2, 2, 0}};
  walls.triangles = {{0, 1, 2}, {0, 2, 3}};
  JaggedOptions options;
  options.edge_amplitude = 0.01;
  options.edge_width = 0.08;
  roughen_walls(walls, skin, options);
  const double size = skin.box().diagonal(), width = options.edge_width * size;
  double highest = 0, longest_near = 0, longest_deep = 0;
  for (const auto& t : walls.triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3 &a = walls.vertices[t[k]], &b = walls.vertices[t[(k + 1) % 3]];
      const double depth = skin.closest(0.5 * (a + b)).distance;
      if (depth < 0.5 * width) longest_near = std::max(longest_near, (b - a).norm());
      if (depth > 1.5 * width) longest_deep = std::max(longest_deep, (b - a).norm());
    }
  for (const Vec3& p : walls.vertices) {
    if (skin.inside(p) && skin.closest(p).distance > width) CHECK(p.z() == 0);
    highest = std::max(highest, std::abs(p.z()));
  }
  CHECK(highest > 0.2 * options.edge_amplitude * size);
  CHECK(longest_near < width / 4 + 2 * options.edge_amplitude * size);  // twice an eighth at half the depth
  CHECK(longest_deep > width);
  // No triangle is thinner than bisection of a right-angled one allows, beside the displacement.
  double sharpest = 180;
  for (const auto& t : walls.triangles) {
    const std::array<Vec3, 3> c{walls.vertices[t[0]], walls.vertices[t[1]], walls.vertices[t[2]]};
    if (!skin.inside(c[0]) || skin.closest(c[0]).distance > width) sharpest = std::min(sharpest, smallest_angle(c));
  }
  CHECK(sharpest > 8);
  options.edge_width = 0;
  CHECK_THROWS_AS(roughen_walls(walls, skin, options), InputError);
}
