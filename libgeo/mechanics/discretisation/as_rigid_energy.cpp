// By the envelope theorem, the gradient is that for a fixed R. The Hessian is that of springs to
// the rotated offsets less what the best infinitesimal rotation takes: with r = R x_ij and torque
// τ = Σ k r × δ, the rotation is I⁻¹ τ with I = Σ k (|r|² 1 − r rᵀ).
#include "mechanics/discretisation/as_rigid_energy.h"

#include <Eigen/Eigenvalues>

#include "geometry/nearest_rotation.h"

namespace geo {
namespace {

// The inverse where moments of inertia are above rounding, zero about other axes.
Mat3 pseudo_inverse(const Mat3& inertia) {
  constexpr double rounding = 1e-9;  // of the largest moment
  const Eigen::SelfAdjointEigenSolver<Mat3> eigen(inertia);
  Vec3 inverse = Vec3::Zero();
  for (int a = 0; a < 3; ++a)
    if (eigen.eigenvalues()[a] > rounding * eigen.eigenvalues()[2]) inverse[a] = 1 / eigen.eigenvalues()[a];
  return eigen.eigenvectors() * inverse.asDiagonal() * eigen.eigenvectors().transpose();
}

}  // namespace

AsRigidEnergy::AsRigidEnergy(const NodalGradientOperator& gradients, const std::vector<double>& stiffness) {
  for (std::uint32_t i = 0; i < stiffness.size(); ++i) {
    const auto& node = gradients[i];
    if (!(stiffness[i] > 0) || node.neighbors.empty()) continue;
    Star star{.node = i, .begin = static_cast<std::uint32_t>(arms_.size()), .end = 0, .inverse_inertia = Mat3::Zero()};
    Mat3 inertia = Mat3::Zero();
    for (std::size_t q = 0; q < node.neighbors.size(); ++q) {
      const Vec3& x = node.offset[q];
      const double k = stiffness[i] * node.normalised_weight[q];
      arms_.push_back({.to = node.neighbors[q], .stiffness = k, .offset = x});
      inertia += k * (x.squaredNorm() * Mat3::Identity() - x * x.transpose());
    }
    star.end = static_cast<std::uint32_t>(arms_.size());
    star.inverse_inertia = pseudo_inverse(inertia);
    stars_.push_back(star);
  }
}

double AsRigidEnergy::energy(std::size_t k, const std::vector<Vec3>& u, Mat3& rotation) const {
  const Star& star = stars_[k];
  Mat3 fit = Mat3::Zero();
  for (const Arm& arm : arms(star))
    fit += arm.stiffness * (arm.offset + u[arm.to] - u[star.node]) * arm.offset.transpose();
  rotation = nearest_rotation(fit).rotation;
  double sum = 0;
  for (const Arm& arm : arms(star))
    sum += 0.5 * arm.stiffness * (arm.offset + u[arm.to] - u[star.node] - rotation * arm.offset).squaredNorm();
  return sum;
}

void AsRigidEnergy::add_force(std::size_t k, const std::vector<Vec3>& u, const Mat3& rotation,
                              std::vector<Vec3>& force) const {
  const Star& star = stars_[k];
  for (const Arm& arm : arms(star)) {
    const Vec3 pull = arm.stiffness * (arm.offset + u[arm.to] - u[star.node] - rotation * arm.offset);
    force[star.node] += pull;
    force[arm.to] -= pull;
  }
}

void AsRigidEnergy::add_product(std::size_t k, const Mat3& rotation, const std::vector<Vec3>& p,
                                std::vector<Vec3>& out) const {
  const Star& star = stars_[k];
  Vec3 torque = Vec3::Zero();  // at rest: all is turned back by R
  for (const Arm& arm : arms(star))
    torque += arm.stiffness * arm.offset.cross(Vec3(rotation.transpose() * (p[arm.to] - p[star.node])));
  const Vec3 turn = star.inverse_inertia * torque;
  for (const Arm& arm : arms(star)) {
    const Vec3 pull = arm.stiffness * (p[arm.to] - p[star.node] - rotation * turn.cross(arm.offset));
    out[arm.to] += pull;
    out[star.node] -= pull;
  }
}

void AsRigidEnergy::add_diagonal(std::vector<double>& diagonal) const {
  for (const Star& star : stars_)
    for (const Arm& arm : arms(star)) {
      diagonal[arm.to] += arm.stiffness;
      diagonal[star.node] += arm.stiffness;
    }
}

}  // namespace geo
