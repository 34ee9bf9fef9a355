// Invariants 1 to 3 of the design on real models, cut at random.
#include <catch2/catch.hpp>

#include "invariants/models.h"
#include "invariants/random_cuts.h"

using namespace geo;

namespace {

// Invariant 1, and 2 with `crossings`, on the complex as it is.
Pieces require_whole(const Complex& k, bool crossings, double volume, double area) {
  const auto report = check_complex(k, crossings ? SelfIntersections::find : SelfIntersections::ignore);
  CHECK(report.first_problem == "");
  if (crossings) CHECK(report.self_intersections.value_or(1) == 0);
  const Pieces pieces = find_pieces(k);
  double sum = 0;
  for (const double v : pieces.volume) {
    CHECK(v > 0);
    sum += v;
  }
  CHECK(sum == Approx(volume).epsilon(1e-12));
  CHECK(random_cuts::skin_area(k) == Approx(area).epsilon(1e-12));
  // Every vertex of the derived surface stands on a vertex of K, to the bit.
  const auto mesh = k.two_sided();
  bool collocated = true;
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i)
    collocated = collocated && mesh.vertices[i] == k.point(VertexId(mesh.site[i]));
  CHECK(collocated);
  return pieces;
}

void cut_through(Complex& k, const random_cuts::Cut& cut, int steps, std::int32_t crack) {
  auto front = begin_front(cut.at(0), false, crack);
  for (int s = 1; s <= steps; ++s) advance(k, front, cut.at(double(s) / steps));
}

void campaign(const std::string& name) {
  const Complex model = Complex::from_skin(invariants::model(name));
  const auto before = find_pieces(model);
  double volume = 0;
  for (const double v : before.volume) volume += v;
  const double area = random_cuts::skin_area(model);
  const int count = random_cuts::cases(100);
  for (int c = 0; c < count; ++c) {
    const auto seed = static_cast<std::uint64_t>(c) + 1;
    INFO(name << ", seed " << seed);
    Random random(seed * 7919);
    Complex at_once = model, slowly = model, very_slowly = model;
    std::uint32_t pieces = before.count;
    for (std::int32_t crack = 1; crack <= 2; ++crack) {
      const auto cut = random_cuts::make_cut(model.extent(), random);
      INFO("crack " << crack << (cut.complete ? ", complete" : ", partial"));
      REQUIRE_NOTHROW(cut_through(at_once, cut, 1, crack));
      REQUIRE_NOTHROW(cut_through(slowly, cut, 12, crack));
      // A crossing that the first crack makes is still there after the second.
      const auto one = require_whole(at_once, crack == 2, volume, area);
      const auto twelve = require_whole(slowly, crack == 2, volume, area);
      if (c % 10 == 0) {
        REQUIRE_NOTHROW(cut_through(very_slowly, cut, 200, crack));
        const auto many = require_whole(very_slowly, crack == 2, volume, area);
        REQUIRE(many.count == one.count);
        for (std::size_t p = 0; p < one.count; ++p) CHECK(std::abs(one.volume[p] - many.volume[p]) <= 1e-9 * volume);
      }
      CHECK(one.count >= pieces);
      pieces = one.count;
      REQUIRE(one.count == twelve.count);
      for (std::size_t p = 0; p < one.count; ++p) CHECK(std::abs(one.volume[p] - twelve.volume[p]) <= 1e-9 * volume);
    }
  }
}

}  // namespace

TEST_CASE("Cut surfaces stay whole: bear", "[surfaces]") { campaign("bear"); }
TEST_CASE("Cut surfaces stay whole: elephant", "[surfaces]") { campaign("elephant"); }
TEST_CASE("Cut surfaces stay whole: dino", "[surfaces]") { campaign("dino"); }
TEST_CASE("Cut surfaces stay whole: hand", "[surfaces]") { campaign("hand"); }
TEST_CASE("Cut surfaces stay whole: femur", "[surfaces]") { campaign("femur"); }
TEST_CASE("Cut surfaces stay whole: pumpkin", "[surfaces]") { campaign("pumpkin"); }
