// What a scene computes does not depend on where it is: at the origin, where doubles resolve noise,
// beside it, mirrored, with axes exchanged, larger or smaller.
// A campaign: KERF_CASES=60 KERF_SEED=3 test_simulation '[placements]'; one case: KERF_CASE=3000123.
#include <catch2/catch.hpp>

#include <algorithm>
#include <cstdio>
#include <iostream>
#include <optional>

#include "cases.h"
#include "kerf/check.h"
#include "kerf/contact.h"
#include "kerf/pieces.h"
#include "kerf/simulation.h"
#include "simulation/placed_scene.h"

using namespace geo;

namespace {

// What does not depend on the place of a scene, lengths in units of its scale.
struct Outcome {
  std::vector<double> volumes;  // of pieces, descending, over that of all
  std::size_t crumbs = 0, crossings = 0, refused = 0;
  double energy = 0;  // largest elastic energy of a frame, over Young's modulus and volume
  std::size_t work = 0;  // Newton steps and triangles cut
};

Outcome run(const CutScene& cut) {
  Simulation sim(cut.scene, cut.models);
  Outcome outcome;
  FrameStats total;
  for (int f = 0; f < cut.scene.frames; ++f) {
    const FrameStats stats = sim.advance_frame();
    total += stats;
    outcome.crossings += count_crossings(sim.surface());
    outcome.energy = std::max(outcome.energy, stats.energy);
  }
  outcome.refused = total.refused;
  outcome.work = total.newton + total.split.crack.triangles_cut;
  CHECK(check_complex(sim.body().surface, true).good());
  const Pieces pieces = find_pieces(sim.body().surface);
  double all = 0;
  for (const double v : pieces.volume) all += v;
  for (const double v : pieces.volume) outcome.volumes.push_back(v / all);
  std::sort(outcome.volumes.rbegin(), outcome.volumes.rend());
  outcome.crumbs = total.sheet.crumbs;
  outcome.energy /= cut.scene.material.young * all;
  return outcome;
}

// Whether two lists of volumes are of the same pieces. The nodes of a mirrored model are elsewhere,
// so it is deformed otherwise while it is cut: by less than a hundredth of its size. Pieces that
// are smaller than that in each direction may be in one list alone, but no specks of rounding.
bool are_same_pieces(const std::vector<double>& a, const std::vector<double>& b) {
  constexpr double same = 0.02;
  constexpr double small = 1e-5;
  constexpr double speck = 1e-9;
  for (std::size_t i = 0; i < std::max(a.size(), b.size()); ++i) {
    const double va = i < a.size() ? a[i] : 0, vb = i < b.size() ? b[i] : 0;
    const double least = std::min(va, vb), most = std::max(va, vb);
    if (most - least > same || (least == 0 && most > small) || (least < speck && most > 3 * least)) return false;
  }
  return true;
}

std::string told(const Outcome& o) {
  std::string text = std::to_string(o.volumes.size()) + " pieces (";
  char number[32];
  for (const double v : o.volumes) {
    std::snprintf(number, sizeof number, "%.4g ", v);
    text += number;
  }
  return text + "), " + std::to_string(o.crumbs) + " crumbs, " + std::to_string(o.crossings) + " crossings, " +
         std::to_string(o.refused) + " refused, energy " + std::to_string(1e6 * o.energy) + "e-6, work " +
         std::to_string(o.work);
}

}  // namespace

TEST_CASE("what a scene computes does not depend on its place", "[placements]") {
  const Seeds all = seeds(24);
  const auto ways = placements();
  std::optional<std::uint64_t> scene;  // that `here` is of
  Outcome here;
  for (std::uint64_t seed = all.first; seed < all.first + static_cast<std::uint64_t>(all.count); ++seed) {
    const CutScene cut = random_cut_scene(seed / ways.size());
    const CutScene moved = placed(cut, ways[seed % ways.size()]);
    INFO("KERF_CASE=" << seed << ": " << moved.about);
    if (scene != seed / ways.size()) here = run(cut);
    scene = seed / ways.size();
    const Outcome there = run(moved);
    INFO("here:  " << told(here) << "\nthere: " << told(there));
    if (std::getenv("KERF_TELL")) std::cout << seed << " " << moved.about << "\n   " << told(here) << "\n   " << told(there) << std::endl;
    CHECK(here.crossings == 0);
    CHECK(there.crossings == 0);
    CHECK(are_same_pieces(here.volumes, there.volumes));
    CHECK(there.energy == Approx(here.energy).epsilon(0.5).margin(1e-9));
    CHECK(double(there.work) < 2 * double(here.work));
    CHECK(double(here.work) < 2 * double(there.work));
  }
}
