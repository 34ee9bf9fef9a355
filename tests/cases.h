// How many random cases a campaign runs, and which: KERF_CASES multiplies, KERF_SEED shifts,
// KERF_CASE picks one.
#pragma once

#include <cstdint>
#include <cstdlib>

inline int cases(int base) {
  const char* times = std::getenv("KERF_CASES");
  const int n = times ? std::atoi(times) : 1;
  return base * (n > 0 ? n : 1);
}

/// The seeds first, …, first + count − 1.
struct Seeds {
  std::uint64_t first = 1;
  int count = 0;
};
inline Seeds seeds(int base) {
  if (const char* only = std::getenv("KERF_CASE")) return {std::strtoull(only, nullptr, 10), 1};
  const char* shift = std::getenv("KERF_SEED");
  return {(shift ? std::strtoull(shift, nullptr, 10) * 1000000 : 0) + 1, cases(base)};
}
