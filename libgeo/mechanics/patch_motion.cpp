#include "mechanics/patch_motion.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "base/parallel.h"
#include "mechanics/patch_lanes.h"

namespace geo {
namespace {

using Mat3f = Eigen::Matrix3f;

// The upper half, rounded.
std::uint16_t half(float x) { return static_cast<std::uint16_t>((std::bit_cast<std::uint32_t>(x) + 0x8000u) >> 16); }

}  // namespace

PatchMotion::PatchMotion(const NodePatches& patches, const Materials& materials, std::span<const Moduli> moduli, const std::vector<StiffnessModes>& modes,
                         const std::vector<Mat3>& blocks, const std::vector<std::uint8_t>& fixed, PatchInverses& inverses)
    : patches_(patches), materials_(materials), moduli_(moduli), inverse_(inverses), rotation_(patches.count(), Mat3f::Identity()), parts_(4 * patches.first(patches.count())) {
  if (inverse_.count() != patches.count()) inverse_.begin(patches);
  parallel_for(patches.count(), 16, [&](std::size_t begin, std::size_t end) {
    for (std::size_t p = begin; p < end; ++p) {
      if (const auto [block, point] = patches.point(p); block != ~0u) rotation_[p] = modes[block].rotation(point);
      if (const auto own = besides(p, blocks, fixed); !inverse_.knows(p, own, moduli_of(p))) invert(p, own, blocks, fixed);
    }
  });
}

// Empty where what nodes have is not the same in all directions: it would turn with the patch.
std::vector<PatchInverses::Besides> PatchMotion::besides(std::size_t patch, const std::vector<Mat3>& blocks, const std::vector<std::uint8_t>& fixed) const {
  std::vector<PatchInverses::Besides> all;
  for (const auto i : patches_.nodes(patch)) {
    const Mat3& k = blocks[i];
    const bool held = !fixed.empty() && fixed[i];
    if (!held && k != Mat3(k(0, 0) * Mat3::Identity())) return {};
    all.push_back({held ? -1.0f : float(k(0, 0)), static_cast<std::uint32_t>(patches_.patches_of(i).size())});
  }
  return all;
}

void PatchMotion::renew(std::span<const std::uint32_t> which, const std::vector<Mat3>& blocks, const std::vector<std::uint8_t>& fixed) {
  parallel_for(which.size(), 16, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) invert(which[k], besides(which[k], blocks, fixed), blocks, fixed);
  });
}

void PatchMotion::invert(std::size_t patch, std::span<const PatchInverses::Besides> plain, const std::vector<Mat3>& blocks, const std::vector<std::uint8_t>& fixed) {
  const auto nodes = patches_.nodes(patch);
  const std::size_t size = 3 * nodes.size(), row = padded(size);
  std::vector<float> matrix(size * row, 0.0f), share(nodes.size());
  const float* tile = patches_.outer(patch);
  const Mat3f& turn = rotation_[patch];
  const auto [shear, bulk] = moduli_of(patch);
  for (std::size_t a = 0; a < nodes.size(); ++a) {
    const bool held = !fixed.empty() && fixed[nodes[a]];
    share[a] = held ? 0 : 1 / std::sqrt(static_cast<float>(patches_.patches_of(nodes[a]).size()));
    for (std::size_t b = 0; b <= a; ++b, tile += 12) {
      if (held || (!fixed.empty() && fixed[nodes[b]])) continue;
      const float even = shear * (tile[0] + tile[5] + tile[10]);
      Mat3f k;
      for (int r = 0; r < 3; ++r)
        for (int c = 0; c < 3; ++c) k(r, c) = bulk * tile[4 * r + c] + shear * tile[4 * c + r] + (r == c ? even : 0);
      if (a == b) k += plain.empty() ? Mat3f(turn.transpose() * blocks[nodes[a]].cast<float>() * turn) : Mat3f(plain[a].inertia * Mat3f::Identity());
      for (std::size_t r = 0; r < 3; ++r)
        for (std::size_t c = 0; c < 3; ++c)
          matrix[(3 * a + r) * row + 3 * b + c] = matrix[(3 * b + c) * row + 3 * a + r] = k(static_cast<Eigen::Index>(r), static_cast<Eigen::Index>(c));
    }
    if (held)
      for (std::size_t r = 3 * a; r < 3 * a + 3; ++r) matrix[r * row + r] = 1;
  }
  invert_positive(size, matrix.data());
  inverse_.tell(patch, plain, moduli_of(patch));
  std::uint16_t* const to = inverse_.matrix(patch);
  for (std::size_t i = 0; i < size; ++i) {
    for (std::size_t j = 0; j <= i; ++j) to[i * row + j] = to[j * row + i] = half(share[i / 3] * share[j / 3] * matrix[i * row + j]);
    std::fill(to + i * row + size, to + (i + 1) * row, std::uint16_t(0));
  }
}

void PatchMotion::solve(const std::vector<Vec3>& r, std::span<const std::uint32_t> patches) {
  parallel_for(patches.size(), 128, [&](std::size_t begin, std::size_t end) {
    std::vector<float> x, y;
    for (std::size_t k = begin; k < end; ++k) {
      const std::size_t p = patches[k];
      const auto nodes = patches_.nodes(p);
      const std::size_t size = 3 * nodes.size();
      x.resize(padded(size)), y.resize(padded(size));
      const Mat3f &turn = rotation_[p], back = turn.transpose();
      for (std::size_t a = 0; a < nodes.size(); ++a) Eigen::Map<Eigen::Vector3f>{&x[3 * a]} = back * r[nodes[a]].cast<float>();
      multiply_halves(size, inverse_.matrix(p), x.data(), y.data());
      float* const out = &parts_[4 * patches_.first(p)];
      for (std::size_t a = 0; a < nodes.size(); ++a) Eigen::Map<Eigen::Vector3f>(out + 4 * a) = turn * Eigen::Map<const Eigen::Vector3f>(&y[3 * a]);
    }
  });
}

}  // namespace geo
