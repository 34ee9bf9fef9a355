// How many random cases a campaign runs: KERF_CASES multiplies it.
#pragma once

#include <cstdlib>

inline int cases(int base) {
  const char* times = std::getenv("KERF_CASES");
  const int n = times ? std::atoi(times) : 1;
  return base * (n > 0 ? n : 1);
}
