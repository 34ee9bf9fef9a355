#include <catch2/catch.hpp>
#include <cmath>

#include "base/random.h"
#include "cases.h"
#include "geometry/predicates.h"
#include "kerf/check.h"
#include "kerf/crack.h"
#include "kerf/error.h"
#include "kerf/mesh.h"
#include "kerf/pieces.h"
#include "kerf/score.h"

using namespace geo;

namespace {

// An image of a function of the place, in pixels to the right and down from the corner: 0 black.
GrayImage image_of(int width, int height, const std::function<double(double, double)>& brightness) {
  GrayImage image{.width = width, .height = height, .brightness = {}};
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      image.brightness.push_back(float(std::clamp(brightness(x + 0.5, y + 0.5), 0.0, 1.0)));
  return image;
}

// Brightness of a disc with a smooth rim of one pixel.
std::function<double(double, double)> disc(double x, double y, double radius) {
  return [=](double u, double v) { return std::hypot(u - x, v - y) - radius + 0.5; };
}

// The model cut along the outlines: closed pieces, whose volumes sum to the model's.
Pieces pieces_of(const TriangleMesh& model, const GrayImage& image, const CutOutOptions& options,
                 Complex* cut = nullptr) {
  const Complex complex = Complex::from_skin(model);
  ScoreOptions score;
  score.pattern.pattern = Pattern::curves;
  score.pattern.axis = options.axis;
  score.pattern.curves = cut_out(image, complex.extent(), options).curves;
  Complex made;
  const Score walls = make_score(complex, score, {}, &made);
  CHECK(check_complex(made, SelfIntersections::find).first_problem == "");
  const Pieces pieces = find_pieces(made);
  CHECK(pieces.count == walls.pieces);
  double sum = 0;
  for (const double v : pieces.volume) sum += v;
  CHECK(sum == Approx(signed_volume(model)).epsilon(1e-12));
  if (cut) *cut = std::move(made);
  return pieces;
}

bool closed(const std::vector<Vec3>& curve) { return curve.front() == curve.back(); }

}  // namespace

TEST_CASE("A disc in an image cuts a cylinder out", "[score][image]") {
  const TriangleMesh block = make_block({4, 2, 1}, 0.5);
  const GrayImage image = image_of(80, 80, disc(40, 40, 20));
  CutOutOptions options;
  options.tolerance = 0.02;
  // Inside: the image is 2 × 2 in the middle of the block, and the disc has the radius 0.5.
  const Pieces pieces = pieces_of(block, image, options);
  REQUIRE(pieces.count == 2);
  // The error of an outline within a fiftieth of a pixel, and of linear brightness, is below a
  // 500th of the radius of 20 pixels.
  CHECK(pieces.volume[1] == Approx(3.14159265 * 0.25).epsilon(0.004));
  options.fit = ImageFit::stretched;  // an ellipse, of half the width and height of the block
  CHECK(pieces_of(block, image, options).volume[1] == Approx(3.14159265 * 0.5).epsilon(0.004));
  for (const Vec3& axis : {Vec3(1, 0, 0), Vec3(0, -3, 0)}) {
    options.axis = axis;
    CHECK(pieces_of(block, image, options).volume[1] ==
          Approx(3.14159265 / 16 * 8).epsilon(0.004));  // a 16th of π of each block
  }
}

TEST_CASE("An image is seen from where its axis points, and is not mirrored", "[score][image]") {
  const TriangleMesh block = make_block({2, 1, 1}, 0.5);
  // Black in the upper right corner alone.
  const GrayImage image = image_of(40, 20, disc(35, 4, 2.5));
  const auto place = [&](const Vec3& axis, std::optional<Vec3> up) {
    CutOutOptions options;
    options.axis = axis;
    options.up = up;
    options.fit = ImageFit::stretched;
    Complex cut;
    const Pieces pieces = pieces_of(block, image, options, &cut);
    REQUIRE(pieces.count == 2);
    return bounding_box(piece_mesh(cut, pieces, 1)).center();
  };
  CHECK((place({0, 0, 1}, {}) - Vec3(1.75, 0.8, 0.5)).norm() < 0.01);
  CHECK((place({0, 0, -1}, {}) - Vec3(0.25, 0.8, 0.5)).norm() < 0.01);
  CHECK((place({0, -1, 0}, {}) - Vec3(1.75, 0.5, 0.8)).norm() < 0.01);
  CHECK((place({1, 0, 0}, {}) - Vec3(1, 0.875, 0.8)).norm() < 0.01);
  CHECK((place({1, 0, 0}, Vec3(0, 1, 0)) - Vec3(1, 0.8, 0.125)).norm() < 0.01);
}

TEST_CASE("Letters, islands and stripes make the right number of pieces", "[score][image]") {
  const TriangleMesh block = make_block({4, 2, 0.5}, 1);
  CutOutOptions options;
  options.fit = ImageFit::stretched;
  // An O and an I: two letters, the inside of the O, and what is around.
  const auto letters = [](double x, double y) {
    const double from_middle = std::hypot(x - 20, y - 20);
    const bool o = from_middle > 7 && from_middle<13, i = x> 50 && x < 58 && y > 6 && y < 34;
    return o || i ? 0.0 : 1.0;
  };
  CHECK(pieces_of(block, image_of(80, 40, letters), options).count == 4);
  // Stripes that meet the border of the image part the whole model, also beyond a smaller image.
  const auto stripe = [](double x, double y) { return std::abs(x - y) < 5.3 ? 0.0 : 1.0; };
  for (const ImageFit fit : {ImageFit::stretched, ImageFit::inside}) {
    options.fit = fit;
    CHECK(pieces_of(block, image_of(40, 40, stripe), options).count == 3);
  }
  // A chequerboard of 4 × 3: areas that meet in a corner join through it, or part there.
  const auto board = [](double x, double y) { return (int(x / 10) + int(y / 10)) % 2 ? 1.0 : 0.0; };
  CHECK(pieces_of(block, image_of(40, 30, board), options).count >= 7);
}

TEST_CASE("Outlines with edges on common lines are closed walls", "[score][image]") {
  // Points stay where they are; where the insertion displaced them, walls opened at a seam.
  const TriangleMesh plate = make_block({2, 1, 0.12}, 0.1);
  for (const double size : {4.0, 5.3, 6.5}) {
    const auto squares = [&](double x, double y) {
      const double u = std::abs(std::fmod(x, 10) - 5), v = std::abs(std::fmod(y, 10) - 5);
      return std::max(u, v) - size / 2 + 0.5;
    };
    const GrayImage image = image_of(120, 60, squares);
    const Pieces pieces = pieces_of(plate, image, {});
    REQUIRE(pieces.count == 73);
    // Squares of equal size, but for their corners, have equal volumes.
    CHECK(pieces.volume[1] == Approx(pieces.volume[72]).epsilon(1e-9));
  }
}

TEST_CASE("Outlines of random images do not meet", "[score][image]") {
  const auto [first, count] = seeds(12);
  for (int c = 0; c < count; ++c) {
    const auto seed = first + static_cast<std::uint64_t>(c);
    INFO("seed " << seed);
    Random random(seed);
    // Noise in which many pixels are exactly at the threshold, or smooth bumps.
    std::vector<float> values;
    for (int i = 0; i < 24 * 24; ++i) values.push_back(float(random.below(5)) / 4);
    GrayImage image{.width = 24, .height = 24, .brightness = values};
    if (seed % 2 == 0)
      image = image_of(48, 48, [&](double x, double y) {
        return 0.5 + 0.5 * std::sin(x * 0.3 + double(seed)) * std::cos(y * 0.4 + 0.1 * x);
      });
    CutOutOptions options;
    options.least_area = 0;
    options.tolerance = random.uniform(0, 3);
    const CutOut out = cut_out(image, {{0, 0, 0}, {1, 1, 1}}, options);
    std::vector<std::array<Vec3, 2>> segments;
    std::vector<std::pair<std::size_t, std::size_t>> name;
    for (std::size_t o = 0; o < out.curves.size(); ++o)
      for (std::size_t k = 0; k + 1 < out.curves[o].size(); ++k) {
        segments.push_back({out.curves[o][k], out.curves[o][k + 1]});
        name.push_back({o, k});
      }
    for (std::size_t s = 0; s < segments.size(); ++s)
      for (std::size_t t = 0; t < s; ++t) {
        const auto& [a, b] = segments[s];
        const auto& [p, q] = segments[t];
        if (a == p || a == q || b == p || b == q) {
          REQUIRE(name[s].first == name[t].first);  // neighbours in one outline
          continue;
        }
        const Box3 one{a.cwiseMin(b), a.cwiseMax(b)}, other{p.cwiseMin(q), p.cwiseMax(q)};
        const bool apart = !one.meets(other) || orient2d(a, b, p, 2) * orient2d(a, b, q, 2) > 0 ||
                           orient2d(p, q, a, 2) * orient2d(p, q, b, 2) > 0;
        REQUIRE(apart);
      }
    for (const auto& curve : out.curves) CHECK(curve.size() >= (closed(curve) ? 4u : 2u));
  }
}

TEST_CASE("Spots are left out, and images without sense are refused", "[score][image]") {
  const Box3 box{{0, 0, 0}, {1, 1, 1}};
  GrayImage image = image_of(30, 30, disc(15, 15, 8));
  image.brightness[0 * 30 + 3] = 0;    // at the border: a curve of its own
  image.brightness[3 * 30 + 3] = 0;    // a spot
  image.brightness[15 * 30 + 15] = 1;  // a hole
  const CutOut out = cut_out(image, box);
  CHECK(out.spots == 2);
  CHECK(out.curves.size() == 2);
  const auto refused = [&](const char* words, const GrayImage& of, auto change) {
    CutOutOptions options;
    change(options);
    CHECK_THROWS_WITH(cut_out(of, box, options), Catch::Contains(words));
  };
  const auto nothing = [](auto&) {};
  refused("no border", image_of(9, 9, [](double, double) { return 1; }), nothing);
  refused("two rows", image_of(9, 1, [](double x, double) { return x > 4; }), nothing);
  refused("more than 2 segments", image, [](auto& o) { o.max_segments = 2; });
  refused("threshold", image, [](auto& o) { o.threshold = 1; });
  refused("along its axis", image, [](auto& o) { o.up = Vec3(0, 0, 2); });
  refused("needs a length", image, [](auto& o) { o.axis = Vec3::Zero(); });
  image.brightness[7] = 2;
  refused("from 0, black", image, nothing);
  image.brightness.pop_back();
  refused("for each pixel", image, nothing);
}
