// Stress in material axes: Rᵀ (P Fᵀ / J) R with the polar rotation R = U Vᵀ, averaged at nodes.
// Starts are then taken greedily by falling ratio of principal stress to strength.
#include "simulation/fracture_start.h"

#include <Eigen/Eigenvalues>
#include <Eigen/SVD>
#include <algorithm>

#include "geometry/distance.h"
#include "mechanics/solver/nodal_averages.h"
#include "simulation/strength.h"

namespace geo {
namespace {

// The triangles of all cracks. A search in the complex would visit the skin, which is far larger.
class CrackTriangles {
 public:
  explicit CrackTriangles(const Complex& complex) {
    for (std::uint32_t f = 0; f < complex.face_count(); ++f)
      if (complex.alive(FaceId(f)) && complex.face(FaceId(f)).crack != 0)
        triangles_.push_back(complex.corners(FaceId(f)));
  }
  bool within(const Vec3& x, double reach) const {
    return std::any_of(triangles_.begin(), triangles_.end(), [&](const std::array<Vec3, 3>& t) {
      const Box3 box = box_of(t[0], t[1], t[2]).grown(reach);
      return box.meets({x, x}) && (closest_point_on_triangle(x, t[0], t[1], t[2]) - x).norm() < reach;
    });
  }

 private:
  std::vector<std::array<Vec3, 3>> triangles_;
};

}  // namespace

// Points below a hundredth of their volume, or inverted, are left out.
std::vector<Mat3> averaged_stress(const Body& body, const Solid& solid, const State& motion) {
  const auto sums =
      nodal_stress_sums(solid, body.nodes, motion,
                        [](const Material& material, const Mat3& all, const Mat3& elastic, std::array<double, 6>& out) {
                          if (!(all.determinant() > 0.01)) return false;
                          const Eigen::JacobiSVD<Mat3> svd(all, Eigen::ComputeFullU | Eigen::ComputeFullV);
                          const Mat3 rotation = svd.matrixU() * svd.matrixV().transpose();
                          const Mat3 s = rotation.transpose() * stress(material, elastic) * elastic.transpose() *
                                         rotation / elastic.determinant();
                          out = {s(0, 0), s(1, 1), s(2, 2), s(0, 1), s(1, 2), s(2, 0)};
                          return true;
                        });
  std::vector<Mat3> mean(body.nodes.size(), Mat3::Zero());
  for (std::size_t i = 0; i < sums.size(); ++i) {
    const StressSums& s = sums[i];
    if (!(s[6] > 0)) continue;
    mean[i] << s[0], s[3], s[5], s[3], s[1], s[4], s[5], s[4], s[2];
    mean[i] /= s[6];
  }
  return mean;
}

std::vector<CrackStart> find_starts(const Body& body, const std::vector<Mat3>& stress, const FractureOptions& fracture,
                                    const std::vector<std::uint32_t>& body_index, std::size_t limit) {
  const double diagonal = body.surface.extent().diagonal();
  std::vector<CrackStart> over;
  for (std::size_t i = 0; i < stress.size(); ++i) {
    const Vec3& x = body.nodes.position[i];
    const Breakage& own = fracture.at_node(body_index, i);
    if (!own.has_fronts()) continue;
    const double strength = own.strength * strength_factor(own, fracture.seed, diagonal, x);
    // The norm bounds the eigenvalues: few nodes need a decomposition.
    if (stress[i].norm() <= strength || !may_break(fracture, x)) continue;
    const Eigen::SelfAdjointEigenSolver<Mat3> eigen(stress[i]);
    if (eigen.eigenvalues()[2] > strength)
      over.push_back({NodeId(i), eigen.eigenvectors().col(2), eigen.eigenvalues()[2] / strength});
  }
  std::sort(over.begin(), over.end(), [](const CrackStart& a, const CrackStart& b) {
    return a.ratio != b.ratio ? a.ratio > b.ratio : a.node < b.node;
  });
  std::vector<CrackStart> starts;
  if (over.empty() || limit == 0) return starts;
  const CrackTriangles cracks(body.surface);
  for (const CrackStart& s : over) {
    if (starts.size() == limit) break;
    const Vec3& x = body.nodes.position[s.node.index()];
    const double reach = fracture.separation * body.nodes.spacing[s.node.index()];
    if (cracks.within(x, reach)) continue;
    const bool alone = std::none_of(starts.begin(), starts.end(), [&](const CrackStart& o) {
      return (body.nodes.position[o.node.index()] - x).norm() < reach;
    });
    if (alone) starts.push_back(s);
  }
  return starts;
}

}  // namespace geo
