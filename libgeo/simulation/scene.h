// A scene: bodies, blades that cut them, what holds them, the ground, and how time goes.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "contact/contact_options.h"
#include "crack/front.h"
#include "mechanics/elasticity.h"
#include "sampling/sample.h"
#include "simulation/fracture.h"
#include "simulation/motion.h"
#include "surface/triangle_mesh.h"

namespace geo {

/// One solid of a scene. All of them become components of one Body, whose material coordinates are those of the placed
/// models.
struct SceneBody {
  std::string name;
  std::string mesh;  ///< path, relative to the scene file unless absolute
  SampleOptions sampling;
  double spacing_percent = 5;  ///< of the diagonal, when sampling.spacing and count are 0
  double scale = 1;            ///< of the model, before it is placed
  Pose place;
  Vec3 velocity = Vec3::Zero();  ///< at the start
  Vec3 spin = Vec3::Zero();      ///< angular velocity at the start about the middle of its box, rad/s
  std::optional<Material> material;  ///< its own; none: the scene's
};

/// Nodes in a box that are held, and moved.
struct Grip {
  Vec3 lo, hi;    ///< material coordinates
  Motion motion;  ///< of the box's middle, relative to where it was; none: stays
  bool release = false;  ///< lets go after the last key
  Vec3 middle() const { return 0.5 * (lo + hi); }
};

/// A rigid edge that cuts where it moves, with what is behind it.
struct Blade {
  std::string name;
  std::vector<Vec3> points;  ///< the edge, in its own coordinates
  bool closed = false;
  Motion motion;             ///< at least two keys; the blade is there from the first to the last
  Vec3 back = Vec3::Zero();  ///< from the edge to the back of the blade, in its own coordinates; its length is the blade's width
  double thickness = 0;      ///< of the wedge at its back, model units; 0: parts nothing
  double stiffness = 1e4;    ///< of what the wedge pushes with: acceleration per depth, 1/s²
  double limit = 1;          ///< longest way of an edge point within one cut, in node spacings (§ 5.1)

  bool active(double time) const { return motion.active(time); }
  /// World positions of the edge's points.
  std::vector<Vec3> at(double time) const;
};

/// A rigid thing that bodies lie on and are pressed by: a closed mesh, or all that is behind a plane.
struct SceneObstacle {
  std::string name;
  TriangleMesh mesh;             ///< in its own coordinates; empty: a plane through its origin
  Vec3 normal = Vec3::UnitZ();   ///< of the plane, where bodies may be
  double scale = 1;              ///< of the mesh, before it is placed
  Pose place;
  Motion motion;                 ///< of what was placed; none: stays
  double stiffness = 1e5;        ///< of its penalty: acceleration per depth, 1/s²
  double friction = 0.5;         ///< Coulomb's coefficient

  /// World = pose · scaled. Before its first key and after its last one it stands still.
  Pose pose(double time) const;
};

struct Scene {
  std::vector<SceneBody> bodies;  ///< one at least
  int k = 26;
  Material material;  ///< of bodies that have none of their own
  std::vector<Front> scores;  ///< cracks made before time 0, in material coordinates
  std::vector<Grip> grips;
  bool ground = false;
  Vec3 ground_point = Vec3::Zero(), ground_normal = Vec3::UnitZ();
  double ground_stiffness = 1e5, friction = 0.5;
  Vec3 gravity = {0, 0, -9.81};
  double frame_rate = 24, dt = 1.0 / 96;
  double accuracy = 1e-3;  ///< of displacements in an implicit step, over the nodes' spacing
  int frames = 24, checkpoint_every = 8;
  bool implicit = true;
  std::uint64_t seed = 1;
  std::vector<Blade> blades;
  std::vector<SceneObstacle> obstacles;
  Fracture fracture;
  bool self_contact = false;  ///< no two triangles of the surface cross in any frame
  ContactOptions contact;
  bool body_contact = true;        ///< where there is no self_contact: bodies push each other apart
  double contact_stiffness = 1e5;  ///< with this penalty: acceleration per depth, 1/s²
  std::uint64_t fingerprint = 0;  ///< of all that decides what the run computes; 0: not from a file
};

}  // namespace geo
