// The deformed surface as pages see it and point at it.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <kerf/simulation.h>
#include "live/command.h"
#include "live/painter.h"
#include "live/snapshot.h"
#include "live/topology.h"

namespace live {

/// A point of the material that a page points at.
struct PickedPoint {
  geo::Vec3 material = geo::Vec3::Zero();
  geo::SurfaceVertexId nearest;  ///< vertex of the surface
  geo::Side side = {};           ///< in which it is
};

/// Slots and positions as of the last update().
class SurfaceView {
 public:
  SurfaceView() = default;
  /// A view with the colours of a model.
  explicit SurfaceView(Painter painter) : painter_(std::move(painter)), look_(painter_.look()) {}

  /// Follows a run.
  void update(const geo::Simulation& run);
  /// Forgets the run: the next update() may be of any other one.
  void clear() { slots_.clear(); }
  /// The triangles as of the last update().
  const Topology& topology() const { return *slots_.topology(); }
  /// The slot of a surface vertex; none where it does not live.
  std::optional<std::uint32_t> slot_of(geo::SurfaceVertexId vertex) const { return slots_.slot(vertex); }
  /// Fills topology, positions and colours.
  void show(Snapshot& snapshot) const;

  /// The material at a point of the surface. Throws BadMessage where no triangle is there now.
  PickedPoint pick(const geo::Complex& surface, const Spot& spot) const;
  /// The place of a point in the world. Precondition: pick() finds it.
  geo::Vec3 world_point(const Spot& spot) const;
  /// The place of a surface vertex in the world; null where none was shown.
  const geo::Vec3* place_of(geo::SurfaceVertexId vertex) const;

 private:
  Painter painter_;
  std::shared_ptr<const std::string> look_;
  Slots slots_;
  std::vector<geo::Vec3> positions_;  // per vertex slot
};

}  // namespace live
