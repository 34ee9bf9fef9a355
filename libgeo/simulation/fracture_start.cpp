#include "simulation/fracture_start.h"

#include <Eigen/Eigenvalues>
#include <Eigen/SVD>
#include <algorithm>

#include "base/parallel.h"
#include "geometry/distance.h"
#include "mechanics/kernel.h"

namespace geo {
namespace {

bool near_crack(const Complex& complex, const Vec3& x, double reach) {
  std::vector<FaceId> near;
  complex.near(Box3{x, x}.grown(reach), near);
  return std::any_of(near.begin(), near.end(), [&](FaceId f) {
    if (complex.face(f).crack == 0) return false;
    const auto t = complex.corners(f);
    return (closest_point_on_triangle(x, t[0], t[1], t[2]) - x).norm() < reach;
  });
}

}  // namespace

std::vector<Mat3> averaged_stress(const Body& body, const std::vector<Mat3>& gradient, const Material& material) {
  const std::size_t n = body.nodes.size();
  std::vector<Mat3> own(n), mean(n);
  parallel_for(n, 64, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Mat3 f = Mat3::Identity() + gradient[i];
      const double volume = f.determinant();
      own[i].setZero();
      if (!(volume > 0.01) || body.debris[i]) continue;  // inside out, or rigid: nothing to tell
      const Eigen::JacobiSVD<Mat3> svd(f, Eigen::ComputeFullU | Eigen::ComputeFullV);
      const Mat3 rotation = svd.matrixU() * svd.matrixV().transpose();
      own[i] = rotation.transpose() * stress(material, f) * f.transpose() * rotation / volume;
    }
  });
  parallel_for(n, 64, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      double total = kernel(0, 1.0);
      mean[i] = total * own[i];
      for (const auto& neighbor : body.graph.neighbors(body.nodes, NodeId(i))) {
        const double w = kernel(neighbor.distance / body.nodes.radius[i], 1.0);
        total += w;
        mean[i] += w * own[neighbor.to.index()];
      }
      mean[i] /= total;
    }
  });
  return mean;
}

std::vector<CrackStart> find_starts(const Body& body, const std::vector<Mat3>& stress, const Fracture& fracture, std::size_t most) {
  const double diagonal = body.surface.extent().diagonal();
  std::vector<CrackStart> over;
  for (std::size_t i = 0; i < stress.size(); ++i) {
    const Vec3& x = body.nodes.position[i];
    const double strength = fracture.strength * strength_factor(fracture, diagonal, x);
    // No eigenvalue is larger than the norm: most nodes need no decomposition.
    if (stress[i].norm() <= strength || !may_break(fracture, x)) continue;
    const Eigen::SelfAdjointEigenSolver<Mat3> eigen(stress[i]);
    if (eigen.eigenvalues()[2] > strength) over.push_back({NodeId(i), eigen.eigenvectors().col(2), eigen.eigenvalues()[2] / strength});
  }
  std::sort(over.begin(), over.end(), [](const CrackStart& a, const CrackStart& b) { return a.share != b.share ? a.share > b.share : a.node < b.node; });
  std::vector<CrackStart> starts;
  for (const CrackStart& s : over) {
    if (starts.size() == most) break;
    const Vec3& x = body.nodes.position[s.node.index()];
    const double reach = fracture.apart * body.nodes.spacing[s.node.index()];
    if (near_crack(body.surface, x, reach)) continue;
    const bool alone = std::none_of(starts.begin(), starts.end(), [&](const CrackStart& o) { return (body.nodes.position[o.node.index()] - x).norm() < reach; });
    if (alone) starts.push_back(s);
  }
  return starts;
}

}  // namespace geo
