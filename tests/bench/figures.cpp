#include <cstdio>
#include <iostream>

#include "base/parallel.h"
#include "base/stopwatch.h"
#include "bench.h"

namespace bench {

double threads_speedup(const std::function<void()>& work) {
  double best[2] = {1e300, 1e300};
  for (int run = 0; run < 10; ++run) {
    geo::set_threads(run % 2 + 1);
    geo::Stopwatch watch;
    work();
    best[run % 2] = std::min(best[run % 2], watch.lap());
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
  for (const auto& [key, value] : figures) std::cout << (first ? "" : ",") << '"' << key << "\":" << value, first = false;
  std::cout << "}\n";
}

}  // namespace bench
