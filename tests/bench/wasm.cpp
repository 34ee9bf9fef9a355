// kerf-bench wasm: the same jobs natively, on one thread, and in WebAssembly, by Node. js/build
// makes the program of tests/bench/wasm_program.cpp.
#include "wasm_jobs.h"

#include <array>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "bench.h"
#include "kerf/error.h"
#include "kerf/parallel.h"

namespace bench {
namespace {

WasmTimes by_node(const std::string& program) {
  if (FILE* const file = std::fopen(program.c_str(), "r"))
    std::fclose(file);
  else
    throw geo::MissingInputError(program + ": is not there; make it by js/build --all-tests");
  FILE* const pipe = popen(("node --no-experimental-fetch '" + program + "'").c_str(), "r");
  WasmTimes times;
  const bool read = pipe && std::fscanf(pipe, "%lf %lf %lf", &times.cut, &times.score, &times.step) == 3;
  if (!pipe || pclose(pipe) != 0 || !read) throw geo::InputError(program + ": node cannot run it");
  return times;
}

}  // namespace

int wasm(const Options& options) {
  geo::set_threads(1);
  const WasmTimes native = wasm_times(), wasm = by_node(KERF_WASM_PROGRAM);
  if (!options.json) {
    std::printf("one thread, milliseconds\n%-6s | %8s | %8s | %s\n", "job", "native", "wasm", "ratio");
    const std::array<std::array<double, 2>, 3> rows{
        {{native.cut, wasm.cut}, {native.score, wasm.score}, {native.step, wasm.step}}};
    const char* const names[] = {"cut", "score", "step"};
    for (std::size_t i = 0; i < 3; ++i)
      std::printf("%-6s | %8.2f | %8.2f | %.2f\n", names[i], 1e3 * rows[i][0], 1e3 * rows[i][1],
                  rows[i][1] / rows[i][0]);
    return 0;
  }
  print({{"cut_ratio", wasm.cut / native.cut},
         {"score_ratio", wasm.score / native.score},
         {"step_ratio", wasm.step / native.step}},
        true);
  return 0;
}

}  // namespace bench
