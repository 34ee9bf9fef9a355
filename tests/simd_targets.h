// The vector instructions that this machine has, each in turn.
#pragma once

#include <hwy/targets.h>

#include <cstdint>
#include <functional>
#include <vector>

/// From now on only these instructions are used, and slower ones that they include; 0: the best
/// there are.
inline void use_simd_target(std::int64_t target) {
  hwy::SetSupportedTargetsForTest(target);
  hwy::GetChosenTarget().Update(hwy::SupportedTargets());
}

/// Runs `check` on each kind of vectors that this machine has.
inline void for_each_simd_target(const std::function<void()>& check) {
  for (const auto target : hwy::SupportedAndGeneratedTargets()) {
    use_simd_target(target);
    check();
  }
  use_simd_target(0);
}
