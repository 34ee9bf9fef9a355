// Invariants 4 to 7 of the design on real models with nodes, cut at random.
#include <catch2/catch.hpp>
#include <cstdlib>

#include <numeric>

#include "base/parallel.h"
#include "body/body.h"
#include "invariants/models.h"
#include "invariants/random_cuts.h"
#include "sampling/sample.h"

using namespace geo;

namespace {

double total(const std::vector<double>& v) { return std::accumulate(v.begin(), v.end(), 0.0); }

void campaign(const std::string& name, int bodies) {
  const auto mesh = invariants::model(name);
  SampleOptions sampling;
  sampling.spacing = 0.06 * bounding_box(mesh).diagonal();
  const Body model = build_body(Complex::from_skin(mesh), sample_nodes(mesh, sampling));
  REQUIRE(check_body(model).first_problem == "");
  const double volume = total(find_pieces(model.surface).volume);
  CHECK(total(model.nodes.volume) == Approx(volume).epsilon(1e-9));
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  const int count = random_cuts::cases(bodies) / 5;  // each costs several times as much here
#else
  const int count = random_cuts::cases(bodies);
#endif
  for (int c = 0; c < count; ++c) {
    const auto seed = static_cast<std::uint64_t>(c) + 1;
    INFO(name << ", seed " << seed);
    if (const char* only = std::getenv("KERF_SEED"); only && std::strtoull(only, nullptr, 10) != seed) continue;
    Random random(seed * 104729);
    const auto cut = random_cuts::make_cut(model.surface.extent(), random);
    const int steps = c % 2 == 0 ? 1 : 12;
    const auto run = [&](bool check) {
      Body body = model;
      auto front = begin_front(cut.at(0), false, 1);
      for (int s = 1; s <= steps; ++s) {
        const auto delta = split(body, front, cut.at(double(s) / steps));
        if (!check || delta.crack.empty() || (s % 4 != 0 && steps > 1)) continue;
        INFO("step " << s << " of " << steps);
        CHECK(check_body(body).first_problem == "");
        CHECK(total(body.nodes.volume) == Approx(volume).epsilon(1e-9));
        CHECK(*std::min_element(body.nodes.volume.begin(), body.nodes.volume.end()) > 0);
      }
      return body;
    };
    set_threads(2);
    const Body two = run(true);
    if (c % 5 != 0) continue;
    set_threads(1);
    const Body one = run(false);
    CHECK(one.nodes.position == two.nodes.position);
    CHECK(one.neighbors == two.neighbors);
    CHECK(one.binding == two.binding);
  }
  set_threads(0);
}

}  // namespace

TEST_CASE("Cut bodies keep step: bear", "[bodies]") { campaign("bear", 20); }
TEST_CASE("Cut bodies keep step: elephant", "[bodies]") { campaign("elephant", 200); }
TEST_CASE("Cut bodies keep step: dino", "[bodies]") { campaign("dino", 200); }
TEST_CASE("Cut bodies keep step: hand", "[bodies]") { campaign("hand", 200); }
TEST_CASE("Cut bodies keep step: femur", "[bodies]") { campaign("femur", 200); }
TEST_CASE("Cut bodies keep step: pumpkin", "[bodies]") { campaign("pumpkin", 200); }
