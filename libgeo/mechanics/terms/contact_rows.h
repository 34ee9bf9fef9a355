// The rows of all that acts on nodes besides elasticity in a time step, beside each other: what they make depend on
// each other, their energies, forces and product.
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "mechanics/terms/row_lists.h"

namespace geo {

class ContactRows {
 public:
  /// Of all of these, after their begin() at displacements u; refers to both.
  ContactRows(std::span<Potential* const> potentials, const std::vector<Vec3>& u);
  bool empty() const { return rows_.empty(); }
  /// Pairs that join the parts of all nodes of each row, where `part` is each node's; none of a part with itself.
  std::vector<std::pair<std::uint32_t, std::uint32_t>> couples(std::span<const std::uint32_t> part) const;

  /// Adds to sum[part] the energies, J, at displacements u of rows of parts that are chosen. `part`: of each node, a
  /// row's nodes of one.
  void add_energy(const std::vector<Vec3>& u, std::span<const std::uint32_t> part, const std::vector<char>& chosen,
                  std::vector<double>& sum);
  /// Takes over what rows of parts that are chosen do, each at the displacements of the last add_energy() that it was
  /// chosen in.
  void push(std::span<const std::uint32_t> part, const std::vector<char>& chosen);
  /// Whether a row of a node does something, or has done so since the step began.
  bool acts_on(std::size_t node) const { return !lists_[0].of_node(node).empty() || !lists_[1].of_node(node).empty(); }
  /// What a node gets of that, N.
  Vec3 force_at(std::size_t node) const;
  /// ∂²E/∂u² p, by the curvatures of the last push(); then what a node has of it, until push() is called again.
  void multiply(const std::vector<Vec3>& p);
  Vec3 product_at(std::size_t node) const {
    Eigen::Vector4f sum = Eigen::Vector4f::Zero();
    for (const auto& lists : lists_)
      for (const auto& share : lists.of_node(node)) sum += share.weight * pull_[share.of];
    return sum.head<3>().cast<double>();
  }
  /// Adds for each node a 3×3 block, N/m, for a preconditioner: that of ∂²E/∂u², and more where a row's weight is
  /// spread over many nodes, as those near each other move together.
  void add_blocks(std::vector<Mat3>& out) const;

 private:
  struct Row {
    Potential* of;
    std::uint32_t number, node;  // its own, and of one of its nodes
    double reach;
  };
  /// Those of parts that are chosen, whose nodes have gone so far: not those that are idle.
  std::vector<std::uint32_t> rows_at_work(std::span<const std::uint32_t> part, const std::vector<char>& chosen) const;
  void list();

  const std::vector<Vec3>& begun_;
  std::vector<Row> rows_;
  std::vector<std::span<const NodeWeight>> entries_;
  std::vector<std::uint32_t> joining_;  // rows whose nodes may be of several parts
  std::vector<std::uint8_t> idle_;      // has never done anything, nor could where nodes were at its last evaluation
  std::vector<Vec3> way_, force_;
  using Curvature = Eigen::Matrix<float, 4, 3>;  // a row of zeros below
  std::vector<Curvature> curvature_;
  // Rows that do something, or have done so since the step began: those that did when the first list was made, and the
  // few that came since.
  RowLists lists_[2];
  std::vector<std::uint8_t> listed_;     // 1 + of which
  std::vector<Eigen::Vector4f> single_;  // what multiply() is given
  std::vector<Eigen::Vector4f> pull_;    // of each that is listed: what it has for its nodes, but for their weights
};

}  // namespace geo
