#include "mechanics/solver/patch_motion.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "kerf/parallel.h"
#include "mechanics/solver/patch_lanes.h"

namespace geo {

using Mat3f = Eigen::Matrix3f;

PatchMotion::PatchMotion(const NodePatches& patches, const Materials& materials, std::span<const Moduli> moduli,
                         const std::vector<StiffnessModes>& modes, const std::vector<Mat3>& blocks,
                         const std::vector<std::uint8_t>& fixed, PatchInverses& inverses)
    : patches_(patches),
      materials_(materials),
      moduli_(moduli),
      inverse_(inverses),
      rotation_(patches.count(), Mat3f::Identity()),
      parts_(4 * patches.first(patches.count())) {
  if (inverse_.count() != patches.count()) inverse_.begin(patches);
  std::vector<char> known(patches.count());
  parallel_for(patches.count(), 64, [&](std::size_t begin, std::size_t end) {
    std::vector<PatchInverses::Besides> plain;
    for (std::size_t p = begin; p < end; ++p) {
      if (const auto [block, point] = patches.point(p); block != ~0u) rotation_[p] = modes[block].rotation(point);
      besides(p, blocks, fixed, plain);
      known[p] = inverse_.knows(p, plain, moduli_of(p));
    }
  });
  std::vector<std::uint32_t> which;
  for (std::uint32_t p = 0; p < known.size(); ++p)
    if (!known[p]) which.push_back(p);
  renew(which, blocks, fixed);
}

// None where what nodes have is not the same in all directions: it would turn with the patch.
void PatchMotion::besides(std::size_t patch, const std::vector<Mat3>& blocks, const std::vector<std::uint8_t>& fixed,
                          std::vector<PatchInverses::Besides>& all) const {
  all.clear();
  for (const auto i : patches_.nodes(patch)) {
    const Mat3& k = blocks[i];
    const bool held = !fixed.empty() && fixed[i];
    if (!held && k != Mat3(k(0, 0) * Mat3::Identity())) return all.clear();
    all.push_back({held ? -1.0f : float(k(0, 0)), static_cast<std::uint32_t>(patches_.patches_of(i).size())});
  }
}

// Those of as many nodes side by side.
void PatchMotion::renew(std::span<const std::uint32_t> which, const std::vector<Mat3>& blocks,
                        const std::vector<std::uint8_t>& fixed) {
  std::vector<std::uint32_t> order(which.begin(), which.end());
  std::sort(order.begin(), order.end(), [&](auto a, auto b) {
    return std::pair(patches_.nodes(a).size(), a) < std::pair(patches_.nodes(b).size(), b);
  });
  parallel_for((order.size() + 7) / 8, 4, [&](std::size_t begin, std::size_t end) {
    EightPatches room;
    std::vector<PatchInverses::Besides> plain;
    for (std::size_t k = 8 * begin; k < std::min(8 * end, order.size()); k += 8) {
      const auto eight = std::span(order).subspan(k, std::min<std::size_t>(8, order.size() - k));
      room.begin(patches_.nodes(eight.back()).size());
      for (std::size_t lane = 0; lane < eight.size(); ++lane) {
        besides(eight[lane], blocks, fixed, plain);
        inverse_.tell(eight[lane], plain, moduli_of(eight[lane]));
        put(eight[lane], !plain.empty(), blocks, fixed, lane, room);
      }
      invert_positive(room);
      for (std::size_t lane = 0; lane < eight.size(); ++lane) take(eight[lane], lane, room);
    }
  });
}

// A patch among eight. A plain one is not turned: what is kept of it is good wherever it turns.
void PatchMotion::put(std::size_t patch, bool plain, const std::vector<Mat3>& blocks,
                      const std::vector<std::uint8_t>& fixed, std::size_t lane, EightPatches& to) const {
  const auto nodes = patches_.nodes(patch);
  const Mat3f turn = plain ? Mat3f::Identity() : rotation_[patch];
  for (std::size_t k = 0; k < 9; ++k) to.turn[8 * k + lane] = turn.data()[k];
  to.shear[lane] = moduli_of(patch).shear, to.bulk[lane] = moduli_of(patch).bulk;
  const auto held = [&](std::size_t a) { return !fixed.empty() && fixed[nodes[a]]; };
  const float* from = patches_.outer(patch);
  float* tile = &to.tiles[lane];
  for (std::size_t a = 0; a < nodes.size(); ++a) {
    for (std::size_t b = 0; b <= a; ++b, from += 12, tile += 72)
      if (!held(a) && !held(b))
        for (std::size_t k = 0; k < 9; ++k) tile[8 * k] = from[4 * (k / 3) + k % 3];
    if (held(a)) continue;
    for (std::size_t k = 0; k < 9; ++k) to.blocks[72 * a + 8 * k + lane] = float(blocks[nodes[a]].data()[k]);
    to.share[8 * a + lane] = 1 / std::sqrt(static_cast<float>(patches_.patches_of(nodes[a]).size()));
  }
}

// Its inverse, both halves.
void PatchMotion::take(std::size_t patch, std::size_t lane, const EightPatches& from) {
  const std::size_t nodes = patches_.nodes(patch).size(), row = padded(3 * nodes);
  std::uint16_t* const to = inverse_.matrix(patch);
  const std::uint16_t* tile = &from.halves[lane];
  for (std::size_t a = 0; a < nodes; ++a)
    for (std::size_t b = 0; b <= a; ++b, tile += 72)
      for (std::size_t r = 0; r < 3; ++r)
        for (std::size_t c = 0; c < 3; ++c)
          to[(3 * a + r) * row + 3 * b + c] = to[(3 * b + c) * row + 3 * a + r] = tile[8 * (3 * r + c)];
  for (std::size_t i = 0; i < 3 * nodes; ++i) std::fill(to + i * row + 3 * nodes, to + (i + 1) * row, std::uint16_t(0));
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
      for (std::size_t a = 0; a < nodes.size(); ++a)
        Eigen::Map<Eigen::Vector3f>{&x[3 * a]} = back * r[nodes[a]].cast<float>();
      multiply_halves(size, inverse_.matrix(p), x.data(), y.data());
      float* const out = &parts_[4 * patches_.first(p)];
      for (std::size_t a = 0; a < nodes.size(); ++a)
        Eigen::Map<Eigen::Vector3f>(out + 4 * a) = turn * Eigen::Map<const Eigen::Vector3f>(&y[3 * a]);
    }
  });
}

}  // namespace geo
