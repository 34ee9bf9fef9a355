// Test-case reduction: removes parts of a failing case while it still fails.
#pragma once

#include <cmath>
#include <functional>

#include "crack/grid_case.h"

/// Reduces a case greedily by dropping cracks, steps and points, and by simplify(case, attempt), as
/// long as any of these succeeds. attempt(simpler) replaces the case where the simpler one fails,
/// too, and returns whether it did; simplify() returns whether any attempt succeeded. Precondition:
/// `small` fails.
template <class Case, class Simplify>
Case shrink(Case small, const std::function<bool(const Case&)>& fails, const Simplify& simplify) {
  const auto attempt = [&](const Case& smaller) {
    if (!fails(smaller)) return false;
    small = smaller;
    return true;
  };
  const auto drop_cracks = [&] {
    bool any = false;
    for (std::size_t c = small.cracks.size(); c-- > 0 && small.cracks.size() > 1;) {
      Case smaller = small;
      smaller.cracks.erase(smaller.cracks.begin() + static_cast<std::ptrdiff_t>(c));
      any |= attempt(smaller);
    }
    return any;
  };
  const auto drop_steps = [&] {
    bool any = false;
    for (std::size_t c = 0; c < small.cracks.size(); ++c)
      for (std::size_t s = small.cracks[c].rows.size(); s-- > 0 && small.cracks[c].rows.size() > 2;) {
        Case smaller = small;
        smaller.cracks[c].rows.erase(smaller.cracks[c].rows.begin() + static_cast<std::ptrdiff_t>(s));
        any |= attempt(smaller);
      }
    return any;
  };
  const auto drop_points = [&] {
    bool any = false;
    for (std::size_t c = 0; c < small.cracks.size(); ++c) {
      const std::size_t least = small.cracks[c].closed ? 3 : 2;
      for (std::size_t p = small.cracks[c].rows[0].size(); p-- > 0 && small.cracks[c].rows[0].size() > least;) {
        Case smaller = small;
        for (auto& row : smaller.cracks[c].rows) row.erase(row.begin() + static_cast<std::ptrdiff_t>(p));
        any |= attempt(smaller);
      }
    }
    return any;
  };
  for (bool any = true; any;) {
    any = drop_cracks();
    any |= drop_steps();
    any |= drop_points();
    any |= simplify(small, attempt);
  }
  return small;
}

/// Also undoes subdivision and moves coordinates towards small integers.
inline GridCase shrink(GridCase given, const std::function<bool(const GridCase&)>& fails) {
  const auto simplify = [](const GridCase& grid, const auto& attempt) {
    bool any = false;
    if (grid.divisions > 1) {
      GridCase smaller = grid;
      smaller.divisions = 1;
      any |= attempt(smaller);
    }
    for (std::size_t c = 0; c < grid.cracks.size(); ++c) {
      if (grid.cracks[c].closed) {
        GridCase smaller = grid;
        smaller.cracks[c].closed = false;
        any |= attempt(smaller);
      }
      for (std::size_t s = 0; s < grid.cracks[c].rows.size(); ++s)
        for (std::size_t p = 0; p < grid.cracks[c].rows[s].size(); ++p)
          for (int axis = 0; axis < 3; ++axis) {
            const double x = grid.cracks[c].rows[s][p][axis];
            // Each is smaller than x, or an integer where x is none: the loop terminates.
            for (const double y : {0.0, std::trunc(x / 2), std::trunc(x), x - (x > 0 ? 1.0 : -1.0)}) {
              if (!(std::abs(y) < std::abs(x))) continue;
              GridCase smaller = grid;
              smaller.cracks[c].rows[s][p][axis] = y;
              if (attempt(smaller)) {
                any = true;
                break;
              }
            }
          }
    }
    return any;
  };
  return shrink<GridCase>(std::move(given), fails, simplify);
}
