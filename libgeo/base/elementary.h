// Elementary functions with the same bits in every C library; glibc and Emscripten's musl differ.
// They use sums, products, quotients and roots alone, which IEEE 754 defines. Errors: below 0.8 ulp
// of sine(), cosine(), cube_root(); below 4 of the others.
#pragma once

namespace geo {

/// The sine of x, in radians. From 2²⁰ radians on, that of the C library.
double sine(double x);
/// The cosine of x, likewise.
double cosine(double x);
/// The angle of (x, y) from the x axis, −π to π; 0 at the origin.
double angle_of(double y, double x);
/// The angle from 0 to π whose cosine is x, for x from −1 to 1.
double arc_cosine(double x);
/// eˣ
double exponential(double x);
/// The natural logarithm of x > 0.
double logarithm(double x);
/// The cube root of x.
double cube_root(double x);

}  // namespace geo
