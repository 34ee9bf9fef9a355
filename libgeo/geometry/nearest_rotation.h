// The rotation that is nearest to a matrix.
#pragma once

#include "kerf/vec.h"

namespace geo {

/// The rotation nearest to a matrix, and the matrix's singular values.
struct NearestRotation {
  Mat3 rotation;         ///< nearest in the Frobenius norm; determinant 1
  Vec3 singular_values;  ///< descending; the rotation is unique if the second one is positive
  Mat3 u, sign, v;       ///< its factors: the rotation is u · sign · vᵀ, sign a diagonal of 1, 1, ±1
};

/// Solves the orthogonal Procrustes problem by a singular value decomposition A = U Σ Vᵀ: the
/// rotation is U diag(1, 1, ±1) Vᵀ with the sign that excludes a reflection.
NearestRotation nearest_rotation(const Mat3& a);

}  // namespace geo
