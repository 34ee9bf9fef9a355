// Near-tip fields of a sharp crack in plane strain (Williams 1957; mode III: antiplane shear). A
// weighted least-squares fit finds a uniform gradient and K_I, K_II, K_III from the nodes'
// displacements.
#include "simulation/fracture_tip.h"

#include <Eigen/QR>
#include <cmath>
#include <numbers>

#include "base/elementary.h"
#include "body/incremental_cache.h"
#include "body/locate.h"
#include "geometry/nearest_rotation.h"
#include "mechanics/discretisation/kernel.h"

namespace geo {

// Williams 1957, plane strain: κ = 3 − 4 ν, scale √(r / 2π) / (2 μ). Modes by column: I opening, II
// in-plane shear, III out-of-plane shear.
Mat3 mode_displacement(const Material& m, double r, double angle) {
  const double c = cosine(angle / 2), s = sine(angle / 2), kappa = 3 - 4 * m.poisson,
               scale = std::sqrt(r / (2 * std::numbers::pi)) / (2 * m.mu());
  Mat3 u;
  u.col(0) = scale * Vec3(c * (kappa - 1 + 2 * s * s), s * (kappa + 1 - 2 * c * c), 0);
  u.col(1) = scale * Vec3(s * (kappa + 1 + 2 * c * c), -c * (kappa - 1 - 2 * s * s), 0);
  u.col(2) = scale * Vec3(0, 0, 4 * s);
  return u;
}

// u = √r f(θ) has the derivative cos θ f / (2 √r) − sin θ f′ / √r ahead.
Mat3 mode_slope(const Material& m, double r, double angle) {
  const double c = cosine(angle / 2), s = sine(angle / 2), kappa = 3 - 4 * m.poisson;
  Mat3 turned;  // f′, in the scale of mode_displacement(m, 1, angle)
  turned.col(0) =
      Vec3(-s / 2 * (kappa - 1 + 2 * s * s) + 2 * s * c * c, c / 2 * (kappa + 1 - 2 * c * c) + 2 * s * s * c, 0);
  turned.col(1) =
      Vec3(c / 2 * (kappa + 1 + 2 * c * c) - 2 * s * s * c, s / 2 * (kappa - 1 - 2 * s * s) + 2 * s * c * c, 0);
  turned.col(2) = Vec3(0, 0, 2 * c);
  turned *= std::sqrt(1 / (2 * std::numbers::pi)) / (2 * m.mu());
  return (0.5 * cosine(angle) * mode_displacement(m, 1, angle) - sine(angle) * turned) / std::sqrt(r);
}

// The same fields' stress, f(angle) / √(2 π r); σ_zz = ν (σ_xx + σ_yy) in plane strain.
Mat3 mode_stress(double poisson, int mode, double r, double angle) {
  const double c = cosine(angle / 2), s = sine(angle / 2), c3 = cosine(1.5 * angle), s3 = sine(1.5 * angle);
  double xx = 0, yy = 0, xy = 0, xz = 0, yz = 0;
  if (mode == 0) {
    xx = c * (1 - s * s3);
    yy = c * (1 + s * s3);
    xy = s * c * c3;
  }
  if (mode == 1) {
    xx = -s * (2 + c * c3);
    yy = s * c * c3;
    xy = c * (1 - s * s3);
  }
  if (mode == 2) {
    xz = -s;
    yz = c;
  }
  Mat3 stress;
  stress << xx, xy, xz, xy, yy, yz, xz, yz, poisson * (xx + yy);
  return stress / std::sqrt(2 * std::numbers::pi * r);
}

// Mode III has no hoop stress. Poisson's ratio affects only σ_zz, which is not used: 0 is passed.
double TipField::hoop(double angle) const {
  const Vec3 across(-sine(angle), cosine(angle), 0);
  double sum = across.dot(uniform * across);
  for (int mode = 0; mode < 2; ++mode) sum += k[mode] * across.dot(mode_stress(0, mode, support / 4, angle) * across);
  return sum;
}

TipField::Strongest TipField::strongest() const {
  // There are one or two maxima: a scan by degrees over ±85° finds the larger one, step halving its
  // angle to 1e-9 rad.
  constexpr double degree = std::numbers::pi / 180;
  double best = 0;
  for (int a = -85; a <= 85; ++a)
    if (hoop(a * degree) > hoop(best)) best = a * degree;
  for (double step = 0.5 * degree; step > 1e-9; step *= 0.5)
    for (const double a : {best - step, best + step})
      if (hoop(a) > hoop(best)) best = a;
  return {best, hoop(best)};
}

namespace {

// Nodes that are fitted, with the square roots of their weights.
struct Neighborhood {
  std::vector<std::uint32_t> nodes;
  std::vector<double> weight;
  double support = 0;
};

// The nodes within two support radii of the tip that a point just ahead of the tip sees. That
// point, `eye`, is the first of five that is not behind a face: a quarter of a support ahead, an
// eighth, …, down to 1/64. The test begins 2 % of the way ahead, since crack faces meet at the tip
// itself. While eye == tip.at none has been found.
Neighborhood nodes_about(const Body& body, const TipFrame& tip) {
  Neighborhood found;
  const auto nearest = body.cache->grid.nearest(body.nodes.position, tip.at, 1, ~0u, [](auto) { return true; });
  if (nearest.empty()) return found;
  found.support = body.nodes.radius[nearest[0]];
  const double reach = 2 * found.support;
  Vec3 eye = tip.at;
  for (double step = 0.25 * found.support; step > 0.01 * found.support && eye == tip.at; step *= 0.5) {
    const Vec3 ahead = tip.at + step * tip.ahead;
    if (!is_blocked(body.surface, tip.at + 0.02 * step * tip.ahead, ahead)) eye = ahead;
  }
  if (eye == tip.at) return found;
  std::vector<std::uint32_t> near;
  body.cache->grid.within(body.nodes.position, tip.at, reach, near);
  for (const auto i : near) {
    const Vec3& x = body.nodes.position[i];
    if (is_blocked(body.surface, eye, x)) continue;
    found.nodes.push_back(i);
    found.weight.push_back(std::sqrt(kernel((x - tip.at).norm() / reach, 1.0)));
  }
  return found;
}

// Share of the line straight back from the tip, from one support radius to three, that has a crack
// on it.
double crack_behind(const Complex& complex, const TipFrame& tip, double h) {
  int crack = 0;
  for (int k = 0; k < 4; ++k) {
    const Vec3 back = tip.at - (1.25 + 0.5 * k) * h * tip.ahead;
    crack += is_blocked(complex, back + 0.25 * h * tip.normal, back - 0.25 * h * tip.normal);
  }
  return 0.25 * crack;
}

// Coefficients of a uniform gradient (9, column-major), a translation (3) and the modes (`modes` of
// them, in units of `scale`): the weighted least-squares fit of smallest norm to displacements v.
Eigen::VectorXd fit(const Body& body, const std::vector<Vec3>& v, const Material& material, const TipFrame& tip,
                    const Neighborhood& near, int modes, double scale) {
  const Mat3 frame = (Mat3() << tip.ahead, tip.normal, tip.along()).finished();
  const auto n = static_cast<Eigen::Index>(near.nodes.size());
  Eigen::MatrixXd a = Eigen::MatrixXd::Zero(3 * n, 12 + modes);
  Eigen::VectorXd b(3 * n);
  for (Eigen::Index j = 0; j < n; ++j) {
    const auto i = near.nodes[static_cast<std::size_t>(j)];
    const double w = near.weight[static_cast<std::size_t>(j)];
    const Vec3 x = frame.transpose() * (body.nodes.position[i] - tip.at);
    for (int c = 0; c < 3; ++c) a.block<3, 3>(3 * j, 3 * c) = w * x[c] / near.support * Mat3::Identity();
    a.block<3, 3>(3 * j, 9) = w * Mat3::Identity();
    if (modes > 0)
      a.block<3, 3>(3 * j, 12) = w * scale * mode_displacement(material, x.head<2>().norm(), angle_of(x.y(), x.x()));
    b.segment<3>(3 * j) = w * (frame.transpose() * v[static_cast<std::size_t>(j)]);
  }
  Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> solver;
  solver.setThreshold(1e-4);  // of the largest pivot: drops directions in which the nodes hardly extend
  solver.compute(a);
  return solver.solve(b);
}

}  // namespace

TipField tip_field(const Body& body, const std::vector<Vec3>& u, const Materials& materials, const TipFrame& tip,
                   const Intensities& intensities) {
  const Neighborhood near = nodes_about(body, tip);
  TipField field;
  field.nodes = near.nodes.size();
  field.support = near.support;
  if (field.nodes < 4) return field;
  field.node = near.nodes[0];  // the lowest index; all nodes seen are in one body, so it decides the material
  const Material& material = materials.of(field.node);
  const Mat3 frame = (Mat3() << tip.ahead, tip.normal, tip.along()).finished();
  std::vector<Vec3> v;
  for (const auto i : near.nodes) v.push_back(u[i]);
  const auto gradient = [&](const Eigen::VectorXd& c) { return Mat3(Eigen::Map<const Mat3>(c.data()) / near.support); };
  // First one affine map, whose rotation is removed; then the modes too, where there are enough
  // nodes.
  const Mat3 f = Mat3::Identity() + frame * gradient(fit(body, v, material, tip, near, 0, 1)) * frame.transpose();
  const Mat3 rotation = nearest_rotation(f).rotation;
  for (std::size_t j = 0; j < v.size(); ++j) {
    const Vec3 x = body.nodes.position[near.nodes[j]] - tip.at;
    v[j] = rotation.transpose() * (x + v[j]) - x;
  }
  const double cracked = crack_behind(body.surface, tip, near.support);
  // Along a resolved crack its singular field alone decides: the stress along it would turn it by
  // an angle that depends on the spacing of nodes.
  if (cracked == 1 && intensities) {
    if (const std::optional<Vec3> known = intensities(rotation)) {
      field.k = *known;
      return field;
    }
  }
  // Fifteen unknowns, three equations per node: five nodes determine them, eight leave nine more
  // equations for the fit.
  const int modes = field.nodes >= 8 ? 3 : 0;
  const double scale = 2 * material.mu() * std::sqrt(2 * std::numbers::pi / near.support);
  const Eigen::VectorXd c = fit(body, v, material, tip, near, modes, scale);
  const Mat3 g = gradient(c), stretch = Mat3::Identity() + 0.5 * (g + g.transpose());
  // Cauchy stress σ = P Fᵀ / J with F the symmetric stretch. Below a hundredth of its volume, or
  // inverted, the fit is taken as failed: the zero field, as if no node were there.
  if (!(stretch.determinant() > 0.01)) return {};
  field.uniform = stress(material, stretch) * stretch / stretch.determinant();
  if (modes == 0) return field;
  field.k = scale * c.tail<3>();
  // Crack faces carry no traction σ n: only the uncracked share behind the tip keeps it.
  const Vec3 traction = (1 - cracked) * field.uniform.col(1);
  field.uniform.col(1) = traction;
  field.uniform.row(1) = traction.transpose();
  return field;
}

}  // namespace geo
