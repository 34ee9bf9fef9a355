// Displacement gradients at nodes by moving least squares over the visibility graph (Müller et al.
// 2004). Surface and blades follow them; in the discretisation `mueller04`, strain energy is summed
// at nodes.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "kerf/graph.h"
#include "kerf/material.h"
#include "kerf/nodes.h"
#include "mechanics/discretisation/nodal_gradient_lanes.h"
#include "mechanics/discretisation/shape_functions.h"

namespace geo {

/// The largest Σ_i w_i Σ_j |g_ij · (x − x_i)| with which Eq. 1 extends the motion of nodes to x by
/// their gradients. On a regular grid, it is 2 for a point one spacing beyond the last node, in
/// each of three directions. Nodes that lie closer to each other, in a thin piece, would throw a
/// point a spacing away by many times their own motion: there, the gradients' share is reduced to
/// this bound, and the nodes' rotations take the rest. So weights of nodes have a sum of absolute
/// values of at most 7.
constexpr double most_amplified = 6;

/// The share of gradients in Eq. 1 for the sum of most_amplified.
inline double gradient_share(double amplified) { return amplified > most_amplified ? most_amplified / amplified : 1; }

/// ∇u_i = Σ_j (u_j − u_i) g_ijᵀ with g_ij = w_ij A_i⁻¹ x_ij and the moment matrix A_i = Σ_j w_ij
/// x_ij x_ijᵀ, over the neighbours j of node i; x_ij = x_j − x_i.
class NodalGradientOperator {
 public:
  /// Rebuilds the nodes `updated`; there may be more nodes than before.
  void update(const NodeSet& nodes, const VisibilityGraph& graph, std::span<const NodeId> updated);
  /// The number of nodes.
  std::size_t size() const { return nodes_.size(); }
  /// The quality of a node's moment matrix.
  MomentQuality quality(std::size_t i) const { return nodes_[i].quality; }
  /// Sets the rotations R_i of nodes without a full gradient (State::rotation); empty: none.
  void set_rotations(const std::vector<Mat3>& rotation);
  /// Whether rotations are set.
  bool has_rotations() const { return !undetermined_.empty(); }
  /// ∇u at node i, as far as its neighbours determine it: linear in u.
  Mat3 gradient(std::size_t i, const std::vector<Vec3>& u) const;
  /// The part of ∇u that gradient() leaves out: (R_i − 1) (1 − Σ_j x_ij g_ijᵀ). Zero where the rank
  /// is full.
  Mat3 undetermined(std::size_t i) const { return undetermined_.empty() ? Mat3(Mat3::Zero()) : undetermined_[i]; }
  /// ∇u at node i for displacements u: both parts.
  Mat3 displacement_gradient(std::size_t i, const std::vector<Vec3>& u) const {
    return gradient(i, u) + undetermined(i);
  }
  /// Σ_j |g_ij · arm|, the node itself included: at most how far ∇u_i arm goes where no node moves
  /// farther than 1. `arm`: from node i, model units.
  double amplification(std::size_t i, const Vec3& arm) const;
  /// The rotation of the material about node i for displacements u: the one nearest to
  /// (1 + ∇u_i) Σ_j ŵ_ij x_ij x_ijᵀ, ŵ_ij the normalised weights, so that directions in which the
  /// neighbours hardly extend have no say. Where the rank is not full, State::rotation decides
  /// about these directions.
  Mat3 rotation(std::size_t i, const std::vector<Vec3>& u) const;
  /// displacement_gradient() at all nodes, in parallel.
  std::vector<Mat3> gradients(const std::vector<Vec3>& u) const;
  /// gradients(), padded.
  std::vector<PaddedMat3> padded_gradients(const std::vector<Vec3>& u) const;
  /// Shape gradients at node i, the node itself included.
  ShapeGradients shape_gradients(std::size_t i) const;

  /// The gradient operator at one node. Arrays have one element per neighbour.
  struct Node {
    std::vector<std::uint32_t> neighbors;
    std::vector<Vec3> gradient;             ///< g_ij, 1/model unit
    std::vector<Vec3> offset;               ///< x_ij, model units
    std::vector<double> normalised_weight;  ///< w_ij / Σ w_ij / |x_ij|²
    Vec3 own_gradient = Vec3::Zero();       ///< −Σ g_ij
    MomentQuality quality = MomentQuality::singular;
  };
  /// The gradient operator at node i.
  const Node& operator[](std::size_t i) const { return nodes_[i]; }

 private:
  std::vector<Node> nodes_;
  std::vector<Mat3> undetermined_;  // per node; empty: zero
};

/// Displacement gradients at nodes, computed at first use: for queries that concern few nodes of a
/// large body. Threads may read the same object at the same time. Keeps references to the operator
/// and the displacements.
class LazyNodalGradients {
 public:
  /// Computes nothing yet.
  LazyNodalGradients(const NodalGradientOperator& gradients, const std::vector<Vec3>& u)
      : operator_(&gradients),
        u_(&u),
        gradient_(gradients.size()),
        state_(std::make_unique<std::atomic<State>[]>(gradients.size())) {}
  /// NodalGradientOperator::amplification().
  double amplification(std::size_t i, const Vec3& arm) const { return operator_->amplification(i, arm); }
  /// NodalGradientOperator::rotation() at these displacements. Computed anew by each call.
  Mat3 rotation(std::size_t i) const { return operator_->rotation(i, *u_); }
  /// ∇u at node i.
  Mat3 operator[](std::size_t i) const {
    if (state_[i].load(std::memory_order_acquire) == State::known) return gradient_[i];
    const Mat3 gradient = operator_->displacement_gradient(i, *u_);
    // Several threads may have computed it: the first to claim the entry writes it, the others use
    // their own copy.
    if (State unknown = State::unknown; state_[i].compare_exchange_strong(unknown, State::claimed)) {
      gradient_[i] = gradient;
      state_[i].store(State::known, std::memory_order_release);
    }
    return gradient;
  }

 private:
  enum class State : std::uint8_t { unknown, claimed, known };
  const NodalGradientOperator* operator_;
  const std::vector<Vec3>* u_;
  // Cache for several threads: entry i is written once, by the thread that moves state_[i] from
  // unknown to claimed, and is read only after its state has become known (release/acquire).
  mutable std::vector<Mat3> gradient_;  // thread-safe by state_
  std::unique_ptr<std::atomic<State>[]> state_;
};

/// Penalty on zero-energy modes, which nodal strains do not see: the quadratic form
/// ½ α E V_i Σ_j ŵ_ij |u_j − u_i − ∇u_i x_ij|² / |x_ij|², ŵ_ij the normalised weights.
class ModePenalty {
 public:
  /// No penalty.
  ModePenalty() = default;
  /// `weight`: per node, α E V.
  ModePenalty(const NodalGradientOperator& gradients, std::vector<double> weight);
  /// Returns the energy; adds its derivative by u to `derivative`, unless null.
  double add(const NodalGradientOperator& gradients, const std::vector<Vec3>& u, std::vector<Vec3>* derivative) const;
  /// Adds the diagonal of the form's matrix, the same for all three coordinates.
  void add_diagonal(const NodalGradientOperator& gradients, std::vector<double>& diagonal) const;

 private:
  struct Occurrence {
    std::uint32_t node, neighbor;  // index of the node, and of the neighbour in its arrays
  };
  std::vector<double> weight_;                        // per node: α E V
  std::vector<std::vector<Occurrence>> occurrences_;  // per node: where it is a neighbour
};

}  // namespace geo
