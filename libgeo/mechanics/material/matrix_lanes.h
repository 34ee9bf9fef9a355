// 3×3 matrices of several points in vector registers, one lane per point. For sources that Highway
// compiles once per vector target: they include this file after Highway.
#if defined(KERF_MATRIX_LANES) == defined(HWY_TARGET_TOGGLE)  // an include guard per target
#ifdef KERF_MATRIX_LANES
#undef KERF_MATRIX_LANES
#else
#define KERF_MATRIX_LANES
#endif

#include <cstddef>

/// Opens the namespace of one vector target.
HWY_BEFORE_NAMESPACE();
namespace geo::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// At most eight lanes.
template <class Number>
using Lanes = hn::CappedTag<Number, 8>;
/// A vector of Lanes.
template <class Number>
using V = hn::Vec<Lanes<Number>>;
/// The number of lanes.
template <class Number>
constexpr std::size_t width = hn::MaxLanes(Lanes<Number>());

/// One 3×3 matrix per lane.
template <class Number>
struct Matrix {
  V<Number> at[3][3];  ///< [column][row]
};

/// The matrices of points i, i + 1, … from the columns of PointMatrices.
template <class Number>
HWY_INLINE Matrix<Number> load(const Number* const* columns, std::size_t i) {
  Matrix<Number> m;
  V<Number> unused;
  for (std::size_t c = 0; c < 3; ++c)
    hn::LoadInterleaved4(Lanes<Number>(), columns[c] + 4 * i, m.at[c][0], m.at[c][1], m.at[c][2], unused);
  return m;
}
/// Writes the matrices of points i, i + 1, … to the columns of PointMatrices.
template <class Number>
HWY_INLINE void store(const Matrix<Number>& m, Number* const* columns, std::size_t i) {
  const Lanes<Number> d;
  for (std::size_t c = 0; c < 3; ++c)
    hn::StoreInterleaved4(m.at[c][0], m.at[c][1], m.at[c][2], hn::Zero(d), d, columns[c] + 4 * i);
}

/// The dot product of two 3-vectors.
template <class Vector>
HWY_INLINE Vector dot3(const Vector* a, const Vector* b) {
  return hn::Add(hn::Add(hn::Mul(a[0], b[0]), hn::Mul(a[1], b[1])), hn::Mul(a[2], b[2]));
}
/// The matrix product a · b.
template <class Number>
HWY_INLINE Matrix<Number> product(const Matrix<Number>& a, const Matrix<Number>& b) {
  Matrix<Number> m;
  for (int c = 0; c < 3; ++c)
    for (int r = 0; r < 3; ++r)
      m.at[c][r] = hn::Add(hn::Add(hn::Mul(a.at[0][r], b.at[c][0]), hn::Mul(a.at[1][r], b.at[c][1])),
                           hn::Mul(a.at[2][r], b.at[c][2]));
  return m;
}
/// The transpose.
template <class Number>
HWY_INLINE Matrix<Number> transposed(const Matrix<Number>& m) {
  Matrix<Number> t;
  for (int c = 0; c < 3; ++c)
    for (int r = 0; r < 3; ++r) t.at[c][r] = m.at[r][c];
  return t;
}

}  // namespace geo::HWY_NAMESPACE
/// Closes it.
HWY_AFTER_NAMESPACE();

#endif
