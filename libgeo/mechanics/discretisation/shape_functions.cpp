// Moving least squares with linear basis p and the quartic spline weight w(s), s = distance/support
// (Belytschko et al. 1996). The gradients are full derivatives, unlike the diffuse derivative of
// nodal_gradients.cpp.
#include "mechanics/discretisation/shape_functions.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <limits>

namespace geo {
namespace {

using Mat4 = Eigen::Matrix4d;

// An upper bound of the condition number of a positive definite matrix, from an approximate inverse
// with M X = 1 + E: |M⁻¹| ≤ |X| / (1 − |E|). Infinite where E is not small.
double condition_bound(const Mat4& m, const Mat4& inverse) {
  constexpr double small = 1e-3;
  const double error = (m * inverse - Mat4::Identity()).norm();
  return error < small ? m.norm() * inverse.norm() / (1 - error) : std::numeric_limits<double>::infinity();
}

}  // namespace

SupportNode direct_support(const Vec3& x, const Vec3& node, double support) {
  const Vec3 offset = x - node;
  const double distance = offset.norm();
  return {.position = node,
          .distance = distance,
          .distance_gradient = distance > 0 ? Vec3(offset / distance) : Vec3(Vec3::Zero()),
          .support = support};
}

double shape_gradients(const Vec3& x, std::span<const SupportNode> nodes, std::vector<Vec3>& gradient,
                       std::vector<double>* value, double enough) {
  using Vec4 = Eigen::Vector4d;
  constexpr double infinite = std::numeric_limits<double>::infinity();
  gradient.clear();
  if (value) value->clear();
  const std::size_t n = nodes.size();
  if (n < 4) return infinite;
  double scale = 0;
  for (const SupportNode& j : nodes) scale += j.support;
  scale /= double(n);
  // Lengths in units of the scale, coordinates relative to x: p_j = (1, x_j − x), so that
  // ∂p_j/∂x = (0; −I). At x itself p is the first unit vector e_1, whatever x is.
  std::vector<Vec4> p(n);
  std::vector<double> w(n);
  std::vector<Vec3> dw(n);  // ∂w/∂x
  Mat4 m = Mat4::Zero();
  for (std::size_t j = 0; j < n; ++j) {
    const double h = nodes[j].support / scale, s = nodes[j].distance / nodes[j].support;
    p[j] << 1, (nodes[j].position - x) / scale;
    // Quartic spline: w = 1 − 6 s² + 8 s³ − 3 s⁴, ∂w = −12 s (1 − s)² ∂s. (kernel.h is the kernel
    // of nodal gradients and of Eq. 1, not of these shape functions.)
    w[j] = 1 + s * s * (-6 + s * (8 - 3 * s));
    dw[j] = -12 * s * (1 - s) * (1 - s) / h * nodes[j].distance_gradient;
    m += w[j] * p[j] * p[j].transpose();
  }
  const Mat4 inverse = m.inverse();
  double condition = condition_bound(m, inverse);
  if (!(condition <= 0.99 * enough)) {  // with a margin for rounding
    // Condition numbers above 10¹² count as infinite; point_supports.cpp takes strain from none
    // above 10⁷.
    const Vec4 eigenvalues = Eigen::SelfAdjointEigenSolver<Mat4>(m, Eigen::EigenvaluesOnly).eigenvalues();
    if (!(eigenvalues[0] > 1e-12 * eigenvalues[3])) return infinite;
    condition = eigenvalues[3] / eigenvalues[0];
  }
  const Vec4 b = inverse.col(0);
  // ∂φ_j = bᵀp_j ∂w_j + w_j (bᵀ∂p_j + ∂bᵀp_j), with b = M⁻¹ e_1 and ∂b = −M⁻¹ ∂M b, where
  // ∂M = Σ ∂w_j p_j p_jᵀ + w_j (∂p_j p_jᵀ + p_j ∂p_jᵀ).
  Eigen::Matrix<double, 4, 3> dm_b = Eigen::Matrix<double, 4, 3>::Zero();  // ∂M b
  for (std::size_t j = 0; j < n; ++j) {
    dm_b += b.dot(p[j]) * p[j] * dw[j].transpose();
    for (int a = 0; a < 3; ++a) {
      dm_b(1 + a, a) -= w[j] * b.dot(p[j]);
      dm_b.col(a) -= w[j] * b[1 + a] * p[j];
    }
  }
  const Eigen::Matrix<double, 4, 3> db = -(inverse * dm_b);
  gradient.resize(n);
  Vec3 sum = Vec3::Zero();
  for (std::size_t j = 0; j < n; ++j) {
    gradient[j] = (b.dot(p[j]) * dw[j] + w[j] * (db.transpose() * p[j] - b.tail<3>())) / scale;
    sum += gradient[j];
  }
  // Constants are reproduced exactly: the node of the largest weight takes the rounding error of
  // the sum.
  std::size_t heaviest = 0;
  for (std::size_t j = 1; j < n; ++j)
    if (w[j] > w[heaviest]) heaviest = j;
  gradient[heaviest] -= sum;
  if (value)
    for (std::size_t j = 0; j < n; ++j) value->push_back(w[j] * b.dot(p[j]));
  return condition;
}

}  // namespace geo
