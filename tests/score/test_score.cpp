#include <catch2/catch.hpp>

#include "cases.h"
#include "kerf/check.h"
#include "kerf/crack.h"
#include "kerf/error.h"
#include "kerf/mesh.h"
#include "kerf/pieces.h"
#include "kerf/score.h"
#include "score/sound_pieces.h"

using namespace geo;

namespace {

const std::vector<std::string> patterns{"planes", "crossing", "voronoi", "radial", "glass", "wood", "bricks"};

// Everything a score promises of the pieces it makes, full or partial.
void check_score(const Complex& model, const ScoreOptions& options) {
  const Score score = make_score(model, options);
  Complex cut = model;
  insert_sheet(cut, score.sheet, model.crack_count() + 1);
  const auto report = check_complex(cut, SelfIntersections::find);
  CHECK(report.first_problem == "");
  const Pieces before = find_pieces(model), pieces = find_pieces(cut);
  double had = 0, sum = 0;
  for (const double v : before.volume) had += v;
  if (options.depth < 1) {
    for (const double v : pieces.volume) sum += v;
    CHECK(std::abs(sum - had) <= 1e-12 * had);
    CHECK(pieces.count == before.count);
    CHECK(cut.crack_count() > model.crack_count());
    return;
  }
  CHECK(pieces.count == score.pieces);
  check_sound_pieces(cut, pieces, had, model.crack_count());
}

}  // namespace

TEST_CASE("Each pattern parts a ball into as many pieces as wanted", "[score]") {
  const Complex ball =
      Complex::from_skin(make_star(6, [](const Vec3& d) { return 1 + 0.2 * d.x() + 0.3 * d.z() * d.z(); }));
  const auto [first, count] = seeds(1);
  for (int c = 0; c < count; ++c)
    for (const auto& name : patterns)
      for (const double amplitude : {0.0, 0.015}) {
        ScoreOptions options;
        options.pattern.pattern = pattern_named(name);
        options.pattern.seed = options.jagged.seed = first + static_cast<std::uint64_t>(c);
        options.jagged.amplitude = amplitude;
        options.jagged.frequency = 5;
        options.pieces = 9;
        INFO(name << ", jagged " << amplitude << ", seed " << options.pattern.seed);
        check_score(ball, options);
        CHECK(make_score(ball, options).pieces == 9);
        options.depth = 0.7;
        check_score(ball, options);
      }
}

TEST_CASE("A search can be stopped at any of its reports", "[score]") {
  const Complex block = Complex::from_skin(make_block({2, 1, 1}, 0.25));
  ScoreOptions options;
  options.jagged.amplitude = 0.02;
  options.pieces = 6;
  std::size_t reports = 0;
  make_score(block, options, [&](std::string_view, std::size_t done, std::size_t total) {
    CHECK(done < total);
    return ++reports > 0;
  });
  CHECK(reports >= 8);  // the attempt, six stages of refinement, a round of displacement
  for (std::size_t last = 1; last <= reports; last += 1 + reports / 40) {  // there are thousands
    std::size_t now = 0;
    const auto stop = [&](std::string_view, std::size_t, std::size_t) { return ++now < last; };
    CHECK_THROWS_AS(make_score(block, options, stop), Interrupted);
    CHECK(now == last);
  }
}

TEST_CASE("Cells are small near the impact", "[score]") {
  const Complex block = Complex::from_skin(make_block({2, 1, 1}, 0.25));
  ScoreOptions options;
  options.pattern.impact = Vec3(0.1, 0.5, 0.5);
  options.pieces = 25;
  Complex cut = block;
  const Score score = make_score(block, options);
  CHECK(score.pieces == 25);
  insert_sheet(cut, score.sheet, 1);
  const Pieces pieces = find_pieces(cut);
  double near = 0, far = 0;
  int near_count = 0, far_count = 0;
  for (std::uint32_t p = 0; p < pieces.count; ++p) {
    const double x = bounding_box(piece_mesh(cut, pieces, p)).center().x();
    (x < 0.5 ? near : far) += pieces.volume[p];
    ++(x < 0.5 ? near_count : far_count);
  }
  REQUIRE((near_count > 0 && far_count > 0));
  CHECK(near / near_count < 0.5 * far / far_count);
}

TEST_CASE("A user's curves and sheets are taken as they are", "[score]") {
  const Complex block = Complex::from_skin(make_block({2, 1, 1}, 0.25));
  for (const double amplitude : {0.0, 0.01}) {
    ScoreOptions options;
    options.jagged.amplitude = amplitude;
    options.pattern.pattern = Pattern::curves;
    options.pattern.curves = {{{-0.5, 0.4, 0}, {1.1, 0.52, 0.3}, {2.5, 0.3, 0}}, {{0.7, -0.5, 0}, {0.9, 1.5, 0}}};
    CHECK(make_score(block, options).pieces == 4);
    check_score(block, options);
    options.pattern.pattern = Pattern::sheets;
    TriangleMesh flat;
    flat.vertices = {{-1, -1, 0.47}, {4, -1, 0.52}, {-1, 4, 0.55}};
    flat.triangles = {{0, 1, 2}};
    TriangleMesh ball = make_sphere(3);
    for (Vec3& p : ball.vertices) p = 0.3 * p + Vec3(1, 0.5, 0.5);
    options.pattern.sheets = {flat, ball};
    CHECK(make_score(block, options).pieces == 4);
    check_score(block, options);
  }
}

TEST_CASE("Curves that meet in points part a model there", "[score]") {
  // Squares of separate curves, with edges in common planes, and a fan of three curves in a point.
  const Complex block = Complex::from_skin(make_block({12, 6, 1}, 0.5));
  ScoreOptions options;
  options.pattern.pattern = Pattern::curves;
  for (int i = 0; i < 12; ++i)
    for (int j = 0; j < 6; ++j) {
      const Vec3 a(i + 0.23, j + 0.27, 0), b = a + Vec3(0.51, 0, 0), c = b + Vec3(0, 0.49, 0), d = a + Vec3(0, 0.49, 0);
      for (const auto& curve : {std::vector{a, b, c}, std::vector{a, d}, std::vector{c, d}})
        options.pattern.curves.push_back(curve);
    }
  CHECK(make_score(block, options).pieces == 73);
  const Vec3 middle(3, 1.5, 0);
  options.pattern.curves = {{middle, {-9, 1.4, 0}}, {middle, {25, 1.45, 0}}, {{2.9, 19, 0}, middle}};
  CHECK(make_score(block, options).pieces == 3);
  check_score(block, options);
}

TEST_CASE("A model that is cut already is scored further", "[score]") {
  const Complex block = Complex::from_skin(make_block({2, 1, 1}, 0.5));
  ScoreOptions options;
  options.pieces = 4;
  Complex cut = block;
  insert_sheet(cut, make_score(block, options).sheet, 1);
  options.pieces = 12;
  options.pattern.seed = 5;
  const Score more = make_score(cut, options);
  CHECK(more.pieces == 12);
  insert_sheet(cut, more.sheet, 2);
  CHECK(find_pieces(cut).count == 12);
  CHECK(check_complex(cut, SelfIntersections::find).good());
}

TEST_CASE("Options without sense are refused", "[score]") {
  const Complex block = Complex::from_skin(make_block({1, 1, 1}, 1));
  const auto refused = [&](auto change) {
    ScoreOptions options;
    change(options);
    CHECK_THROWS_AS(make_score(block, options), InputError);
  };
  refused([](auto& o) { o.pieces = 0; });
  refused([](auto& o) { o.depth = 0; });
  refused([](auto& o) { o.depth = 1.5; });
  refused([](auto& o) { o.attempts = 0; });
  refused([](auto& o) { o.pattern.cluster = 0; });
  refused([](auto& o) { o.pattern.grain = 0.5; });
  refused([](auto& o) {
    o.pattern.pattern = Pattern::planes;
    o.pattern.axis = Vec3::Zero();
  });
  refused([](auto& o) {
    o.jagged.amplitude = 0.1;
    o.jagged.frequency = 0;
  });
  CHECK_THROWS_WITH(pattern_named("zigzag"), Catch::Contains("voronoi"));
}
