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
