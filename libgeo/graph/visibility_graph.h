// The visibility graph G (§ 6.1): which nodes see each other, and how far apart they are.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/ids.h"
#include "base/progress.h"
#include "geometry/bvh.h"
#include "sampling/node_set.h"

namespace geo {

/// Warped length of an edge (§ 6.4), |x_i − x_j| / max(r_i, r_j), as an integer count of 2⁻²⁴ support radii, rounded
/// up and at least 1: sums are exact, so a distance depends on no order of summation.
constexpr std::uint32_t unit_radius = 1u << 24;
std::uint32_t warped_length(const Vec3& xi, const Vec3& xj, double ri, double rj);

/// An undirected graph over nodes; rows sorted by (length, node). Only edges shorter than the support matter to
/// neighbourhoods, but all are kept: connectivity does not depend on radii.
class VisibilityGraph {
 public:
  struct Arc {
    NodeId to;
    std::uint32_t length;  ///< warped, see above
    std::uint32_t plain;   ///< Euclidean, in plain_unit()
    friend auto operator<=>(const Arc& a, const Arc& b) = default;
  };
  std::size_t node_count() const { return rows_.size(); }
  std::size_t edge_count() const { return edges_; }
  std::span<const Arc> arcs(NodeId i) const { return rows_[i.index()]; }
  bool has(NodeId i, NodeId j) const;
  void resize(std::size_t nodes) { rows_.resize(nodes); }
  /// Adds (between these nodes, of this set) or removes the edge ij; both directions. False when it was (was not) there.
  bool add(const NodeSet& nodes, NodeId i, NodeId j);
  bool remove(NodeId i, NodeId j);
  /// Plain lengths are integers too: a power of two that is set once, 2⁻²⁶ of about the largest support radius.
  double plain_unit() const { return plain_unit_; }
  void set_plain_unit(double unit) { plain_unit_ = unit; }
  /// No edge is longer than this, in model units.
  double longest() const { return longest_; }
  /// Component of each node, numbered by lowest node; returns their count.
  std::uint32_t components(std::vector<std::uint32_t>& of) const;

 private:
  std::vector<std::vector<Arc>> rows_;
  std::size_t edges_ = 0;
  double plain_unit_ = 1, longest_ = 0;
};

/// The unit of plain lengths for a node set.
double plain_unit_for(const NodeSet& nodes);

/// EMST ∪ k nearest, minus every edge that touches a triangle of `obstacles` (closed semantics, exact).
VisibilityGraph build_visibility_graph(const NodeSet& nodes, const TriangleBvh& obstacles, int k,
                                       const Progress& progress = {});

}  // namespace geo
