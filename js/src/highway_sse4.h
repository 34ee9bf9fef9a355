// Comes before each source for WebAssembly. Highway computes with SSE4, which Emscripten expresses
// in SIMD128: its own vectors for WebAssembly lack doubles, and its emulation is plain loops.
//
// Sums then have the order of an x86 processor without fused products. Highway is told that the
// architecture is x86. Names of instruction sets, which clang refuses for WebAssembly, are left out.
#pragma once

#pragma push_macro("__EMSCRIPTEN__")
#pragma push_macro("__wasm__")
#undef __EMSCRIPTEN__
#undef __wasm__
#define __x86_64__ 1
#include <hwy/detect_compiler_arch.h>
#undef __x86_64__
#pragma pop_macro("__wasm__")
#pragma pop_macro("__EMSCRIPTEN__")

// Emscripten's headers ask for these; nothing else is to see them.
#define __SSE__ 1
#define __SSE2__ 1
#define __SSE3__ 1
#define __SSSE3__ 1
#define __SSE4_1__ 1
#define __SSE4_2__ 1
#include <nmmintrin.h>
#undef __SSE__
#undef __SSE2__
#undef __SSE3__
#undef __SSSE3__
#undef __SSE4_1__
#undef __SSE4_2__

// Better translations than Emscripten's of what kernels use most. Results are x86's, with its order
// of operands: the second one where neither is less, and for NaN.
static inline __m128d kerf_min_pd(__m128d a, __m128d b) { return (__m128d)wasm_f64x2_pmin((v128_t)b, (v128_t)a); }
static inline __m128d kerf_max_pd(__m128d a, __m128d b) { return (__m128d)wasm_f64x2_pmax((v128_t)b, (v128_t)a); }
static inline __m128 kerf_min_ps(__m128 a, __m128 b) { return (__m128)wasm_f32x4_pmin((v128_t)b, (v128_t)a); }
static inline __m128 kerf_max_ps(__m128 a, __m128 b) { return (__m128)wasm_f32x4_pmax((v128_t)b, (v128_t)a); }
// clang 14 joins this conversion with one to float, and converts each lane by itself, unless the
// value between them is hidden from it.
static inline __m128i kerf_cvtepi16_epi32(__m128i a) {
  v128_t wide = wasm_i32x4_extend_low_i16x8((v128_t)a);
  __asm__("" : "+r"(wide));
  return (__m128i)wide;
}
// Numbers without an integer become the least one. Emscripten converts each lane by itself.
static inline __m128i kerf_cvttps_epi32(__m128 a) {
  const v128_t fits = wasm_f32x4_lt((v128_t)a, wasm_f32x4_splat(0x1p31f));
  return (__m128i)wasm_v128_bitselect(wasm_i32x4_trunc_sat_f32x4((v128_t)a), wasm_i32x4_splat(-0x7fffffff - 1), fits);
}
static inline __m128i kerf_cvtps_epi32(__m128 a) { return kerf_cvttps_epi32((__m128)wasm_f32x4_nearest((v128_t)a)); }
#define _mm_cvttps_epi32 kerf_cvttps_epi32
#define _mm_cvtps_epi32 kerf_cvtps_epi32
#define _mm_min_pd kerf_min_pd
#define _mm_max_pd kerf_max_pd
#define _mm_min_ps kerf_min_ps
#define _mm_max_ps kerf_max_ps
#define _mm_cvtepi16_epi32 kerf_cvtepi16_epi32

#define HWY_BASELINE_TARGETS HWY_SSE4
#define HWY_COMPILE_ONLY_STATIC
#define HWY_DISABLE_PCLMUL_AES
#define HWY_DISABLE_CACHE_CONTROL
#include <hwy/base.h>
#undef HWY_PUSH_ATTRIBUTES
#undef HWY_POP_ATTRIBUTES
#define HWY_PUSH_ATTRIBUTES(names)
#define HWY_POP_ATTRIBUTES
#undef HWY_HAS_ATTRIBUTE
#define HWY_HAS_ATTRIBUTE(name) 0
