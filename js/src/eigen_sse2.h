// Comes before each source for WebAssembly. Eigen computes with SSE2, which Emscripten expresses in
// SIMD128: its sums then have the order, and so the bits, of an x86 build.
//
// Only Eigen is to see SSE2. Its assembler for x86, a hint to gcc, is left out: EIGEN_COMP_GNUC is 0.
#pragma once

#define EIGEN_MAX_STATIC_ALIGN_BYTES 16
#include <Eigen/src/Core/util/Macros.h>
#undef EIGEN_COMP_GNUC
#define EIGEN_COMP_GNUC 0
#define __asm__(...)
#include <Eigen/Core>
#undef __asm__
#undef __SSE__
#undef __SSE2__
