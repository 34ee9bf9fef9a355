// Elasticity sees F V P⁻¹, V the prestretch and P the plastic stretch. It is isotropic, so that a
// rotation on the right does not count: the left stretch of V P⁻¹ stands for it.
#include "mechanics/solver/relaxation.h"

#include <Eigen/Eigenvalues>

#include "mechanics/material/plasticity.h"

namespace geo {

Mat3 PointRelaxation::at(std::size_t point) const {
  Mat3 m = Mat3::Identity();
  for (int c = 0; c < 3 && !empty(); ++c) m.col(c) = Eigen::Map<const Vec3>(&matrix.column[c][4 * point]);
  return m;
}

Mat3 left_stretch(const Mat3& f) {
  const Eigen::SelfAdjointEigenSolver<Mat3> eigen(f * f.transpose());
  return eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(0).cwiseSqrt().asDiagonal() *
         eigen.eigenvectors().transpose();
}

PointRelaxation relaxation_of(const MaterialPoints& points, std::size_t block, const State& state) {
  PointRelaxation result;
  const bool flown = !state.plastic.empty(), stretched = !state.prestretch.empty();
  if (!flown && !stretched) return result;
  const std::size_t count = points.blocks[block].points.size(), first = points.first_point(block);
  result.matrix.resize(count);
  if (stretched) result.share.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    Mat3 matrix = flown ? inverse_plastic_stretch(state.plastic[first + i]) : Mat3(Mat3::Identity());
    if (stretched) {
      const Mat3& own = state.prestretch[first + i];
      result.share[i] = 1 / own.determinant();
      matrix = flown ? left_stretch(own * matrix) : own;
    }
    for (int c = 0; c < 3; ++c) Eigen::Map<Vec3>(&result.matrix.column[c][4 * i]) = matrix.col(c);
  }
  return result;
}

}  // namespace geo
