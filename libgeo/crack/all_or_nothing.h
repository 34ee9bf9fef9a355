// Edits of a whole complex that the caller may interrupt.
#pragma once

#include <span>
#include <vector>

#include "kerf/crack.h"

namespace geo::crack {

/// Runs `edit`. Where it throws Interrupted, complex and fronts are as before. Copies them only
/// where there is someone to interrupt it.
template <class Edit>
CrackDelta all_or_nothing(Complex& complex, std::span<FrontState* const> fronts, const Progress& progress,
                          const Edit& edit) {
  if (!progress) return edit();
  const Complex before = complex;
  std::vector<FrontState> fronts_before;
  for (const FrontState* front : fronts) fronts_before.push_back(*front);
  try {
    return edit();
  } catch (const Interrupted&) {
    complex = before;
    for (std::size_t f = 0; f < fronts.size(); ++f) *fronts[f] = fronts_before[f];
    throw;
  }
}

}  // namespace geo::crack
