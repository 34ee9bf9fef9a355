// The instruction sets for which SIMD kernels are compiled. A source with kernels includes this
// before any header of Highway.
//
// foreach_target.h includes the source that HWY_TARGET_INCLUDE names again for each instruction
// set. Code between HWY_BEFORE_NAMESPACE and HWY_AFTER_NAMESPACE is compiled each time. Types
// before it need an include guard (KERF_..._ONCE). Code under HWY_ONCE is compiled once; it calls
// the best set that the processor has, by HWY_DYNAMIC_DISPATCH.
//
// A kernel without MulAdd gives the same results for every set: -ffp-contract=off
// (cmake/modules.cmake) forbids the compiler to fuse products and sums. With MulAdd, sets that lack
// the fused operation differ by rounding (docs/decisions/053). Tests run each set by
// use_simd_target() (tests/simd_targets.h).
#pragma once

// Excluded are scalable vectors, which arrays and structures cannot hold, and AVX3_DL. Highway
// makes the latter only where -march=... demands it, and it adds nothing to AVX3 that the kernels
// use. Without this definition Highway excludes none.
#define HWY_DISABLED_TARGETS (HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV | HWY_AVX3_DL)
