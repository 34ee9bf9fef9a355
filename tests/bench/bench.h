// Shared by the benchmarks: CPU time, the least of several runs, figures by name.
#pragma once

#include <algorithm>
#include <cmath>
#include <ctime>
#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace bench {

/// CPU seconds of this process.
inline double cpu_seconds() {
  timespec t{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return double(t.tv_sec) + 1e-9 * double(t.tv_nsec);
}

/// The least CPU time of some runs of `work`, each after an untimed `prepare`: at least three,
/// until a second is spent.
inline double least(const std::function<void()>& prepare, const std::function<void()>& work, int most = 15) {
  double best = 1e300, spent = 0;
  for (int i = 0; i < most && (i < 3 || spent < 1.0); ++i) {
    prepare();
    const double start = cpu_seconds();
    work();
    const double t = cpu_seconds() - start;
    best = std::min(best, t);
    spent += t;
  }
  return best;
}

/// How a time grows with a size: t ~ size^exponent, between two of them.
inline double growth(double time, double later, double size, double larger) {
  return std::log(later / time) / std::log(larger / size);
}

/// Wall-clock time of `work` on one thread over that on two, the best of some runs of each in turn,
/// with an untimed `prepare` before each. Leaves one thread.
double threads_speedup(
    const std::function<void()>& work, const std::function<void()>& prepare = [] {});

struct Options {
  std::vector<int> frequencies;     ///< of the pumpkin: 20 f² triangles
  std::vector<std::string> models;  ///< closed meshes in files
  std::vector<std::size_t> nodes;   ///< in the graph or the body
  int cuts = 500;                   ///< through the block
  bool scenes = true;               ///< simulation: the scenes of the samples, too
  bool json = false;
};

int crack(const Options& options);
int dataset(const Options& options);
int impact(const Options& options);
int fracture(const Options& options);
int block(const Options& options);
int graph(const Options& options);
int concave(const Options& options);
int contact(const Options& options);
int live(const Options& options);
int mechanics(const Options& options);
int python(const Options& options);  ///< where the module is built
int score(const Options& options);
int simulation(const Options& options);
int validate(const Options& options);
int wasm(const Options& options);  ///< after js/build --all-tests

/// Figures by name: one JSON object on a line, or a table.
using Figures = std::map<std::string, double>;
void print(const Figures& figures, bool json);

/// Runs scenes of the samples: frames a second without files, pairs of triangles that cross in any
/// frame, refused crack steps, crumbs.
void simulation_scenes(bool json, Figures& figures);

}  // namespace bench
