#include "simulation/fracture_start.h"

#include <Eigen/Eigenvalues>
#include <Eigen/SVD>
#include <algorithm>

#include "base/parallel.h"
#include "geometry/distance.h"
#include "mechanics/kernel.h"
#include "mechanics/plasticity.h"

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

std::vector<Mat3> averaged_stress(const Body& body, const Solid& solid, const State& motion) {
  const MaterialPoints& points = solid.points();
  constexpr std::size_t width = 7;  // six stresses and their weight
  std::vector<double> parts(width * points.parts(), 0);
  parallel_for(points.blocks.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t b = begin; b < end; ++b) {
      const PointBlock& block = points.blocks[b];
      const std::vector<Mat3> gradient = points.gradients(b, motion.displacement);
      for (std::size_t i = 0; i < block.points.size(); ++i) {
        const MaterialPoint& p = block.points[i];
        Mat3 f = Mat3::Identity() + gradient[i];
        if (p.rung == Rung::rigid || !(f.determinant() > 0.01)) continue;
        const Eigen::JacobiSVD<Mat3> svd(f, Eigen::ComputeFullU | Eigen::ComputeFullV);
        const Mat3 rotation = svd.matrixU() * svd.matrixV().transpose();
        if (!motion.plastic.empty()) f = f * relaxation(motion.plastic[points.first(b) + i]);
        const Mat3 s = rotation.transpose() * stress(solid.material(), f) * f.transpose() * rotation / f.determinant();
        for (std::size_t q = block.first[i]; q < block.first[i + 1]; ++q) {
          const auto node = block.nodes[block.to[q]];
          const double w = p.volume * kernel((p.position - body.nodes.position[node]).norm() / body.nodes.radius[node], 1.0);
          double* sum = &parts[width * (points.part(b) + block.to[q])];
          for (const double c : {s(0, 0), s(1, 1), s(2, 2), s(0, 1), s(1, 2), s(2, 0)}) *sum++ += w * c;
          *sum += w;
        }
      }
    }
  });
  std::vector<Mat3> mean(body.nodes.size(), Mat3::Zero());
  points.gather(parts.data(), width, [&](std::size_t i, const double* s) {
    if (s[6] > 0) mean[i] << s[0], s[3], s[5], s[3], s[1], s[4], s[5], s[4], s[2];
    if (s[6] > 0) mean[i] /= s[6];
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
