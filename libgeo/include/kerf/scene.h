// A scene: bodies and their materials, blades, grips, obstacles, fracture, contact, and time
// stepping.
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "kerf/contact.h"
#include "kerf/crack.h"
#include "kerf/material.h"
#include "kerf/mesh.h"
#include "kerf/nodes.h"
#include "kerf/solid.h"
#include "kerf/vec.h"

namespace geo {

/// Placement of a rigid object: world = position + rotation · local.
struct Pose {
  Vec3 position = Vec3::Zero();
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
  /// Maps a point from local to world coordinates.
  Vec3 operator*(const Vec3& local) const { return position + rotation * local; }
};

/// Rigid motion by keyframes.
struct Motion {
  struct Key {
    double time = 0;  ///< s
    Vec3 position = Vec3::Zero();
    Vec3 axis = Vec3::UnitZ();  ///< of the rotation; not zero
    double angle = 0;           ///< degrees about the axis
  };
  std::vector<Key> keys;  ///< ascending in time; empty: the object does not move

  /// True between the first and the last key, both included. False with fewer than two keys.
  bool active(double time) const { return keys.size() > 1 && time >= keys.front().time && time <= keys.back().time; }
  /// Pose at a time in seconds. Positions are interpolated linearly. Rotations are interpolated by
  /// angle where both keys have the same axis (whole turns included), else spherically. Constant
  /// before the first and after the last key; the identity without keys.
  Pose at(double time) const;
};

// ---- Fracture by stress: cracks that start and grow without a blade. Initiation by the largest
// principal stress (O'Brien and Hodgins 1999), growth by the largest hoop stress of the stress
// intensities at the front (Erdogan and Sih 1963). Symbols: K_Ic critical stress intensity, h
// support radius of the nodes.

/// Resistance of a material to fracture.
struct Strength {
  double strength = 1e4;  ///< Pa: largest principal stress, averaged over h, at which a crack starts
  double toughness = 0;  ///< Pa √m: K_Ic at which a crack grows; 0: strength · √(π h/2), h at the front, of cells
                         ///< the finest spacing of nodes
  double variation = 0.2;  ///< both times max(0.05, 1 + variation · noise), noise in about [−1, 1]
  double grain = 0;        ///< length scale of the noise, model units; 0: a tenth of the diagonal of all bodies
  friend bool operator==(const Strength&, const Strength&) = default;
};

/// How a body breaks: by cracks that grow with fronts of their own, or along the walls of cells.
/// Those enclose every piece before it comes off.
struct Breakage : Strength {
  int cells = 0;      ///< of a random tessellation of the body, whose walls break by their load; 0: fronts
  double jagged = 0;  ///< height of the walls' bumps, as a fraction of the body's diagonal
  /// Whether cracks have fronts.
  bool has_fronts() const { return cells < 2; }
  friend bool operator==(const Breakage&, const Breakage&) = default;
};

/// Parameters of fracture by stress. The inherited breakage is the default of all bodies.
struct FractureOptions : Breakage {
  bool on = false;
  std::vector<Breakage> per_body;        ///< one for each body of the scene; empty: all have the default
  double speed = 0.55;                   ///< largest crack speed over the Rayleigh wave speed
  double branching = 0;                  ///< a front branches above this ratio of stress to resistance; 0: never
  double separation = 4;                 ///< smallest distance between two crack starts, in node spacings
  int max_cracks = 24;                   ///< cracks that may start in a run, branches included
  int cracks_per_step = 1;               ///< cracks that may start in a time step
  double start = 0;                      ///< s: no crack starts or grows earlier
  std::vector<std::array<Vec3, 2>> off;  ///< boxes (lowest, highest corner) without fracture, material coordinates
  std::uint64_t seed = 1;                ///< of the noise
  /// Whether any body has cracks with fronts.
  bool any_fronts() const {
    if (per_body.empty()) return has_fronts();
    return std::any_of(per_body.begin(), per_body.end(), [](const Breakage& b) { return b.has_fronts(); });
  }
  /// How a body of the scene breaks.
  const Breakage& of_body(std::size_t body) const { return per_body.empty() ? *this : per_body[body]; }
  /// The same for the body of a node. `body_index`: per node, its body of the scene.
  const Breakage& at_node(const std::vector<std::uint32_t>& body_index, std::size_t node) const {
    return of_body(per_body.empty() ? 0 : body_index[node]);
  }
};

/// How far the material of a body at rest is stretched from its state without stress, as tissue in
/// a living body is. Cuts in it open.
struct Prestretch {
  Vec3 stretch = Vec3::Ones();  ///< along the axes of the material coordinates, 1: none
  double skin = 1;              ///< further, in the plane of the skin, as far as `depth` below it
  double depth = 0;             ///< of that layer, model units
  friend bool operator==(const Prestretch&, const Prestretch&) = default;
};

/// One solid of a scene. All solids become disconnected components of one Body, whose material
/// coordinates are those of the placed models.
struct SceneBody {
  std::string name;
  std::string mesh;  ///< path of the model; from the scene file's folder unless absolute
  SampleOptions sampling;
  double spacing_percent = 5;    ///< of the model's diagonal, where sampling.spacing and count are 0
  double scale = 1;              ///< of the model, applied before the pose
  double refine = 0;             ///< longest edge of the skin, model units after scaling: see refined(); 0: as modelled
  Pose place;                    ///< of the scaled model in the world
  Vec3 velocity = Vec3::Zero();  ///< initial, model units per second
  Vec3 spin = Vec3::Zero();      ///< initial angular velocity about the centre of its nodes' box, rad/s
  std::optional<Material> material;           ///< its own; none: the scene's
  std::optional<Prestretch> prestretch = {};  ///< its own; none: the scene's
};

/// A box whose nodes are held, and moved rigidly.
struct Grip {
  Vec3 lo, hi;           ///< corners of the box, material coordinates
  Motion motion = {};    ///< of the box's centre, relative to its initial place; no keys: at rest
  bool release = false;  ///< nodes become free after the last key
  double from = -std::numeric_limits<double>::infinity();  ///< s: the grip exists after this time
  double until = std::numeric_limits<double>::infinity();  ///< s: and up to this time
  /// Whether the grip exists at the end of a time step.
  bool active(double time) const { return time > from && time <= until; }
  /// Centre of the box.
  Vec3 middle() const { return 0.5 * (lo + hi); }
};

/// A spring between a point of the material and a point that moves, as a hand holds a body. Without
/// damping of its own.
struct Pull {
  Vec3 point = Vec3::Zero();               ///< where the spring holds the body, material coordinates
  std::optional<std::uint32_t> node = {};  ///< one that sees the point: its neighbourhood is held; none: the nearest
  Motion motion = {};      ///< of the other end, world; the spring exists from the first to the last key
  double stiffness = 100;  ///< force over stretch, N/m
};

/// A thread between two points of the material, as a surgeon sews a wound: it pulls them together
/// where they are farther apart than its rest length, and lets them be otherwise. That length falls
/// linearly from `slack` to `length`. Without damping of its own.
struct Stitch {
  /// One of its ends.
  struct End {
    Vec3 point = Vec3::Zero();               ///< material coordinates
    std::optional<std::uint32_t> node = {};  ///< as Pull::node. Both sides of a cut have the same points, and
                                             ///< only their nodes tell which one is held
  };
  std::array<End, 2> ends = {};
  double stiffness = 100;                                  ///< force over stretch, N/m
  double length = 0;                                       ///< of the thread in the end, model units
  std::optional<double> slack = {};                        ///< at the beginning; none: no force acts then
  double closing = 0;                                      ///< s in which it is drawn tight
  double from = 0;                                         ///< s: it is made
  double until = std::numeric_limits<double>::infinity();  ///< s: it is cut
  /// Whether it exists during a time step, s.
  bool active(double begin, double end) const { return begin >= from && end <= until; }
  /// The rest length at a time, s. Precondition: `slack` is known.
  double rest_length(double time) const;
};

/// A force over area on the skin in a box, as a pressure or a testing machine exerts it. Faces of
/// cracks have none.
struct Load {
  Vec3 lo, hi;                                             ///< corners of the box, material coordinates
  Vec3 traction = Vec3::Zero();                            ///< Pa: over undeformed area; keeps its direction
  double from = 0;                                         ///< s: it begins
  double ramp = 0;                                         ///< s from then on in which it grows, linearly
  double until = std::numeric_limits<double>::infinity();  ///< s: it ends
  /// The share of the traction that acts at a time, from 0 to 1.
  double share(double time) const;
};

/// The skin in a box is held along some axes of the world, and is free along the others: a roller,
/// a plane of symmetry, or the jaws of a testing machine.
struct Support {
  /// Which axes.
  struct Axes {
    bool x = false, y = false, z = false;
    /// Whether axis 0, 1 or 2 is held.
    bool operator[](int axis) const { return axis == 0 ? x : axis == 1 ? y : z; }
  };
  Vec3 lo, hi;         ///< corners of the box, material coordinates
  Axes axes = {};      ///< one at least
  Motion motion = {};  ///< only its way counts, relative to the place at rest; no keys: at rest
  double from = -std::numeric_limits<double>::infinity();  ///< s: the support exists after this time
  double until = std::numeric_limits<double>::infinity();  ///< s: and up to this time
  /// Whether the support exists at the end of a time step.
  bool active(double time) const { return time > from && time <= until; }
};

/// Values of a scene that change at a time. Those that are not given stay.
struct SceneChange {
  double time = 0;                      ///< s: from the first time step on that begins then or later
  std::optional<double> young = {};     ///< Pa, of the scene's material; other materials keep their ratio to it
  std::optional<double> damping = {};   ///< of all materials, 1/s
  std::optional<Vec3> gravity = {};     ///< model units per s²
  std::optional<double> friction = {};  ///< of ground, obstacles and contact: Coulomb's coefficient
  std::optional<double> accuracy = {};  ///< as Scene::accuracy
  std::optional<double> dt = {};        ///< largest time step, s, from the next frame on
};

/// A blow between two frames: the piece that is hit breaks into cells, and its parts fly from the
/// point. Cracks that grow by stress end.
struct Blow {
  double time = 0;            ///< s: it falls before the first frame that begins then or later
  Vec3 point = Vec3::Zero();  ///< world: on the surface, or near it
  int cells = 12;             ///< of the box around the piece, 2 to 1000: the number of parts, or more than that
};

/// A rigid cutting edge, a polyline, with an optional wedge behind it.
struct Blade {
  std::string name;
  std::vector<Vec3> points;  ///< of the edge, in the blade's coordinates
  bool closed = false;
  Motion motion = {};        ///< at least two keys; the blade exists from the first to the last
  Vec3 back = Vec3::Zero();  ///< vector from the edge to the back of the blade, in its coordinates
  double thickness = 0;      ///< of the wedge at the back, model units; 0: no wedge
  double stiffness = 1e4;    ///< of the wedge: acceleration per depth, 1/s²
  double friction = 0;       ///< of the wedge's flanks: Coulomb's coefficient
  /// Energy for each undeformed area that the edge cuts, J / model unit². The material is pushed
  /// along until the edge presses with as much on its length. Sharp blades have a small one, dull
  /// ones a large one. 0: the edge parts the material without a force.
  double resistance = 0;
  double limit = 1;  ///< largest motion of an edge point in one cut, in node spacings (§ 5.1)

  /// True while the blade exists.
  bool active(double time) const { return motion.active(time); }
  /// World positions of the edge's points at a time in seconds.
  std::vector<Vec3> at(double time) const;
};

/// A rigid obstacle: a closed mesh, or the half-space below a plane.
struct SceneObstacle {
  std::string name;
  TriangleMesh mesh;            ///< in the obstacle's coordinates; empty: a plane through the origin
  Vec3 normal = Vec3::UnitZ();  ///< of the plane, towards the bodies
  double scale = 1;             ///< of the mesh, applied before the pose
  Pose place;                   ///< at rest
  Motion motion;                ///< applied to the placed obstacle; no keys: at rest
  double stiffness = 0;         ///< of the contact: acceleration per depth, 1/s²; 0: as Scene::ground_stiffness
  double friction = 0.5;        ///< Coulomb's coefficient
  std::string file = {};        ///< path that the mesh was read from; empty: from none

  /// Pose of the scaled mesh at a time in seconds; constant before the first and after the last
  /// key.
  Pose pose(double time) const;
};

/// A file with scores.
struct SceneScoreFile {
  std::string file;                   ///< path
  int body = 0;                       ///< in whose model's coordinates it is
  std::optional<Strength> glue = {};  ///< of all its sheets
};

/// A crack made before time 0, or walls that are glued and become cracks where they break.
struct SceneScore {
  Front front;                        ///< material coordinates
  std::uint32_t body = 0;             ///< whose material it cuts, where it is glued
  std::optional<Strength> glue = {};  ///< what holds its walls (a sheet); none: they are cracks from the start
};

/// All that decides what a run computes.
struct Scene {
  std::vector<SceneBody> bodies;  ///< at least one
  int k = 26;                     ///< neighbours of a node (§ 6.2)
  Material material;              ///< of bodies without one of their own
  Prestretch prestretch;          ///< likewise
  /// The models have the shape of the bodies under their load at time 0, and rest in it. Prestretch
  /// is changed so that they do.
  bool loaded = false;
  std::vector<SceneScore> scores;
  std::vector<SceneScoreFile> score_files;  ///< that `scores` were read from
  std::vector<Grip> grips;
  std::vector<Pull> pulls;
  std::vector<Stitch> stitches;
  std::vector<Blow> blows;  ///< ascending in time
  std::vector<Load> loads;
  std::vector<Support> supports;
  std::vector<SceneChange> changes;  ///< ascending in time; of equal times, the later one decides
  bool ground = false;               ///< whether there is a rigid ground plane
  Vec3 ground_point = Vec3::Zero(), ground_normal = Vec3::UnitZ();
  /// Acceleration per depth, 1/s². 0: a pressure per depth of 1000 ρ |g| + 2 E / h. Then a
  /// body of height H stands at most H / 1000 deep, and at most as deep as half of the compression
  /// between two nodes, h apart.
  double ground_stiffness = 0;
  double friction = 0.5;         ///< of the ground: Coulomb's coefficient
  Vec3 gravity = {0, 0, -9.81};  ///< model units per s²
  double frame_rate = 24;        ///< frames per second
  double dt = 1.0 / 96;          ///< largest time step, s
  double accuracy = 1e-3;        ///< of displacements in an implicit step, in node spacings
  int frames = 24;               ///< length of the run
  int checkpoint_every = 8;      ///< frames between two checkpoints
  std::vector<int> checkpoints;  ///< ascending: further frames with a checkpoint
  bool implicit = true;          ///< time steps are implicit; else leapfrog (symplectic Euler)
  ImplicitScheme scheme = ImplicitScheme::backward_euler;  ///< of implicit steps
  double sleep = 0;        ///< s: a piece that has rested for as long is not computed; 0: it always is
  std::uint64_t seed = 1;  ///< of sampling and of jitter
  std::vector<Blade> blades;
  std::vector<SceneObstacle> obstacles;
  FractureOptions fracture;
  /// Bodies touch each other and themselves: no two triangles of the surface cross in any frame.
  /// Otherwise only ground, obstacles and blades touch them.
  bool self_contact = true;
  ContactOptions contact;
  std::uint64_t fingerprint = 0;  ///< hash of all that decides what the run computes; 0: not from a file

  /// The value of the key time.integrator: "implicit", "bossak" or "leapfrog".
  std::string integrator() const;
  /// Number of equal time steps in a frame: the fewest that are at most `dt` long.
  int steps_per_frame() const;
  /// Adds a change behind those that are not later.
  void add_change(SceneChange change);
  /// Whether a checkpoint follows this frame, from which the run goes on.
  bool has_checkpoint(int frame) const;
};

}  // namespace geo
