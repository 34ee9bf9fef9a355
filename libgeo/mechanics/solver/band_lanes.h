// Inner loops of BandCholesky in vectors: six rows at a time, so that shared operands are read
// once. Results are the same for every vector width.
#pragma once

#include <cstddef>

namespace geo {

/// Numbers that the functions here may read, and may add zeros to, beyond the end of a row.
constexpr std::size_t band_padding = 16;

/// Forward substitution of six rows, `stride` apart, by the factor of the diagonal tile: for i from
/// 0 to 5, row[i] = (row[i] − Σ_{k<i} upper[6 k + i] row[k]) · inverse[i], over n columns.
void eliminate_six(std::size_t n, std::size_t stride, const float* upper, const float* inverse, float* rows);
/// rows[i] −= Σ_k factor[6 i + k] other[k] for six rows, over n columns.
void subtract_six(std::size_t n, const float* factor, std::size_t other_stride, const float* other, std::size_t stride,
                  float* rows);
/// x −= Σ_k factor[k] rows[k] over six rows and n columns.
void subtract_rows(std::size_t n, const float* factor, std::size_t stride, const float* rows, float* x);
/// out[k] = rows[k] · x for six rows of n columns.
void dot_rows(std::size_t n, std::size_t stride, const float* rows, const float* x, float* out);

}  // namespace geo
