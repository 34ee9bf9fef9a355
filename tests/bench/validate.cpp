#include <cstdio>

#include "bench.h"
#include "mechanics/validation.h"

namespace bench {

// The table of docs/validation.md.
int validate(const Options&) {
  using namespace validation;
  std::printf("| case | formula | measured | expected | error | bound |\n|---|---|---|---|---|---|\n");
  bool good = true;
  for (const auto& run : {rigid_motion, patch, tension, cantilever, frequency, free_fall, spin, slit_bar, notched_bar,
                          hertz, brazilian_disk, energy_at_cuts, standing, sliding, stacking})
    for (const Finding& f : run(1)) {
      const std::string error = f.absolute ? "" : std::to_string(100 * f.error()).substr(0, 4) + " %";
      const std::string bound = f.absolute ? std::to_string(f.bound) : std::to_string(int(100 * f.bound + 0.5)) + " %";
      char small[32];
      std::snprintf(small, sizeof small, "%.0e", f.bound);
      std::printf("| %s | %s | %.4g | %.4g | %s | %s |\n", f.what.c_str(), f.formula.c_str(), f.measured, f.expected,
                  error.c_str(), f.absolute ? small : bound.c_str());
      std::fflush(stdout);
      good &= f.good();
    }
  return good ? 0 : 1;
}

}  // namespace bench
