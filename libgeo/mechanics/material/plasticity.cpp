// The inverse plastic stretch is found from the eigenvalues of 1 + 2 ε. The flow is one explicit
// step ε ← ε + min(1, c Δt) ε_e of the elastic strain ε_e, then scaled back to the largest norm.
#include "mechanics/material/plasticity.h"

#include <Eigen/Eigenvalues>
#include <algorithm>

namespace geo {

Mat3 inverse_plastic_stretch(const Mat3& plastic) {
  const Eigen::SelfAdjointEigenSolver<Mat3> eigen(Mat3::Identity() + 2 * plastic);
  return eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(0.01).cwiseSqrt().cwiseInverse().asDiagonal() *
         eigen.eigenvectors().transpose();
}

Mat3 plastic_flow(const Material& m, const Mat3& plastic, const Mat3& f, double dt) {
  const Mat3 elastic = 0.5 * (f.transpose() * f - Mat3::Identity()) - plastic;
  if (!(elastic.norm() > m.yield)) return plastic;
  const Mat3 next = plastic + std::min(1.0, m.creep * dt) * elastic;
  const double norm = next.norm();
  return norm > m.max_plastic ? Mat3(m.max_plastic / norm * next) : next;
}

}  // namespace geo
