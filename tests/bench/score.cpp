// Prescoring: a pumpkin and an apple into 30 and 200 jagged Voronoi pieces, with their meshes and
// convex hulls. Seconds are CPU time on one thread, wall-clock time on all.
#include <algorithm>
#include <cstdio>

#include "bench.h"
#include "kerf/crack.h"
#include "kerf/mesh.h"
#include "kerf/parallel.h"
#include "kerf/pieces.h"
#include "kerf/progress.h"
#include "kerf/score.h"

namespace bench {
namespace {

constexpr int runs = 5;
constexpr std::size_t hull_corners = 64;

// Seconds of the phases, the least of some runs each.
struct Row {
  double score = 1e300, crack = 1e300, pieces = 1e300, hulls = 1e300;
  std::uint32_t count = 0;
  std::size_t walls = 0;
  int attempts = 0;
  double total() const { return score + crack + pieces; }
};

Row measure(const geo::TriangleMesh& model, int pieces) {
  const geo::Complex skin = geo::Complex::from_skin(model);
  geo::ScoreOptions options;
  options.pattern.pattern = geo::Pattern::voronoi;
  options.pattern.seed = options.jagged.seed = 7;
  options.pieces = pieces;
  options.jagged.amplitude = 0.02;
  Row row;
  geo::Stopwatch watch;
  double last = 0;
  const auto lower = [&](double& least_yet) {
    const double wall = watch.lap(), cpu = cpu_seconds();
    least_yet = std::min(least_yet, geo::threads() == 1 ? cpu - last : wall);
    last = cpu;
  };
  for (int run = 0; run < runs; ++run) {
    geo::Complex cut = skin;
    watch.lap();
    last = cpu_seconds();
    const geo::Score score = geo::make_score(skin, options);
    lower(row.score);
    geo::insert_sheet(cut, score.sheet, 1);
    lower(row.crack);
    const geo::Pieces found = geo::find_pieces(cut);
    const auto chunks = geo::make_chunks(cut, found, model, 0.25 * cut.extent().diagonal());
    lower(row.pieces);
    geo::parallel_for(chunks.size(), 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t p = begin; p < end; ++p) geo::convex_decomposition(chunks[p].mesh, 1, hull_corners);
    });
    lower(row.hulls);
    row.count = found.count;
    row.walls = score.sheet.triangles.size();
    row.attempts = score.attempts;
  }
  return row;
}

}  // namespace

int score(const Options& options) {
  const int frequency = options.frequencies.front();
  const std::pair<const char*, geo::TriangleMesh> models[] = {{"pumpkin", geo::make_pumpkin(frequency)},
                                                              {"apple", geo::make_apple(frequency)}};
  Figures figures;
  if (!options.json)
    std::printf("seconds; %d triangles\n%-8s %7s %7s %7s %8s | %6s %6s %6s %6s | %6s\n", 20 * frequency * frequency,
                "model", "threads", "pieces", "walls", "attempts", "score", "crack", "pieces", "hulls", "all");
  for (const auto& [name, model] : models)
    for (const int pieces : {30, 200})
      for (const int threads : {1, 0}) {
        geo::set_threads(threads);
        const Row row = measure(model, pieces);
        const std::string key =
            std::string("_") + name + "_" + std::to_string(pieces) + (threads == 1 ? "_1thread" : "_all_threads");
        figures["score" + key] = row.score;
        figures["crack" + key] = row.crack;
        figures["pieces" + key] = row.pieces;
        figures["hulls" + key] = row.hulls;
        figures["seconds" + key] = row.total();
        if (!options.json)
          std::printf("%-8s %7d %7u %7zu %8d | %6.3f %6.3f %6.3f %6.3f | %6.3f\n", name, geo::threads(), row.count,
                      row.walls, row.attempts, row.score, row.crack, row.pieces, row.hulls, row.total());
      }
  geo::set_threads(1);
  if (options.json) print(figures, true);
  return 0;
}

}  // namespace bench
