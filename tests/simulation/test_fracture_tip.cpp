// The stress field at a crack tip, fitted to nodes that move as linear elasticity predicts.
#include <catch2/catch.hpp>

#include <numbers>

#include "cases.h"
#include "simulation/fracture_tip.h"
#include "simulation/notched_block.h"

using namespace geo;

namespace {

constexpr double degree = std::numbers::pi / 180;

// Every node moved by a uniform gradient, the modes with intensities k about the line (depth,
// height), and a rotation.
std::vector<Vec3> moved(const Body& body, const Material& material, const Vec3& k, const Mat3& gradient, double depth,
                        double height, const Mat3& rotation) {
  std::vector<Vec3> u;
  for (const Vec3& x : body.nodes.position) {
    const Vec3 from = x - Vec3(depth, height, 0);
    // Ahead is x, normal y.
    const Vec3 y = x + gradient * from +
                   mode_displacement(material, std::hypot(from.x(), from.y()), std::atan2(from.y(), from.x())) * k;
    u.push_back(rotation * y + Vec3(0.3, -0.2, 0.1) - x);
  }
  return u;
}

}  // namespace

TEST_CASE("stress intensities imposed on nodes are told exactly, and where the crack would go", "[fracture]") {
  const double depth = 0.493, height = 0.507;
  const auto seed = GENERATE(1, 2, 3);
  const Notched n = notched_block({1, 1, 0.4}, 0.08, depth, height, static_cast<std::uint64_t>(seed));
  Material material;
  material.young = 1e9;
  material.poisson = 0.3;
  const Mat3 none = Mat3::Zero(), turned = Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()).toRotationMatrix();
  struct Case {
    Vec3 k;
    double angle;
  };
  // Erdogan and Sih: K_I sin θ + K_II (3 cos θ − 1) = 0.
  const double mixed = 2 * std::atan((1 - std::sqrt(1 + 8.0)) / 4) / degree;  // K_I = K_II
  for (const auto& [k, angle] : {Case{{1e3, 0, 0}, 0}, Case{{0, 1e3, 0}, -70.5288}, Case{{0, -1e3, 0}, 70.5288},
                                 Case{{1e3, 1e3, 0}, mixed}, Case{{1e3, 0, 4e2}, 0}})
    for (const Mat3& rotation : {Mat3(Mat3::Identity()), turned}) {
      const auto u = moved(n.body, material, k, none, depth, height, rotation);
      for (std::size_t i = 0; i < n.front.size(); ++i) {
        if (!n.front.live(i)) continue;
        const TipField field = tip_field(n.body, u, material, tip_frame(n.front, i));
        INFO("seed " << seed << " point " << i << " k " << k.transpose() << " told " << field.k.transpose() << " nodes "
                     << field.nodes);
        CHECK(field.nodes > 20);
        CHECK((field.k - k).norm() < 1e-3 * k.norm());
        CHECK(field.strongest().angle / degree == Approx(angle).margin(0.5));
      }
    }
}

TEST_CASE("a flaw that the nodes do not see is pulled apart across the largest principal stress", "[fracture]") {
  const Notched n = notched_block({1, 1, 0.4}, 0.08, 0.1, 0.507);
  Material material;
  material.young = 1e6;
  material.poisson = 0;
  for (const double angle : {0.0, 25.0, -60.0}) {
    const Vec3 pull(-std::sin(angle * degree), std::cos(angle * degree), 0);
    const auto u = moved(n.body, material, Vec3::Zero(), 1e-4 * pull * pull.transpose(), 0.1, 0.507, Mat3::Identity());
    const TipField field = tip_field(n.body, u, material, tip_frame(n.front, 3));
    CHECK(field.strongest().angle / degree == Approx(angle).margin(0.1));
    CHECK(field.strongest().stress == Approx(100).epsilon(1e-3));
  }
}

TEST_CASE("displacements and stresses of the modes belong together", "[fracture]") {
  Material m;
  m.young = 3e5;
  m.poisson = 0.27;
  for (int mode = 0; mode < 3; ++mode)
    for (const double angle : {-2.0, 0.4, 1.9}) {
      const double r = 0.3, h = 1e-6;
      const auto at = [&](const Vec3& x) {
        return Vec3(mode_displacement(m, std::hypot(x.x(), x.y()), std::atan2(x.y(), x.x())).col(mode));
      };
      const Vec3 x(r * std::cos(angle), r * std::sin(angle), 0);
      Mat3 g;
      for (int c = 0; c < 3; ++c) g.col(c) = (at(x + h * Vec3::Unit(c)) - at(x - h * Vec3::Unit(c))) / (2 * h);
      const Mat3 strain = 0.5 * (g + g.transpose()),
                 hooke = m.lambda() * strain.trace() * Mat3::Identity() + 2 * m.mu() * strain;
      CHECK((hooke - mode_stress(m.poisson, mode, r, angle)).norm() < 1e-6);
    }
}
