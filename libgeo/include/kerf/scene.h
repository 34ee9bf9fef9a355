// Rigid motion by keyframes: blades, grips.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "kerf/crack.h"
#include "kerf/material.h"
#include "kerf/mesh.h"
#include "kerf/nodes.h"
#include "kerf/vec.h"

namespace geo {

/// Where a rigid thing is: world = position + rotation · local.
struct Pose {
  Vec3 position = Vec3::Zero();
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
  Vec3 operator*(const Vec3& local) const { return position + rotation * local; }
};

struct Motion {
  struct Key {
    double time = 0;  ///< s
    Vec3 position = Vec3::Zero();
    Vec3 axis = Vec3::UnitZ();  ///< not zero
    double angle = 0;           ///< degrees about axis
  };
  std::vector<Key> keys;  ///< ascending in time; none: stays where it is

  bool active(double time) const { return !keys.empty() && time >= keys.front().time && time <= keys.back().time; }
  /// Position interpolated linearly, rotation by its angle where both keys have the same axis (whole turns included),
  /// else spherically; before the first key and after the last one it stands still.
  Pose at(double time) const;
};

// ---- When and where a body breaks by its own stress (Pauly et al. 2005; O'Brien and Hodgins 1999): what a scene says
// of it.

/// What it takes to break a body.
struct Strength {
  double strength = 1e4;  ///< Pa: largest principal stress, averaged over the support radius, at which a crack begins
  double toughness =
      0;  ///< Pa √m: K_Ic at which a crack goes on; 0: strength · √(π h/2), h the support radius at the tip
  double variation = 0.2;  ///< of strength and toughness: they are multiplied by 1 + variation · noise in about [−1, 1]
  double grain = 0;        ///< size of the noise, model units; 0: a tenth of the diagonal of all bodies
  friend bool operator==(const Strength&, const Strength&) = default;
};

struct Fracture : Strength {
  bool on = false;
  std::vector<Strength> own;  ///< per body of the scene; empty: all have the same
  double speed = 0.55;        ///< the fastest a crack gets, as a share of the Rayleigh wave's speed
  double branching = 0;       ///< a front divides where the stress ahead is this many times what it needs; 0: never
  double apart = 4;           ///< no crack begins nearer to another than this many node spacings
  int cracks = 24;            ///< how many may begin in all, branches included
  int cracks_per_step = 1;
  double start = 0;                      ///< seconds: nothing breaks before
  std::vector<std::array<Vec3, 2>> off;  ///< boxes, material coordinates, where no crack begins or goes on
  std::uint64_t seed = 1;
  /// Of a node. `part`: per node, its body.
  const Strength& of(const std::vector<std::uint32_t>& part, std::size_t node) const {
    return own.empty() ? *this : own[part[node]];
  }
};

/// By how much strength and toughness at material point x differ from what the scene says; ≥ 0.05. `diagonal`: of all
/// bodies.
double strength_factor(const Strength& strength, std::uint64_t seed, double diagonal, const Vec3& x);

/// False where the scene says that nothing breaks.
bool may_break(const Fracture& fracture, const Vec3& x);

/// Speed of the Rayleigh wave at rest, model units per second: c_s (0.862 + 1.14 ν) / (1 + ν) (Freund 1990, § 2.1).
double rayleigh_speed(const Material& material);

/// The stress, averaged over a length h ahead of a tip, at which K reaches `toughness`: K √(2 / (π h)), the mean of
/// K / √(2 π r) over 0 < r < h (Taylor 2007, the line method).
double stress_of_toughness(double toughness, double h);

// ---- What contact is asked for, and what it took.

struct ContactOptions {
  double friction = 0.3;  ///< Coulomb's coefficient between surfaces of the body
  double gap = 1e-4;      ///< that open sheets keep, in mean edges of the surface
  double opening = 1e-2;  ///< how far Eq. 1 must have the two sides of a sheet apart before they part, in mean edges;
                          ///< along each other, three times
  double recovery = 0.3;  ///< share of the way back, in a step, for nodes whose surfaces have passed through each other
  int rounds = 2;         ///< of finding what touches and applying impulses
};

struct ContactStats {
  std::size_t watched = 0, touching = 0, in_zones = 0, opened = 0, held = 0;
  double lag = 0;  ///< largest distance of a vertex from where Eq. 1 has it, model units
  double seconds = 0;
  ContactStats& operator+=(const ContactStats& o);
};

// ---- A scene: bodies, blades that cut them, what holds them, the ground, and how time goes.

/// One solid of a scene. All of them become components of one Body, whose material coordinates are those of the placed
/// models.
struct SceneBody {
  std::string name;
  std::string mesh;  ///< path, relative to the scene file unless absolute
  SampleOptions sampling;
  double spacing_percent = 5;  ///< of the diagonal, when sampling.spacing and count are 0
  double scale = 1;            ///< of the model, before it is placed
  Pose place;
  Vec3 velocity = Vec3::Zero();      ///< at the start
  Vec3 spin = Vec3::Zero();          ///< angular velocity at the start about the middle of its box, rad/s
  std::optional<Material> material;  ///< its own; none: the scene's
};

/// Nodes in a box that are held, and moved.
struct Grip {
  Vec3 lo, hi;           ///< material coordinates
  Motion motion;         ///< of the box's middle, relative to where it was; none: stays
  bool release = false;  ///< lets go after the last key
  Vec3 middle() const { return 0.5 * (lo + hi); }
};

/// A rigid edge that cuts where it moves, with what is behind it.
struct Blade {
  std::string name;
  std::vector<Vec3> points;  ///< the edge, in its own coordinates
  bool closed = false;
  Motion motion;             ///< at least two keys; the blade is there from the first to the last
  Vec3 back = Vec3::Zero();  ///< from the edge to the back of the blade, in its own coordinates; its length is the
                             ///< blade's width
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
  TriangleMesh mesh;            ///< in its own coordinates; empty: a plane through its origin
  Vec3 normal = Vec3::UnitZ();  ///< of the plane, where bodies may be
  double scale = 1;             ///< of the mesh, before it is placed
  Pose place;
  Motion motion;           ///< of what was placed; none: stays
  double stiffness = 1e5;  ///< of its penalty: acceleration per depth, 1/s²
  double friction = 0.5;   ///< Coulomb's coefficient

  /// World = pose · scaled. Before its first key and after its last one it stands still.
  Pose pose(double time) const;
};

struct Scene {
  std::vector<SceneBody> bodies;  ///< one at least
  int k = 26;
  Material material;          ///< of bodies that have none of their own
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
  std::uint64_t fingerprint = 0;   ///< of all that decides what the run computes; 0: not from a file
};

}  // namespace geo
