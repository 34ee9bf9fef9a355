// ω_k = (a_k · L) / I_k along each principal axis a_k with moment I_k > least_moment, else 0.
#include "geometry/principal_inertia.h"

#include <Eigen/Eigenvalues>

namespace geo {

PrincipalInertia::PrincipalInertia(const Mat3& inertia) {
  const Eigen::SelfAdjointEigenSolver<Mat3> eigen(inertia);
  axes = eigen.eigenvectors();
  moments = eigen.eigenvalues();
}

Vec3 PrincipalInertia::angular_velocity(const Vec3& momentum, double least_moment) const {
  const Vec3 components = axes.transpose() * momentum;
  Vec3 velocity = Vec3::Zero();
  for (int k = 0; k < 3; ++k)
    if (moments[k] > least_moment) velocity[k] = components[k] / moments[k];
  return velocity;
}

}  // namespace geo
