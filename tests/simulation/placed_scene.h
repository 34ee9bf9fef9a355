// Random scenes in which a solid is cut, and the same scenes placed in space in another way.
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "kerf/nodes.h"
#include "kerf/scene.h"
#include "kerf/simulation.h"

namespace geo {

/// A scene and its models.
struct CutScene {
  PlacedModels models;
  Scene scene;
  std::string about;  ///< what it is, for a failing test
  /// Two nodes lie across the model: its stiffness depends on where points of the scheme are.
  bool is_thin = false;
};

/// A way of placing a scene in space: x ↦ scale · (±x_axis[0], ±x_axis[1], ±x_axis[2]) + offset.
/// Coordinates are multiplied by powers of two, exchanged and mirrored: nothing is rounded but by
/// the offset.
struct Placement {
  std::string name;
  std::array<int, 3> axis = {0, 1, 2};
  std::array<double, 3> sign = {1, 1, 1};
  double scale = 1;
  Vec3 offset = Vec3::Zero();  ///< model units

  /// The signed permutation.
  Mat3 matrix() const;
};

/// As it is; translated by binary fractions; mirrored in each axis; with axes exchanged; twice and
/// half as large.
std::array<Placement, 8> placements();

/// A scene in which one to three blades cut a block, a ball or a torus about the origin, 1 to 2
/// units large: anywhere, in a symmetry plane, in a face, along lines of the mesh, or next to these
/// by less than doubles resolve. Seed decides all.
CutScene random_cut_scene(std::uint64_t seed);

/// The same scene, placed. Times stay: velocities and accelerations scale with lengths, moduli and
/// strengths with their square, and toughness with the power 2.5.
CutScene placed(const CutScene& cut, const Placement& way);

/// Nodes, placed.
NodeSet placed(const NodeSet& nodes, const Placement& way);

}  // namespace geo
