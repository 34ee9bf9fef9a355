// Blades where doubles resolve noise, and blades in cuts that are there already.
#include <catch2/catch.hpp>

#include <algorithm>

#include "kerf/check.h"
#include "kerf/contact.h"
#include "kerf/files.h"
#include "kerf/mesh.h"
#include "kerf/pieces.h"
#include "kerf/simulation.h"

using namespace geo;

namespace {

struct Outcome {
  std::vector<double> volumes;  // of the pieces, ascending
  std::size_t crossings = 0, crumbs = 0, refused = 0, cut = 0;
  double energy = 0;  // the largest of a frame, J
};

// A block of edge 2 about `middle`, cut by blades with these lines of TOML; 24 frames a second.
Outcome cut_block(const std::string& blades, int frames, const Vec3& middle = Vec3::Zero(),
                  const std::string& gravity = "[0, 0, 0]") {
  TriangleMesh block = make_block({2, 2, 2}, 0.5);
  for (Vec3& p : block.vertices) p += middle - Vec3(1, 1, 1);
  const Scene scene =
      parse_scene("gravity = " + gravity +
                      "\n[body]\nmesh = 'a'\nnodes = 300\n[material]\nyoung = 2e5\n[contact]\nself = true\n" + blades,
                  "s.toml");
  Simulation sim(scene, block);
  Outcome outcome;
  FrameStats total;
  for (int f = 0; f < frames; ++f) {
    const FrameStats stats = sim.advance_frame();
    total += stats;
    outcome.crossings += count_crossings(sim.surface());
    outcome.energy = std::max(outcome.energy, stats.energy);
  }
  CHECK(check_complex(sim.body().surface, SelfIntersections::find).good());
  outcome.volumes = find_pieces(sim.body().surface).volume;
  std::sort(outcome.volumes.begin(), outcome.volumes.end());
  outcome.crumbs = total.sheet.crumbs;
  outcome.refused = total.refused;
  outcome.cut = total.split.crack.triangles_cut;
  return outcome;
}

// A blade along y at x, which moves through heights z at the times of `way`.
std::string blade(double x, const std::vector<std::pair<double, double>>& way) {
  char text[256];
  std::snprintf(text, sizeof text, "[[blade]]\npoints = [[%.17g, -3, 0], [%.17g, 3, 0]]\ndivide = 12\nkeys = [", x, x);
  std::string keys;
  for (const auto& [time, z] : way) {
    char key[128];
    std::snprintf(key, sizeof key, "%s[%g, 0, 0, %g, 0, 0, 1, 0]", keys.empty() ? "" : ", ", time, z);
    keys += key;
  }
  return text + keys + "]\n";
}

void check_halves(const Outcome& o, double lower_share, double accuracy = 2e-3) {
  REQUIRE(o.volumes.size() == 2);
  CHECK(o.volumes[0] == Approx(8 * lower_share).epsilon(accuracy));
  CHECK(o.crossings == 0);
  CHECK(o.crumbs == 0);
}

}  // namespace

TEST_CASE("a blade through zero cuts as one beside it") {
  const Outcome beside = cut_block(
      "[[blade]]\npoints = [[1, -3, 0], [1, 3, 0]]\ndivide = 12\n"
      "keys = [[0, 0, 0, 2, 0, 0, 1, 0], [0.5, 0, 0, -2, 0, 0, 1, 0]]\n",
      14, {1, 0, 0});
  check_halves(beside, 0.5);
  for (const double x : {0.0, 1e-17, -1e-17, 1e-30, -1e-300, 1e-6}) {
    INFO("blade at x = " << x);
    const Outcome o = cut_block(blade(x, {{0, 2}, {0.5, -2}}), 14);
    check_halves(o, 0.5);
    CHECK(o.refused == 0);
    CHECK(o.energy < 1e-9);
    CHECK(o.cut <= 2 * beside.cut);
  }
}

TEST_CASE("a blade in a face of a body at rest cuts nothing") {
  for (const double x : {1.0, -1.0}) {
    const Outcome o = cut_block(blade(x, {{0, 2}, {0.5, -2}}), 14);
    CHECK(o.volumes.size() == 1);
    CHECK(o.crossings == 0);
    CHECK(o.energy < 1e-9);
  }
}

TEST_CASE("sawing: out and in again through one's own cut") {
  const std::string ground = "[ground]\npoint = [0, 0, -1]\n";
  const Outcome once =
      cut_block(ground + blade(0.026, {{0, 2}, {0.6, 0}, {1.2, -2}}), 34, Vec3::Zero(), "[0, 0, -9.81]");
  check_halves(once, 0.487, 0.01);
  const Outcome often =
      cut_block(ground + blade(0.026, {{0, 2}, {0.3, 0}, {0.6, 2}, {0.9, -2}, {1.1, 2}, {1.3, -2}, {1.4, 0.3}}), 34,
                Vec3::Zero(), "[0, 0, -9.81]");
  check_halves(often, 0.487, 0.01);
  CHECK(often.refused == 0);
  CHECK(often.cut < 2 * once.cut);
}

TEST_CASE("six strokes of six blades through one plane are one cut") {
  std::string strokes;
  for (int s = 0; s < 6; ++s)
    strokes += blade(0.1, {{0.05 + 0.2 * s, s % 2 ? -2 : 2}, {0.22 + 0.2 * s, s % 2 ? 2 : -2}});
  const Outcome o = cut_block(strokes, 32);
  check_halves(o, 0.45);
  CHECK(o.refused == 0);
}

TEST_CASE("a cut that another blade has begun is finished without a bridge") {
  // The first blade stops half way. The second comes through its cut, and goes on.
  const Outcome o = cut_block(blade(0.1, {{0, 2}, {0.3, 0.13}}) + blade(0.1, {{0.4, 2}, {0.8, -2}}), 22);
  check_halves(o, 0.45);
  // The second comes from below, and meets the first cut.
  const Outcome met = cut_block(blade(0.1, {{0, 2}, {0.3, 0.13}}) + blade(0.1, {{0.4, -2}, {0.8, 2}}), 22);
  check_halves(met, 0.45);
}

TEST_CASE("a cut across another one is whole") {
  const std::string across =
      "[[blade]]\npoints = [[-3, 0.2, 0], [3, 0.2, 0]]\ndivide = 12\n"
      "keys = [[0.6, 0, 0, 2, 0, 0, 1, 0], [1, 0, 0, -2, 0, 0, 1, 0]]\n";
  const Outcome o = cut_block(blade(0.1, {{0, 2}, {0.4, -2}}) + across, 28);
  REQUIRE(o.volumes.size() == 4);
  CHECK(o.volumes[0] == Approx(0.9 * 0.8 * 2).epsilon(0.01));
  CHECK(o.volumes[3] == Approx(1.1 * 1.2 * 2).epsilon(0.01));
  CHECK(o.crossings == 0);
}

TEST_CASE("a thin slice beside a cut comes off") {
  // An eighth of the node spacing is more than the twentieth that counts as the same cut.
  const Outcome o = cut_block(blade(0, {{0, 2}, {0.4, -2}}) + blade(0.04, {{0.6, 2}, {1, -2}}), 28);
  REQUIRE(o.volumes.size() == 3);
  CHECK(o.volumes[0] == Approx(0.04 * 4).epsilon(0.05));
  CHECK(o.crossings == 0);
}
