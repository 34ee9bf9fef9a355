// The stress at vertices of the deforming surface, from that of the nodes that carry them.
#pragma once

#include <cstdint>
#include <vector>

#include <kerf/simulation.h>
#include "live/surface_view.h"

namespace live {

/// Keeps the weights of the nodes while the surface is not cut.
class SurfaceStress {
 public:
  /// Per vertex slot of the view: the stress of the nodes around it, in which near ones count more;
  /// Pa. No node on the other side of a cut counts.
  /// \param stress  per node, Pa
  /// \param view  of this run, up to date
  std::vector<double> at_vertices(const geo::Simulation& run, const std::vector<double>& stress,
                                  const SurfaceView& view);
  /// Forgets the weights: the next run may be any other one.
  void clear() { revision_ = 0; }

 private:
  void find_weights(const geo::Body& body, const SurfaceView& view);

  std::uint32_t revision_ = 0;        // of the view's topology, of which the weights are; 0: none
  std::vector<std::uint32_t> first_;  // per vertex slot, and one more: where its nodes begin
  std::vector<std::uint32_t> node_;
  std::vector<double> weight_;
};

}  // namespace live
