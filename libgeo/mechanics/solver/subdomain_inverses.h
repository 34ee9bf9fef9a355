// Inverses of the stiffness of subdomains, kept from step to step while nothing changes that they
// are made of.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/uninitialized_array.h"
#include "kerf/material.h"
#include "mechanics/material/stress_derivative.h"
#include "mechanics/solver/subdomains.h"

namespace geo {

class SubdomainInverses {
 public:
  /// Term of the matrix' diagonal, per node of a subdomain; with the outer products it determines
  /// the inverse.
  struct DiagonalTerm {
    float inertia;             ///< the same in all directions, N/m; negative: the node is fixed
    std::uint32_t subdomains;  ///< number of subdomains that the node is in
    /// Equality of both members.
    friend bool operator==(const DiagonalTerm&, const DiagonalTerm&) = default;
  };

  /// Allocates the inverses of all subdomains; none is valid.
  void begin(const Subdomains& subdomains);
  /// The same after the subdomains have changed, but keeps inverses of unchanged subdomains.
  /// `former`: as Subdomains::update() returns it.
  void update(const Subdomains& subdomains, std::span<const std::uint32_t> former);
  /// Number of subdomains.
  std::size_t count() const { return moduli_.size(); }

  /// Whether matrix(p) is valid for these terms and moduli.
  bool is_valid(std::size_t p, std::span<const DiagonalTerm> terms, const Moduli& moduli) const;
  /// Declares matrix(p) as made of these; empty `terms`: of more than these, so that it is valid
  /// for this step only.
  void set_valid(std::size_t p, std::span<const DiagonalTerm> terms, const Moduli& moduli);

  /// Upper halves of the floats of an inverse: three rows per node, a stride of padded() apart.
  std::uint16_t* matrix(std::size_t p) { return &matrix_[first_[p]]; }
  /// The same, to read.
  const std::uint16_t* matrix(std::size_t p) const { return &matrix_[first_[p]]; }
  /// The floats of an inverse in the same places, where their upper halves would not be positive
  /// definite; empty elsewhere.
  std::vector<float>& floats(std::size_t p) { return floats_[p]; }
  /// The same, to read.
  const std::vector<float>& floats(std::size_t p) const { return floats_[p]; }

 private:
  std::vector<std::size_t> node_, first_;  // per subdomain and one more: offsets into terms_ and matrix_
  UninitializedArray<std::uint16_t> matrix_;
  std::vector<std::vector<float>> floats_;  // per subdomain
  std::vector<DiagonalTerm> terms_;         // per node of a subdomain
  std::vector<Moduli> moduli_;              // per subdomain
  std::vector<char> valid_;                 // per subdomain
};

}  // namespace geo
