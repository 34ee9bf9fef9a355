// Runs checks with each SIMD instruction set that kernels are compiled for and that this machine
// has.
#pragma once

#include "base/simd_targets.h"

#include <hwy/targets.h>

#include <cstdint>
#include <string>
#include <type_traits>

/// Restricts kernels to one instruction set and the baseline; 0: no restriction.
inline void use_simd_target(std::int64_t target) {
  hwy::SetSupportedTargetsForTest(target);
  hwy::GetChosenTarget().Update(hwy::SupportedTargets());
}

/// Calls check(), or check(name) if it takes a string, with each instruction set in turn.
template <class Check>
void for_each_simd_target(const Check& check) {
  for (const auto target : hwy::SupportedAndGeneratedTargets()) {
    use_simd_target(target);
    if constexpr (std::is_invocable_v<Check, std::string>)
      check(std::string(hwy::TargetName(target)));
    else
      check();
  }
  use_simd_target(0);
}
