#include "mechanics/discretisation/shape_functions.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <limits>

namespace geo {

Sight sight(const Vec3& x, const Vec3& node, double reach) {
  const Vec3 away = x - node;
  const double distance = away.norm();
  return {node, distance, distance > 0 ? Vec3(away / distance) : Vec3(Vec3::Zero()), reach};
}

double shape_gradients(const Vec3& x, std::span<const Sight> nodes, std::vector<Vec3>& gradient) {
  using Vec4 = Eigen::Vector4d;
  using Mat4 = Eigen::Matrix4d;
  constexpr double singular = std::numeric_limits<double>::infinity();
  gradient.clear();
  const std::size_t n = nodes.size();
  if (n < 4) return singular;
  double scale = 0;
  for (const Sight& j : nodes) scale += j.reach;
  scale /= double(n);
  // In units of the scale and about x: p = (1, x_j − x), so that at x itself p is the first unit vector and ∂p_j = −∂x.
  std::vector<Vec4> p(n);
  std::vector<double> w(n);
  std::vector<Vec3> dw(n);
  Mat4 m = Mat4::Zero();
  for (std::size_t j = 0; j < n; ++j) {
    const double h = nodes[j].reach / scale, s = nodes[j].distance / nodes[j].reach;
    p[j] << 1, (nodes[j].node - x) / scale;
    w[j] = 1 + s * s * (-6 + s * (8 - 3 * s)), dw[j] = -12 * s * (1 - s) * (1 - s) / h * nodes[j].slope;  // ∂w/∂x
    m += w[j] * p[j] * p[j].transpose();
  }
  const Vec4 spread = Eigen::SelfAdjointEigenSolver<Mat4>(m, Eigen::EigenvaluesOnly).eigenvalues();
  if (!(spread[0] > 1e-12 * spread[3])) return singular;
  const Mat4 inverse = m.inverse();
  const Vec4 b = inverse.col(0);
  // ∂φ_j = bᵀp_j ∂w_j + w_j (bᵀ∂p_j + ∂bᵀp_j), with ∂b = −M⁻¹ ∂M b.
  Eigen::Matrix<double, 4, 3> mb = Eigen::Matrix<double, 4, 3>::Zero();
  for (std::size_t j = 0; j < n; ++j) {
    mb += b.dot(p[j]) * p[j] * dw[j].transpose();
    for (int a = 0; a < 3; ++a) mb(1 + a, a) -= w[j] * b.dot(p[j]), mb.col(a) -= w[j] * b[1 + a] * p[j];
  }
  const Eigen::Matrix<double, 4, 3> db = -(inverse * mb);
  gradient.resize(n);
  Vec3 sum = Vec3::Zero();
  for (std::size_t j = 0; j < n; ++j) {
    gradient[j] = (b.dot(p[j]) * dw[j] + w[j] * (db.transpose() * p[j] - b.tail<3>())) / scale;
    sum += gradient[j];
  }
  // Rounding leaves a sum of a few last places: constants are reproduced exactly.
  std::size_t heaviest = 0;
  for (std::size_t j = 1; j < n; ++j)
    if (w[j] > w[heaviest]) heaviest = j;
  gradient[heaviest] -= sum;
  return spread[3] / spread[0];
}

}  // namespace geo
