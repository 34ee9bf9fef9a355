// kerf-bench break: impacts at run time. A model of about 10,000 triangles breaks near an impact
// into 20 pieces with hulls; once in one go, and in budgets of a frame.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>
#include <vector>

#include "bench.h"
#include "kerf/impact.h"
#include "kerf/mesh.h"
#include "kerf/parallel.h"

namespace bench {
namespace {

struct Row {
  std::size_t pieces = 0, hulls = 0;
  double whole = 1e300;          // ms, all at once: the least of the runs
  double worst = 0, budget = 0;  // ms: the longest call of all runs, and what it was given
  int calls = 0;                 // of the last run
  double volume_error = 0;       // of the pieces' sum
};

geo::ImpactOptions twenty_pieces() {
  geo::ImpactOptions options;
  options.toughness = 1e-6;  // so that the number of pieces is the limit
  options.max_pieces = 20;
  return options;
}

void take(Row& row, const geo::Breaking& breaking, double volume) {
  row.pieces = row.hulls = 0;
  double sum = 0;
  for (const geo::BrokenPart& part : breaking.parts()) {
    if (part.divided) continue;
    ++row.pieces;
    row.hulls += part.hulls.size();
    sum += part.solid.volume();
  }
  row.volume_error = std::max(row.volume_error, std::abs(sum / volume - 1));
}

Row measure(const geo::TriangleMesh& model, double budget_ms) {
  constexpr int runs = 15;
  const geo::Breakable solid(model);
  Row row;
  row.budget = budget_ms;
  for (int run = 0; run < runs; ++run) {
    const geo::Vec3& point = model.vertices[model.vertices.size() * std::size_t(run) / runs];
    const geo::Impact impact{point, -point, 1};
    geo::ImpactOptions options = twenty_pieces();
    options.seed = static_cast<std::uint64_t>(run) + 1;
    double start = cpu_seconds();
    const auto lap = [&] { return 1e3 * (cpu_seconds() - std::exchange(start, cpu_seconds())); };
    geo::Breaking at_once(solid, impact, options);
    at_once.advance(1e9);
    row.whole = std::min(row.whole, lap());
    take(row, at_once, solid.volume());
    geo::Breaking by_frames(solid, impact, options);
    row.calls = 0;
    for (bool finished = false; !finished; ++row.calls) {
      lap();
      finished = by_frames.advance(1e-3 * budget_ms);
      row.worst = std::max(row.worst, lap());
    }
    take(row, by_frames, solid.volume());
  }
  return row;
}

}  // namespace

int impact(const Options& options) {
  geo::set_threads(1);
  const std::pair<const char*, geo::TriangleMesh> models[] = {{"pumpkin", geo::make_pumpkin(22)},
                                                              {"letter R", geo::make_letter('R', 0.4, 38)},
                                                              {"block", geo::make_block(geo::Vec3(1, 1, 1), 0.035)}};
  Figures figures;
  if (!options.json)
    std::printf("one thread, milliseconds of its processor\n%-9s %9s %6s %5s | %8s | %6s %5s %6s | %s\n", "model",
                "triangles", "pieces", "hulls", "at once", "budget", "calls", "worst", "volume error");
  for (const auto& [name, model] : models)
    for (const double budget : {2.0, 8.0}) {
      const Row row = measure(model, budget);
      if (!options.json)
        std::printf("%-9s %9zu %6zu %5zu | %8.2f | %6.0f %5d %6.2f | %.1e\n", name, model.triangles.size(), row.pieces,
                    row.hulls, row.whole, row.budget, row.calls, row.worst, row.volume_error);
      const bool first = &model == &models[0].second;
      if (first && budget == 8) figures["break_10k_ms"] = row.whole;
      if (first) figures[budget == 8 ? "break_10k_worst_8ms" : "break_10k_worst_2ms"] = row.worst;
    }
  if (options.json) print(figures, true);
  return 0;
}

}  // namespace bench
