// First level of the preconditioner, additive Schwarz with overlap: each subdomain is solved for
// with all other nodes held, with its stiffness at rest rotated to where it is. A node's correction
// is split among its subdomains.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "mechanics/material/stiffness_lanes.h"
#include "mechanics/solver/subdomain_inverses.h"
#include "mechanics/solver/subdomain_lanes.h"
#include "mechanics/solver/subdomains.h"

namespace geo {

class SchwarzPreconditioner {
 public:
  /// Data that the stiffness of subdomains is computed from, with their outer products.
  struct Input {
    const Materials& materials;                ///< of nodes
    std::span<const Moduli> moduli;            ///< per material, of an isotropic stiffness
    const std::vector<StiffnessModes>& modes;  ///< per block: rotations of points now
    const std::vector<Mat3>& blocks;           ///< per node: its diagonal block without elasticity, N/m
    const std::vector<std::uint8_t>& fixed;    ///< as in Environment
  };
  /// Computes all inverses but those in `inverses` that are valid. Refers to subdomains, materials,
  /// moduli and inverses.
  SchwarzPreconditioner(const Subdomains& subdomains, const Input& input, SubdomainInverses& inverses);
  /// Recomputes the inverses of the subdomains in `which`, whose blocks have changed, with the
  /// rotations they have.
  void renew(std::span<const std::uint32_t> which, const std::vector<Mat3>& blocks,
             const std::vector<std::uint8_t>& fixed);
  /// Multiplies the inverse of each listed subdomain by r; at() then adds them up.
  void solve(const std::vector<Vec3>& r, std::span<const std::uint32_t> subdomains);
  /// The sum over the subdomains of a node.
  Vec3 at(std::size_t node) const {
    Vec3 sum = Vec3::Zero();
    for (const auto& place : subdomains_.subdomains_of(node))
      sum += Eigen::Map<const Eigen::Vector3f>(&solution_[4 * (subdomains_.first(place.subdomain) + place.slot)])
                 .cast<double>();
    return sum;
  }

 private:
  using DiagonalTerm = SubdomainInverses::DiagonalTerm;
  void diagonal_terms(std::size_t subdomain, const std::vector<Mat3>& blocks, const std::vector<std::uint8_t>& fixed,
                      std::vector<DiagonalTerm>& terms) const;
  const Moduli& moduli_of(std::size_t subdomain) const {
    return moduli_[materials_.index(subdomains_.nodes(subdomain)[0])];
  }
  void load(std::size_t subdomain, bool isotropic, const std::vector<Mat3>& blocks,
            const std::vector<std::uint8_t>& fixed, std::size_t lane, EightSubdomains& to) const;
  void store(std::size_t subdomain, std::size_t lane, const EightSubdomains& from);

  const Subdomains& subdomains_;
  const Materials& materials_;
  std::span<const Moduli> moduli_;
  SubdomainInverses& inverse_;
  std::vector<Eigen::Matrix3f> rotation_;  // per subdomain
  std::vector<float> solution_;            // four numbers per node of a subdomain
};

}  // namespace geo
