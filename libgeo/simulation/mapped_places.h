// Places of blades in the material, as exact as the map that gives them.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "geometry/resolution.h"
#include "kerf/body.h"

namespace geo {

/// A sheet snaps to vertices and edges nearer than this, in spacings of the finest nodes: a
/// twentieth of what a front deviates from its blade's edge (edge_runs.cpp), and far above the
/// slivers that weights of nodes fold.
constexpr double snap_spacings = 0.001;

/// A place as exact as its map, and the planes of the skin that it may lie in.
struct MappedPlace {
  /// How the edge of a blade lies at a plane.
  enum class Edge : std::uint8_t { in_plane, crosses };
  /// A plane of faces of the skin: normal · x = offset, with the unit normal to the outside.
  struct SkinPlane {
    Vec3 normal;
    double offset;
    Edge edge;
  };
  Vec3 rounded;
  std::vector<SkinPlane> planes;
};

/// Rounds places that the inverse deformation has given. In a body at rest it returns a place with
/// an error of some 1e-12 of its size, and exact predicates would see it: a blade in a plane of
/// the mesh would leave specks, one in a face would shave it. Refers to the body's complex.
class MappedPlaces {
 public:
  /// For the places in a body.
  explicit MappedPlaces(const Body& body);
  /// The place on a grid of 2⁻³³ (1.2e-10) of the model's size: a hundred times the error, so that
  /// a plane along axes stays a plane. Its planes are those of the faces within two units of the
  /// grid, at a ridge those that the edge of the blade lies in. Also those that the edge lies in
  /// beside a face, up to a node spacing from it. `along`: the direction of the edge there, of any
  /// length.
  MappedPlace at(const Vec3& place, const Vec3& along) const;
  /// Adds to each place on an edge the planes that hold the edge at other places and that it may
  /// lie in: places in air beside the body go outside of a face with those that are on it, so that
  /// the sheet stays a plane.
  void share_planes(std::span<MappedPlace> edge) const;
  /// The place outside its planes, since whether it is in the material is not known: by ten units
  /// of the grid, but beyond the reach of snapping where the edge lies in the plane.
  Vec3 outside(const MappedPlace& place) const;
  /// at(), share_planes() and outside() for the points of an edge, in their order.
  std::vector<Vec3> resolved(std::span<const Vec3> edge) const;

 private:
  double reach() const { return 2 * resolution_.unit(); }

  const Complex& surface_;
  Resolution resolution_;
  double beside_skin_;      // how far beside a face an edge may lie in its plane, model units
  double beyond_snapping_;  // model units
};

}  // namespace geo
