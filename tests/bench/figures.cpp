#include <cstdio>
#include <iostream>

#include "bench.h"
#include "kerf/parallel.h"
#include "kerf/progress.h"

namespace bench {

double threads_speedup(const std::function<void()>& work, const std::function<void()>& prepare) {
  double best[2] = {1e300, 1e300};
  double spent = 0;
  for (int run = 0; run < 10 || (run < 100 && spent < 4) || run % 2 == 1; ++run) {
    geo::set_threads(run % 2 + 1);
    prepare();
    geo::Stopwatch watch;
    work();
    const double took = watch.lap();
    best[run % 2] = std::min(best[run % 2], took);
    spent += took;
  }
  geo::set_threads(1);
  return best[0] / best[1];
}

void print(const Figures& figures, bool json) {
  if (!json) {
    for (const auto& [key, value] : figures) std::printf("%-34s %.4g\n", key.c_str(), value);
    return;
  }
  std::cout << '{';
  bool first = true;
  for (const auto& [key, value] : figures) {
    std::cout << (first ? "" : ",") << '"' << key << "\":" << value;
    first = false;
  }
  std::cout << "}\n";
}

}  // namespace bench
