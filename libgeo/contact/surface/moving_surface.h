// The contact surface with the positions of its vertices, and what derives from both on demand.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "contact/detection/vertex_fans.h"
#include "contact/surface/coincident_vertices.h"
#include "contact/surface/contact_surface.h"

namespace geo {

/// Groups of surface vertices that share a site and, to the bit, a position. A group moves as one.
struct Coincidence {
  /// The groups of vertices with these sites and positions, one of each per vertex.
  Coincidence(const std::vector<std::uint32_t>& site, const std::vector<Vec3>& positions);

  std::vector<std::uint32_t> representative;  ///< per vertex (coincident_representatives())
  CoincidentVertices coincident;              ///< per representative its group

  /// Per vertex the mean of its group's values.
  std::vector<Vec3> averaged(const std::vector<Vec3>& values) const;
};

/// Owns topology and positions. Derived data is computed at the first query after a change; queries
/// are therefore not const and not thread-safe.
class MovingSurface {
 public:
  /// `positions`: per surface vertex, world.
  MovingSurface(ContactSurface topology, std::vector<Vec3> positions)
      : topology_(std::move(topology)), positions_(std::move(positions)) {}

  /// Triangles, sites and the mean edge.
  const ContactSurface& topology() const { return topology_; }
  /// World positions, per surface vertex; unspecified for dead ones.
  const std::vector<Vec3>& positions() const { return positions_; }
  /// Triangles around each vertex. Valid until replace().
  const VertexFans& fans();
  /// Vertices that coincide at the current positions. Valid until move_to() or replace().
  const Coincidence& coincidence();

  /// New positions of the same vertices.
  void move_to(std::vector<Vec3> positions) {
    positions_ = std::move(positions);
    coincidence_.reset();
  }
  /// Another surface, after a crack step.
  void replace(ContactSurface topology, std::vector<Vec3> positions);

 private:
  ContactSurface topology_;
  std::vector<Vec3> positions_;
  std::optional<VertexFans> fans_;
  std::optional<Coincidence> coincidence_;
};

}  // namespace geo
