// The inner loops of BandFactor, in vectors: six rows at a time, so that what they share is read once.
#pragma once

#include <cstddef>

namespace geo {

/// Numbers that may be read, and added zeros to, behind the end of all rows here.
constexpr std::size_t band_room = 16;

/// Of six rows beside each other, `stride` apart: row[i] = (row[i] − Σ upper[6 k + i] row[k]) · inverse[i], k < i, one
/// after another.
void eliminate_six(std::size_t n, std::size_t stride, const float* upper, const float* inverse, float* rows);
/// row[i] −= Σ by[6 i + k] of[k] for six rows each.
void subtract_six(std::size_t n, const float* by, std::size_t stride_of, const float* of, std::size_t stride,
                  float* rows);
/// x −= Σ by[k] row[k]
void subtract_rows(std::size_t n, const float* by, std::size_t stride, const float* rows, float* x);
/// out[k] = Σ row[k] x, in an order that does not depend on the vectors' width.
void dot_rows(std::size_t n, std::size_t stride, const float* rows, const float* x, float* out);

}  // namespace geo
