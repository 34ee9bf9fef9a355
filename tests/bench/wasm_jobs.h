// The jobs of kerf-bench wasm, natively and in WebAssembly: seconds of each on one thread.
#pragma once

#include <algorithm>
#include <chrono>
#include <functional>
#include <vector>

#include "kerf/complex.h"
#include "kerf/crack.h"
#include "kerf/files.h"
#include "kerf/mesh.h"
#include "kerf/score.h"
#include "kerf/simulation.h"

namespace bench {

struct WasmTimes {
  double cut = 1e300;    ///< a front through a pumpkin of 9,680 triangles, 20 steps
  double score = 1e300;  ///< a jagged pattern of 20 pieces for it, and the cut along it
  double step = 1e300;   ///< the second frame of a falling block of 400 nodes, with self-contact
};

inline void cut_once(const geo::TriangleMesh& model) {
  geo::Complex complex = geo::Complex::from_skin(model);
  const auto line = [](double y) {
    std::vector<geo::Vec3> points;
    for (int i = 0; i <= 16; ++i) {
      const double x = -1.6 + 0.2 * i;
      points.push_back({x, y, 0.1 * x * (1.2 - x) + 0.05 * y * x});
    }
    return points;
  };
  geo::FrontState front = geo::begin_front(line(-1.5), false, 1);
  for (int i = 1; i <= 20; ++i) geo::advance(complex, front, line(-1.5 + 0.15 * i));
}

inline void score_once(const geo::TriangleMesh& model) {
  geo::Complex complex = geo::Complex::from_skin(model);
  geo::ScoreOptions options;
  options.pattern.seed = options.jagged.seed = 7;
  options.jagged.amplitude = 0.02;
  options.attempts = 4;
  geo::insert_sheet(complex, geo::make_score(complex, options).sheet, 1);
}

/// Measures each job several times, and keeps the least.
inline WasmTimes wasm_times() {
  const auto seconds = [](const std::function<void()>& work) {
    const auto begin = std::chrono::steady_clock::now();
    work();
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  };
  const geo::TriangleMesh pumpkin = geo::make_pumpkin(22), block = geo::make_block({1, 1, 1}, 0.12);
  const geo::Scene scene = geo::parse_scene(
      "[body]\nmesh = \"block\"\nnodes = 400\n[material]\nyoung = 2e5\n[ground]\npoint = [0, 0, -0.1]\n"
      "[contact]\nself = true\n",
      "scene");
  WasmTimes least;
  for (int run = 0; run < 5; ++run) {
    least.cut = std::min(least.cut, seconds([&] { cut_once(pumpkin); }));
    least.score = std::min(least.score, seconds([&] { score_once(pumpkin); }));
    geo::Simulation simulation(scene, geo::place_models(scene, {block}));
    simulation.advance_frame();
    least.step = std::min(least.step, seconds([&] { simulation.advance_frame(); }));
  }
  return least;
}

}  // namespace bench
