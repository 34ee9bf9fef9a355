// Eq. 1 as one linear map: how the displacement of each surface vertex follows from those of nodes.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "kerf/body.h"
#include "kerf/solid.h"
#include "mechanics/terms/potential.h"

namespace geo {

/// A row per surface vertex: nodes, and weights that sum to 1. A vertex's velocity follows from the
/// nodes' by the same weights, and an impulse on it is spread over the nodes by them (§ 3.3).
class SurfaceWeights {
 public:
  using Entry = NodeWeight;
  /// Rows of all living surface vertices: the kernel weights of Eq. 1 and, through each node's
  /// gradient, those of its neighbours. Cost follows the surface.
  void update(const Body& body, const Solid& solid);
  /// After a split that was made since: the same, but only rows are made anew that it can have
  /// changed. Returns which, ascending.
  std::vector<std::uint32_t> follow(const Body& body, const Solid& solid, const BodyDelta& delta);

  std::size_t size() const { return rows_.size(); }
  std::span<const Entry> row(std::size_t v) const { return rows_[v]; }
  double area(std::size_t v) const { return area_[v]; }      ///< area_about() it
  double spread(std::size_t v) const { return spread_[v]; }  ///< weight_norm() of its row
  /// Per surface vertex the node that weighs most, the lowest of several; ~0u: none carries it.
  const std::vector<std::uint32_t>& heaviest() const { return heaviest_; }
  /// What the nodes' values are at surface vertex v; zero for a vertex that no node carries.
  Vec3 at(std::size_t v, const std::vector<Vec3>& values) const { return weighted_sum(rows_[v], values); }
  /// The same of many, by all threads.
  std::vector<Vec3> at_each(std::span<const std::uint32_t> vertices, const std::vector<Vec3>& values) const;

 private:
  void make(const Body& body, const Solid& solid, std::span<const std::uint32_t> vertices);

  std::vector<std::vector<Entry>> rows_;
  std::vector<std::uint32_t> heaviest_;
  std::vector<double> area_, spread_;
};

}  // namespace geo
