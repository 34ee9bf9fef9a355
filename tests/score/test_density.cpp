#include <catch2/catch.hpp>

#include "base/random.h"
#include "cases.h"
#include "kerf/check.h"
#include "kerf/crack.h"
#include "kerf/error.h"
#include "kerf/mesh.h"
#include "kerf/pieces.h"
#include "kerf/score.h"
#include "score/patterns.h"

using namespace geo;

namespace {

// A block of length 2 whose vertices beyond the middle have one colour, and the others another.
TriangleMesh painted_block(const Color& low, const Color& high) {
  TriangleMesh block = make_block({2, 1, 1}, 0.05);
  for (const auto& t : block.triangles) {
    std::array<Color, 3> colors;
    for (std::size_t k = 0; k < 3; ++k) colors[k] = block.vertices[t[k]].x() > 1 ? high : low;
    block.attributes.color.push_back(colors);
  }
  return block;
}

}  // namespace

TEST_CASE("Cells are as many as the paint says", "[score][density]") {
  const auto [first, count] = seeds(2);
  for (const double ratio : {1.0, 3.0, 9.0}) {
    const TriangleMesh block = painted_block({1 / ratio, 0, 0, 1}, {1, 0, 0, 1});
    const TriangleBvh skin(corners_of(block));
    PatternOptions options;
    options.density = relative_density(skin, painted_density(block, ColorChannel::red));
    int high = 0, all = 0;
    for (int c = 0; c < count; ++c) {
      options.seed = first + static_cast<std::uint64_t>(c);
      for (const Vec3& p : sample_sites(skin, 300, Mat3::Identity(), options)) {
        ++all;
        high += p.x() > 1;
      }
    }
    // Independent sites would be binomial: four standard deviations are missed once in 16,000 runs.
    // Sites that keep apart vary less. A twentieth more is for sites that keep apart from the skin.
    const double share = ratio / (1 + ratio),
                 bound = 4 * std::sqrt(share * (1 - share) / all) + 0.05 * share * (1 - share);
    INFO("ratio " << ratio << ", seed " << first << ": " << high << " of " << all);
    CHECK(std::abs(double(high) / all - share) < bound);
  }
}

TEST_CASE("The density of a colour, of values, of a ramp", "[score][density]") {
  const TriangleMesh block = painted_block({0.25, 0.5, 0.75, 0.1}, {1, 0, 0.5, 0.3});
  const Vec3 low(0.3, 0.4, 0.6), high(1.7, 0.2, 0.9);
  const auto values = [&](ColorChannel channel) {
    const Density density = painted_density(block, channel);
    return std::array{density(low), density(high)};
  };
  CHECK(values(ColorChannel::red) == std::array{0.25, 1.0});
  CHECK(values(ColorChannel::green) == std::array{0.5, 0.0});
  CHECK(values(ColorChannel::blue) == std::array{0.75, 0.5});
  CHECK(values(ColorChannel::alpha)[1] == Approx(0.3));
  CHECK(values(ColorChannel::luminance)[0] == Approx(0.2126 * 0.25 + 0.7152 * 0.5 + 0.0722 * 0.75));
  // Linear values come back at points of the skin.
  std::vector<double> linear;
  for (const Vec3& p : block.vertices) linear.push_back(1 + p.x() + 2 * p.y() + 3 * p.z());
  const Density density = painted_density(block, linear);
  Random random(3);
  for (int i = 0; i < 50; ++i) {
    const Vec3 p(random.uniform(0, 2), random.uniform(), i % 2);
    CHECK(density(p) == Approx(1 + p.x() + 2 * p.y() + 3 * p.z()));
  }
  const Density ramp = ramp_density({{0, 0, 0}, {2, 1, 1}}, {-2, 0, 0});
  CHECK(ramp({0, 0.3, 0.2}) == Approx(1));
  CHECK(ramp({0.5, 0.3, 0.2}) == Approx(0.75));
  CHECK(ramp({3, 0.3, 0.2}) == 0);
}

TEST_CASE("Pieces follow the density, for any number of threads", "[score][density]") {
  const Complex block = Complex::from_skin(make_block({2, 1, 1}, 0.25));
  ScoreOptions options;
  options.pattern.density = [](const Vec3& p) { return p.x() < 1 ? 1.0 : 0.1; };
  options.pieces = 33;
  Complex cut;
  const Score score = make_score(block, options, {}, &cut);
  CHECK(score.pieces == 33);
  CHECK(make_score(block, options).sheet.vertices == score.sheet.vertices);
  const Pieces pieces = find_pieces(cut);
  int dense = 0;
  for (std::uint32_t p = 0; p < pieces.count; ++p) dense += bounding_box(piece_mesh(cut, pieces, p)).lo.x() < 0.9;
  // 30 sites are expected there. Cells at the middle reach far into the other half.
  CHECK(dense >= 27);
  CHECK(dense < 33);
}

TEST_CASE("Densities without sense are refused", "[score][density]") {
  const TriangleMesh plain = make_block({1, 1, 1}, 1);
  CHECK_THROWS_WITH(painted_density(plain, ColorChannel::red), Catch::Contains("no colours"));
  CHECK_THROWS_WITH(painted_density(plain, std::vector<double>(3, 1.0)), Catch::Contains("3 values"));
  CHECK_THROWS_WITH(painted_density(plain, std::vector<double>(plain.vertices.size(), -1.0)),
                    Catch::Contains("below 0"));
  CHECK_THROWS_AS(ramp_density({{0, 0, 0}, {1, 1, 1}}, Vec3::Zero()), InputError);
  const Complex block = Complex::from_skin(plain);
  ScoreOptions options;
  options.pattern.density = [](const Vec3&) { return 0.0; };
  CHECK_THROWS_WITH(make_score(block, options), Catch::Contains("0 everywhere"));
  options.pattern.density = [](const Vec3& p) { return p.x() - 0.5; };
  CHECK_THROWS_WITH(make_score(block, options), Catch::Contains("below 0"));
}
