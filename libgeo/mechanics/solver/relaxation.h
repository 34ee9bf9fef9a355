// How far material points are from being free of stress in the body's own shape: by plastic strain,
// and by prestretch.
#pragma once

#include <vector>

#include "kerf/solid.h"
#include "mechanics/discretisation/material_points.h"
#include "mechanics/material/elastic_lanes.h"
#include "mechanics/material/point_matrices.h"

namespace geo {

/// The relaxation of the points of a block. Without points: elasticity sees F itself.
struct PointRelaxation {
  PointMatrices<double> matrix;  ///< per point, symmetric: elasticity sees F times it
  /// Per point: its volume without stress over its volume in the body. Empty: 1, as plastic strain
  /// keeps the volume.
  std::vector<double> share;

  /// Whether elasticity sees F itself.
  bool empty() const { return matrix.column[0].empty(); }
  /// The matrix of a point; the identity without points.
  Mat3 at(std::size_t point) const;
  /// The volume without stress of a point over its volume.
  double share_at(std::size_t point) const { return share.empty() ? 1 : share[point]; }
  /// For the laws of many points; refers to this.
  PointHistory history() const {
    return {.relaxation = empty() ? nullptr : &matrix, .share = share.empty() ? nullptr : &share};
  }
};

/// The symmetric V of F = V R: what isotropic elasticity sees of a stretch before others.
Mat3 left_stretch(const Mat3& f);

/// The relaxation of a block's points.
PointRelaxation relaxation_of(const MaterialPoints& points, std::size_t block, const State& state);

}  // namespace geo
