// z = Σ_p W_p K_p⁻¹ W_p r_p over subdomains p. W_p scales each node by 1/√n, n its number of
// subdomains, so that the sum is symmetric. Eight subdomains are inverted side by side.
#include "mechanics/solver/schwarz_preconditioner.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "kerf/parallel.h"

namespace geo {
namespace {

// Whether the inverse A of a lane's matrix K stays positive definite, with its eigenvalues within a
// half, when its numbers are rounded to upper halves. Scaled to a diagonal of ones, A has entries
// of at most 1, so that rounding is a symmetric matrix of size 3n with entries below u = 2⁻⁹, whose
// norm is about 2 u √n if they are random. The least eigenvalue of A is at most
// 1 / max K_ii A_ii.
bool are_halves_positive(std::size_t nodes, std::size_t lane, const EightSubdomains& from) {
  constexpr float rounding = 1.0f / 512;
  float largest = 0;
  for (std::size_t a = 0; a < nodes; ++a) {
    const float* own = &from.tiles[72 * (a * (a + 1) / 2 + a) + lane];
    for (std::size_t c = 0; c < 3; ++c)
      largest = std::max(largest, -from.diagonal[8 * (3 * a + c) + lane] * own[32 * c]);
  }
  return 2 * rounding * std::sqrt(static_cast<float>(nodes)) * largest < 0.5f;
}

}  // namespace

using Mat3f = Eigen::Matrix3f;

SchwarzPreconditioner::SchwarzPreconditioner(const Subdomains& subdomains, const Input& input,
                                             SubdomainInverses& inverses)
    : subdomains_(subdomains),
      materials_(input.materials),
      moduli_(input.moduli),
      inverse_(inverses),
      rotation_(subdomains.count(), Mat3f::Identity()),
      solution_(4 * subdomains.first(subdomains.count())) {
  if (inverse_.count() != subdomains.count()) inverse_.begin(subdomains);
  std::vector<char> valid(subdomains.count());
  parallel_for(subdomains.count(), 64, [&](std::size_t begin, std::size_t end) {
    std::vector<DiagonalTerm> terms;
    for (std::size_t p = begin; p < end; ++p) {
      const auto [block, point] = subdomains.point(p);
      if (block != ~0u && input.modes[block].points > 0)  // else all of the block sleeps
        rotation_[p] = input.modes[block].rotation(point);
      diagonal_terms(p, input.blocks, input.fixed, terms);
      valid[p] = inverse_.is_valid(p, terms, moduli_of(p));
    }
  });
  std::vector<std::uint32_t> stale;
  for (std::uint32_t p = 0; p < valid.size(); ++p)
    if (!valid[p]) stale.push_back(p);
  renew(stale, input.blocks, input.fixed);
}

// Empty where a diagonal block is not isotropic: the inverse would depend on the rotation of the
// subdomain.
void SchwarzPreconditioner::diagonal_terms(std::size_t subdomain, const std::vector<Mat3>& blocks,
                                           const std::vector<std::uint8_t>& fixed,
                                           std::vector<DiagonalTerm>& terms) const {
  terms.clear();
  for (const auto i : subdomains_.nodes(subdomain)) {
    const Mat3& k = blocks[i];
    const bool is_fixed = !fixed.empty() && fixed[i];
    if (!is_fixed && k != Mat3(k(0, 0) * Mat3::Identity())) return terms.clear();
    terms.push_back(
        {is_fixed ? -1.0f : float(k(0, 0)), static_cast<std::uint32_t>(subdomains_.subdomains_of(i).size())});
  }
}

// Subdomains with equal numbers of nodes stand side by side.
void SchwarzPreconditioner::renew(std::span<const std::uint32_t> which, const std::vector<Mat3>& blocks,
                                  const std::vector<std::uint8_t>& fixed) {
  std::vector<std::uint32_t> order(which.begin(), which.end());
  std::sort(order.begin(), order.end(), [&](auto a, auto b) {
    return std::pair(subdomains_.nodes(a).size(), a) < std::pair(subdomains_.nodes(b).size(), b);
  });
  parallel_for((order.size() + 7) / 8, 4, [&](std::size_t begin, std::size_t end) {
    EightSubdomains lanes;
    std::vector<DiagonalTerm> terms;
    for (std::size_t k = 8 * begin; k < std::min(8 * end, order.size()); k += 8) {
      const auto eight = std::span(order).subspan(k, std::min<std::size_t>(8, order.size() - k));
      lanes.begin(subdomains_.nodes(eight.back()).size());
      for (std::size_t lane = 0; lane < eight.size(); ++lane) {
        diagonal_terms(eight[lane], blocks, fixed, terms);
        inverse_.set_valid(eight[lane], terms, moduli_of(eight[lane]));
        load(eight[lane], !terms.empty(), blocks, fixed, lane, lanes);
      }
      invert_positive(lanes);
      for (std::size_t lane = 0; lane < eight.size(); ++lane) store(eight[lane], lane, lanes);
    }
  });
}

// Writes a subdomain to one of eight lanes. An isotropic one is inverted in the frame at rest: its
// inverse stays valid however it rotates.
void SchwarzPreconditioner::load(std::size_t subdomain, bool isotropic, const std::vector<Mat3>& blocks,
                                 const std::vector<std::uint8_t>& fixed, std::size_t lane, EightSubdomains& to) const {
  const auto nodes = subdomains_.nodes(subdomain);
  const Mat3f turn = isotropic ? Mat3f::Identity() : rotation_[subdomain];
  for (std::size_t k = 0; k < 9; ++k) to.turn[8 * k + lane] = turn.data()[k];
  to.shear[lane] = moduli_of(subdomain).shear;
  to.bulk[lane] = moduli_of(subdomain).bulk;
  const auto is_fixed = [&](std::size_t a) { return !fixed.empty() && fixed[nodes[a]]; };
  const float* from = subdomains_.outer_products(subdomain);
  float* tile = &to.tiles[lane];
  for (std::size_t a = 0; a < nodes.size(); ++a) {
    for (std::size_t b = 0; b <= a; ++b, from += 12, tile += 72)
      if (!is_fixed(a) && !is_fixed(b))
        for (std::size_t k = 0; k < 9; ++k) tile[8 * k] = from[4 * (k / 3) + k % 3];
    if (is_fixed(a)) continue;
    for (std::size_t k = 0; k < 9; ++k) to.blocks[72 * a + 8 * k + lane] = float(blocks[nodes[a]].data()[k]);
    to.share[8 * a + lane] = 1 / std::sqrt(static_cast<float>(subdomains_.subdomains_of(nodes[a]).size()));
  }
}

// Reads the inverse of a subdomain from its lane, both triangles.
void SchwarzPreconditioner::store(std::size_t subdomain, std::size_t lane, const EightSubdomains& from) {
  const std::size_t nodes = subdomains_.nodes(subdomain).size(), stride = padded(3 * nodes);
  // number(a, b, at): of the tile of nodes a and b, at this index of the lists of eight lanes.
  const auto copy = [&](auto* to, const auto& number) {
    std::size_t tile = lane;
    for (std::size_t a = 0; a < nodes; ++a)
      for (std::size_t b = 0; b <= a; ++b, tile += 72)
        for (std::size_t k = 0; k < 9; ++k) {
          const std::size_t r = 3 * a + k / 3, c = 3 * b + k % 3;
          to[r * stride + c] = to[c * stride + r] = number(a, b, tile + 8 * k);
        }
  };
  std::uint16_t* const halves = inverse_.matrix(subdomain);
  copy(halves, [&](std::size_t, std::size_t, std::size_t at) { return from.halves[at]; });
  for (std::size_t i = 0; i < 3 * nodes; ++i)
    std::fill(halves + i * stride + 3 * nodes, halves + (i + 1) * stride, std::uint16_t(0));
  std::vector<float>& floats = inverse_.floats(subdomain);
  floats.clear();
  if (are_halves_positive(nodes, lane, from)) return;
  floats.assign(3 * nodes * stride, 0);
  copy(floats.data(), [&](std::size_t a, std::size_t b, std::size_t at) {
    return -from.share[8 * a + lane] * from.share[8 * b + lane] * from.tiles[at];
  });
}

void SchwarzPreconditioner::solve(const std::vector<Vec3>& r, std::span<const std::uint32_t> subdomains) {
  parallel_for(subdomains.size(), 128, [&](std::size_t begin, std::size_t end) {
    std::vector<float> x, y;
    for (std::size_t k = begin; k < end; ++k) {
      const std::size_t p = subdomains[k];
      const auto nodes = subdomains_.nodes(p);
      const std::size_t size = 3 * nodes.size();
      x.resize(padded(size));
      y.resize(padded(size));
      const Mat3f &turn = rotation_[p], back = turn.transpose();
      for (std::size_t a = 0; a < nodes.size(); ++a)
        Eigen::Map<Eigen::Vector3f>{&x[3 * a]} = back * r[nodes[a]].cast<float>();
      if (const std::vector<float>& floats = inverse_.floats(p); floats.empty())
        multiply_halves(size, inverse_.matrix(p), x.data(), y.data());
      else
        multiply_floats(size, floats.data(), x.data(), y.data());
      float* const out = &solution_[4 * subdomains_.first(p)];
      for (std::size_t a = 0; a < nodes.size(); ++a)
        Eigen::Map<Eigen::Vector3f>(out + 4 * a) = turn * Eigen::Map<const Eigen::Vector3f>(&y[3 * a]);
    }
  });
}

}  // namespace geo
