// The stiffness of groups' rigid motions, beside what strains of single motions say.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "base/random.h"
#include "cases.h"
#include "mechanics/solver/coarse_lanes.h"
#include "simd_targets.h"

using namespace geo;

namespace {

using Matrix = Eigen::MatrixXd;

Eigen::Matrix3d any_turn(Random& random) {
  return Eigen::Quaterniond(Eigen::Vector4d::NullaryExpr([&] { return random.uniform(-1, 1); }))
      .normalized()
      .toRotationMatrix();
}

struct Case {
  PointBlock block;
  StiffnessModes modes;
  std::vector<float> weight;
  std::vector<Moduli> moduli;
  std::vector<std::uint16_t> slot;
  std::vector<Vec3> arm;
  std::vector<char> free;
  std::size_t stride = 1;
};

Case any_case(Random& random) {
  Case c;
  const std::size_t nodes = 1 + random.below(20), points = 1 + random.below(40);
  const auto slots = 1 + random.below(6);
  c.stride = 1 + random.below(4);
  for (int k = 0; k < 2; ++k)
    c.moduli.push_back({static_cast<float>(random.uniform(0.1, 1)), static_cast<float>(random.uniform(0, 3))});
  for (std::size_t j = 0; j < nodes; ++j) {
    c.slot.push_back(static_cast<std::uint16_t>(random.below(slots)));
    c.free.push_back(random.below(6) > 0);
    c.arm.push_back(Vec3::NullaryExpr([&] { return random.uniform(-1, 1); }));
  }
  c.modes.resize((points + 7) / 8 * 8);
  c.block.entry_begin.assign(1, 0);
  for (std::size_t i = 0; i < points; ++i) {
    MaterialPoint point{};
    point.material = static_cast<decltype(point.material)>(random.below(2));
    c.block.points.push_back(point);
    c.weight.push_back(random.below(5) ? static_cast<float>(random.uniform(0.1, 1)) : 0);
    for (std::size_t j = 0; j < nodes; ++j)
      if (random.below(2)) {
        c.block.entry_node.push_back(static_cast<std::uint16_t>(j));
        for (int k = 0; k < 3; ++k) c.block.entry_gradient_single.push_back(static_cast<float>(random.uniform(-1, 1)));
      }
    c.block.entry_begin.push_back(static_cast<std::uint32_t>(c.block.entry_node.size()));
    for (const std::size_t from : {0, 9}) {
      const Eigen::Matrix3d turn = any_turn(random);
      for (std::size_t k = 0; k < 9; ++k)
        c.modes.frame[StiffnessModes::offset(i, 18) + 8 * (from + k)] =
            static_cast<std::int16_t>(std::lround(StiffnessModes::frame_scale * turn.data()[k]));
    }
  }
  return c;
}

// Rows of the strain in the rotated frame, the last three √2 as long; six motions of each slot as
// columns; then the trace.
Matrix strains(const Case& c, std::size_t point, Eigen::Index slots) {
  Matrix all = Matrix::Zero(10, 6 * slots);
  const Eigen::Matrix3d turn = c.modes.rotation(point).cast<double>();
  for (auto q = c.block.entry_begin[point]; q < c.block.entry_begin[point + 1]; ++q) {
    const auto j = c.block.entry_node[q];
    if (!c.free[j]) continue;
    const Vec3 g = Eigen::Map<const Eigen::Vector3f>(&c.block.entry_gradient_single[3 * q]).cast<double>();
    for (int m = 0; m < 6; ++m) {
      const Vec3 moves = m < 3 ? Vec3(Vec3::Unit(m)) : Vec3(Vec3::Unit(m - 3).cross(c.arm[j]));
      const Eigen::Matrix3d gradient = turn.transpose() * moves * g.transpose(),
                            strain = (gradient + gradient.transpose()) / 2;
      all.block<9, 1>(0, 6 * c.slot[j] + m) += strain.reshaped();
      all(9, 6 * c.slot[j] + m) += strain.trace();
    }
  }
  return all;
}

}  // namespace

TEST_CASE("Rigid motions of groups have the stiffness of their strains, in all vectors", "[mechanics]") {
  const auto [first_seed, count] = seeds(200);
  for (int i = 0; i < count; ++i) {
    const std::uint64_t seed = first_seed + static_cast<std::uint64_t>(i);
    CAPTURE(seed);
    Random random(seed);
    const Case c = any_case(random);
    const auto slots = std::size_t(*std::max_element(c.slot.begin(), c.slot.end())) + 1;
    Matrix expected = Matrix::Zero(Eigen::Index(6 * slots), Eigen::Index(6 * slots));
    for (std::size_t k = 0; k < c.block.points.size(); k += c.stride) {
      const Matrix e = strains(c, k, Eigen::Index(slots));
      const Moduli& moduli = c.moduli[c.block.points[k].material];
      expected +=
          double(c.stride) * c.weight[k] *
          (2 * moduli.shear * e.topRows(9).transpose() * e.topRows(9) + moduli.bulk * e.row(9).transpose() * e.row(9));
    }
    std::vector<float> arms;
    for (std::size_t j = 0; j < c.arm.size(); ++j)
      for (const float x : arm_numbers(c.arm[j], c.free[j])) arms.push_back(x);
    for_each_simd_target([&] {
      std::vector<float> tiles(tile * slots * (slots + 1) / 2, 0);
      rigid_stiffness({c.block, c.modes, c.weight, c.moduli, c.stride}, c.slot, arms.data(), tiles.data());
      const float* at = tiles.data();
      for (std::size_t s = 0; s < slots; ++s)
        for (std::size_t t = 0; t <= s; ++t, at += tile)
          for (std::size_t m = 0; m < 6; ++m)
            for (std::size_t k = 0; k < 6; ++k)
              if (!(std::abs(at[8 * m + mode_at(k)] - expected(Eigen::Index(6 * s + m), Eigen::Index(6 * t + k))) <=
                    1e-5 * (1 + expected.norm())))
                FAIL_CHECK("slots " << s << " " << t << ", motions " << m << " " << k);
    });
  }
}
