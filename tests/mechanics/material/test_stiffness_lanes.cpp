// The stiffness of points, eight side by side.
#include <Eigen/Eigenvalues>
#include <catch2/catch.hpp>

#include "base/random.h"
#include "cases.h"
#include "mechanics/material/stiffness_lanes.h"
#include "simd_targets.h"

using namespace geo;

TEST_CASE("Points turn as the singular value decomposition says, and alike whichever stand beside them, in all vectors",
          "[mechanics]") {
  const auto [first_seed, count] = seeds(100);
  for (int i = 0; i < count; ++i) {
    const std::uint64_t seed = first_seed + static_cast<std::uint64_t>(i);
    CAPTURE(seed);
    Random random(seed);
    const std::size_t points = 8 * (1 + random.below(6)),
                      begin = 8 * random.below(static_cast<std::uint32_t>(points / 8));
    const double far = random.uniform() < 0.3 ? 0 : random.uniform(0, 1.5);  // from the rest
    PointMatrices<float> gradient;
    gradient.resize(points);
    for (auto& column : gradient.column)
      for (std::size_t k = 0; k < 4 * points; ++k) column[k] = static_cast<float>(far * random.uniform(-1, 1));
    const std::vector<float> weight(points, 1);
    const StiffnessConstants constants = stiffness_constants(Material{});
    StiffnessModes first;
    for_each_simd_target([&] {
      StiffnessModes all;
      all.resize(points);
      stiffness_modes(constants, {begin, points}, gradient, nullptr, weight, all);
      for (std::size_t at = begin; at < points; at += 8) {
        StiffnessModes alone;
        alone.resize(points);
        stiffness_modes(constants, {at, at + 8}, gradient, nullptr, weight, alone);
        for (std::size_t k = 0; k < 144; ++k) CHECK(alone.frame[18 * at + k] == all.frame[18 * at + k]);
        for (std::size_t k = 0; k < 96; ++k) CHECK(alone.stiffness[12 * at + k] == all.stiffness[12 * at + k]);
      }
      for (std::size_t at = 0; at < begin; ++at) CHECK(all.frame[StiffnessModes::offset(at, 18)] == 0);
      for (std::size_t at = begin; at < points; ++at) {
        Eigen::Matrix3d f = Eigen::Matrix3d::Identity();
        for (std::size_t c = 0; c < 3; ++c)
          for (std::size_t r = 0; r < 3; ++r) f(Eigen::Index(r), Eigen::Index(c)) += gradient.column[c][4 * at + r];
        const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> squares(f.transpose() * f);
        Vec3 sigma = squares.eigenvalues().cwiseMax(0).cwiseSqrt();  // ascending
        if (sigma[0] < 0.05 || (f.determinant() < 0 && sigma[1] - sigma[0] < 0.1))
          continue;  // which direction is turned inside out is open
        if (f.determinant() < 0) sigma[0] *= -1;
        const Eigen::Matrix3d rotation =
            f * squares.eigenvectors() * sigma.cwiseInverse().asDiagonal() * squares.eigenvectors().transpose();
        CHECK((all.rotation(at).cast<double>() - rotation).norm() < 2e-3);
      }
      if (first.points == 0) first = all;
      CHECK(first.frame == all.frame);
      CHECK(first.stiffness == all.stiffness);
    });
  }
}
