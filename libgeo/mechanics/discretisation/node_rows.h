// The gradient at nodes from their neighbours along the graph (Müller et al. 2004): what surface and blades follow,
// and, in the discretisation of that paper, where strain energy is summed.
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
#include "mechanics/discretisation/node_lanes.h"
#include "mechanics/discretisation/shape_functions.h"

namespace geo {

/// ∇u_i = Σ (u_j − u_i) g_ijᵀ with g_ij = w_ij A_i⁻¹ x_ij and A_i = Σ w_ij x_ij x_ijᵀ.
class NodeRows {
 public:
  /// Rows of `updated` anew; of all nodes where there are more than before.
  void update(const NodeSet& nodes, const VisibilityGraph& graph, std::span<const NodeId> updated);
  std::size_t size() const { return rows_.size(); }
  Rung rung(std::size_t i) const { return rows_[i].rung; }
  Mat3 gradient(std::size_t i, const std::vector<Vec3>& u) const;
  std::vector<Mat3> gradients(const std::vector<Vec3>& u) const;
  /// The same, each with a row of zeros below.
  std::vector<FourColumns> columns(const std::vector<Vec3>& u) const;
  /// The row with the node itself, ascending.
  ShapeRow row(std::size_t i) const;

  struct Row {
    std::vector<std::uint32_t> to;
    std::vector<Vec3> g, x;     // gradients; offsets to the neighbours
    std::vector<double> share;  // of the weights, which sum to 1, over |x|²
    Vec3 g_self = Vec3::Zero();
    Rung rung = Rung::rigid;
  };
  const Row& operator[](std::size_t i) const { return rows_[i]; }

 private:
  std::vector<Row> rows_;
};

/// Gradients at nodes, each worked out when it is first asked for: for what concerns a few nodes of a large body.
/// Several threads may ask at once. Refers to rows and displacements.
class NodeGradients {
 public:
  NodeGradients(const NodeRows& rows, const std::vector<Vec3>& u)
      : rows_(&rows), u_(&u), gradient_(rows.size()), known_(std::make_unique<std::atomic<Known>[]>(rows.size())) {}
  Mat3 operator[](std::size_t i) const {
    if (known_[i].load(std::memory_order_acquire) == Known::yes) return gradient_[i];
    const Mat3 gradient = rows_->gradient(i, *u_);
    // Of threads that have worked it out at once, one writes it down.
    if (Known no = Known::no; known_[i].compare_exchange_strong(no, Known::soon))
      gradient_[i] = gradient, known_[i].store(Known::yes, std::memory_order_release);
    return gradient;
  }

 private:
  enum class Known : std::uint8_t { no, soon, yes };
  const NodeRows* rows_;
  const std::vector<Vec3>* u_;
  mutable std::vector<Mat3> gradient_;
  std::unique_ptr<std::atomic<Known>[]> known_;
};

/// What strains at nodes do not see: ½ α E V_i Σ ŵ_ij |u_j − u_i − ∇u_i x_ij|² / |x_ij|², a quadratic form.
class ModePenalty {
 public:
  ModePenalty() = default;
  /// `weight`: per node, α E V.
  ModePenalty(const NodeRows& rows, std::vector<double> weight);
  /// The energy; adds its gradient to `out`, where given.
  double add(const NodeRows& rows, const std::vector<Vec3>& u, std::vector<Vec3>* out) const;
  /// Adds the diagonal, the same for all three coordinates.
  void add_diagonal(const NodeRows& rows, std::vector<double>& out) const;

 private:
  std::vector<double> weight_;  // per node: α E V
  std::vector<std::vector<std::pair<std::uint32_t, std::uint32_t>>>
      incoming_;  // per node: rows that hold it, and where
};

}  // namespace geo
