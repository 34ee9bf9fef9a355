// Bodies with random cuts.
#pragma once

#include <catch2/catch.hpp>
#include <functional>

#include "invariants/random_cuts.h"
#include "kerf/body.h"

namespace random_cuts {

/// Cuts copies of a body twice each, in one step or in twelve. `look` sees the body after every
/// step that cut something, `finish` when it is done.
inline void cut_bodies(
    const geo::Body& model, int count, std::uint64_t stream, const std::function<void(const geo::Body&)>& look,
    const std::function<void(const geo::Body&)>& finish = [](const geo::Body&) {}) {
  for (int c = 0; c < cases(count); ++c) {
    const auto seed = static_cast<std::uint64_t>(c) + 1;
    geo::Random random(seed * stream);
    geo::Body body = model;
    for (std::int32_t crack = 1; crack <= 2; ++crack) {
      const auto cut = make_cut(model.surface.extent(), random);
      const int steps = random.below(2) == 0 ? 1 : 12;
      auto front = geo::begin_front(cut.at(0), false, crack);
      for (int s = 1; s <= steps; ++s) {
        INFO("seed " << seed << ", crack " << crack << ", step " << s << " of " << steps);
        if (!split(body, front, cut.at(double(s) / steps)).crack.empty()) look(body);
      }
    }
    finish(body);
  }
}

}  // namespace random_cuts
