// R = U diag(1, 1, det(U Vᵀ)) Vᵀ of the singular value decomposition U S Vᵀ (Kabsch 1976).
#include "geometry/nearest_rotation.h"

#include <Eigen/LU>
#include <Eigen/SVD>

namespace geo {

NearestRotation nearest_rotation(const Mat3& a) {
  const Eigen::JacobiSVD<Mat3> svd(a, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Mat3 sign = Vec3(1, 1, (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0 ? -1 : 1).asDiagonal();
  return {.rotation = svd.matrixU() * sign * svd.matrixV().transpose(),
          .singular_values = svd.singularValues(),
          .u = svd.matrixU(),
          .sign = sign,
          .v = svd.matrixV()};
}

}  // namespace geo
