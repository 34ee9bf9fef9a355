// The sum of all potentials of a time step, assembled at the nodes: energy, forces, Hessian–vector
// products and the blocks of a preconditioner.
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "mechanics/terms/stencil_matrix.h"

namespace geo {

/// Islands are the decoupled subsystems of a Newton solve. Every method that takes `island` (per
/// node; a stencil lies in one island) and `selected` (per island: 1 or 0) evaluates the stencils
/// of selected islands only.
class PotentialSum {
 public:
  /// Sums all terms of `potentials`, after their begin_substep() at displacements u. Keeps
  /// references to both. `asleep`: per node, or empty; terms of sleeping nodes alone are left out.
  PotentialSum(std::span<Potential* const> potentials, const std::vector<Vec3>& u,
               std::span<const std::uint8_t> asleep = {});
  /// True if there are no terms.
  bool empty() const { return terms_.empty(); }
  /// Number of terms.
  std::size_t size() const { return terms_.size(); }
  /// The stencil of a term.
  Stencil stencil(std::size_t term) const { return stencils_[term]; }
  /// Pairs of different components that a stencil couples; `component` is per node. Pairs may
  /// repeat. Components that sleep are coupled to none.
  std::vector<std::pair<std::uint32_t, std::uint32_t>> coupled_components(
      std::span<const std::uint32_t> component) const;

  /// Adds each selected island's energy at displacements u, J, to energy[island]. Its relative
  /// displacements are kept for update_derivatives().
  void add_energy(const std::vector<Vec3>& u, std::span<const std::uint32_t> island, const std::vector<char>& selected,
                  std::vector<double>& energy);
  /// Evaluates the derivatives of selected islands, at the displacements of the last add_energy()
  /// that selected them.
  void update_derivatives(std::span<const std::uint32_t> island, const std::vector<char>& selected);
  /// Begins a Newton iterate of selected islands at the displacements of the last add_energy() that
  /// selected them, and adds the change of each island's energy by friction to energy[island], J.
  void begin_iterate(std::span<const std::uint32_t> island, const std::vector<char>& selected,
                     std::vector<double>& energy);
  /// True if a term of the node has been active since the step began.
  bool acts_on(std::size_t node) const {
    return !matrices_[0].stencils_of(node).empty() || !matrices_[1].stencils_of(node).empty();
  }
  /// Sets interrupted[node] to 1 at the nodes of terms that have been active since the step began,
  /// but for those of smooth potentials.
  void mark_interrupted(std::vector<std::uint8_t>& interrupted) const;
  /// A term that may act, with its derivatives by the last update_derivatives().
  struct LinearisedTerm {
    std::uint32_t id;  ///< of the term, below size()
    const Potential* potential;
    std::uint32_t index;  ///< in the potential
    Stencil stencil;
    Vec3 force;    ///< −∂E/∂d, N
    Mat3 hessian;  ///< ∂²E/∂d², N/m
  };
  /// All of these, in their order.
  std::vector<LinearisedTerm> linearised_terms() const;
  /// The force −∂E/∂u at a node, N, by the last update_derivatives().
  Vec3 force_at(std::size_t node) const;
  /// Prepares hessian_product_at() for the product with p, by the Hessians of the last
  /// update_derivatives().
  void multiply_hessian(const std::vector<Vec3>& p);
  /// (∂²E/∂u² p) at a node, for the p of the last multiply_hessian(). Precondition: no
  /// update_derivatives() since.
  Vec3 hessian_product_at(std::size_t node) const {
    Eigen::Vector4f sum = Eigen::Vector4f::Zero();
    for (const auto& matrix : matrices_) sum += weighted_sum_of(matrix.stencils_of(node), product_);
    return sum.head<3>().cast<double>();
  }
  /// Adds a 3×3 block per node, N/m, for a block preconditioner: the diagonal block of ∂²E/∂u².
  /// Blocks of stencils with many small weights are enlarged, since neighbouring nodes move
  /// together.
  void add_diagonal_blocks(std::vector<Mat3>& blocks) const;

 private:
  struct Term {
    Potential* potential;
    std::uint32_t index, first_node;  // in its potential; of its stencil, which does not sleep
    double activation_distance;
  };
  /// Terms of selected islands that are not idle.
  std::vector<std::uint32_t> terms_to_evaluate(std::span<const std::uint32_t> island,
                                               const std::vector<char>& selected) const;
  void update_matrices();
  // Σ weight · values[index] in four partial sums, which do not wait for each other.
  static Eigen::Vector4f weighted_sum_of(std::span<const StencilMatrix::Entry> entries,
                                         const std::vector<Eigen::Vector4f>& values) {
    Eigen::Vector4f sums[4] = {Eigen::Vector4f::Zero(), Eigen::Vector4f::Zero(), Eigen::Vector4f::Zero(),
                               Eigen::Vector4f::Zero()};
    std::size_t e = 0;
    for (; e + 4 <= entries.size(); e += 4)
      for (std::size_t c = 0; c < 4; ++c) sums[c] += entries[e + c].weight * values[entries[e + c].index];
    for (; e < entries.size(); ++e) sums[0] += entries[e].weight * values[entries[e].index];
    return (sums[0] + sums[1]) + (sums[2] + sums[3]);
  }

  bool is_asleep(std::uint32_t node) const { return !asleep_.empty() && asleep_[node]; }

  const std::vector<Vec3>& start_;        // displacements where the substep began
  std::span<const std::uint8_t> asleep_;  // per node, or empty
  std::vector<Term> terms_;
  std::vector<Stencil> stencils_;              // per term
  std::vector<std::uint32_t> coupling_;        // terms whose stencils may span several components
  std::vector<std::uint8_t> idle_;             // per term: never active yet, and out of reach at its last evaluation
  std::vector<Vec3> displacement_;             // per term: relative displacement
  std::vector<Vec3> force_;                    // per term: −∂E/∂d
  using Hessian = Eigen::Matrix<float, 4, 3>;  // a row of zeros at the bottom
  std::vector<Hessian> hessian_;
  // Jacobian rows of the terms that have been active since the step began. First matrix: terms
  // active when it was made; second: the few that have become active since.
  StencilMatrix matrices_[2];
  std::vector<std::uint8_t> matrix_of_;            // per term: 0 none, else 1 + index of its matrix
  std::vector<Eigen::Vector4f> single_precision_;  // multiply_hessian()'s p
  std::vector<Eigen::Vector4f> product_;           // per active term: Hessian × relative p
};

}  // namespace geo
