// The instruction sets for which SIMD kernels are compiled. Include this before Highway's
// foreach_target.h. Sources with a part between HWY_BEFORE_NAMESPACE and HWY_AFTER_NAMESPACE are
// compiled once for each instruction set; the best one that the processor has is chosen at run
// time.
#pragma once

// Excluded are scalable vectors, which arrays and structures cannot hold, and AVX3_DL, which adds
// nothing to AVX3 that the kernels use.
#define HWY_DISABLED_TARGETS (HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV | HWY_AVX3_DL)
