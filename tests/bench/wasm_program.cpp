// The jobs of kerf-bench wasm as a program for Node: prints their seconds.
#include <cstdio>

#include "kerf/parallel.h"
#include "wasm_jobs.h"

int main() {
  geo::set_threads(1);
  const bench::WasmTimes times = bench::wasm_times();
  std::printf("%.9g %.9g %.9g\n", times.cut, times.score, times.step);
}
