// The simulation loop (§ 3.3, § 4): blades move, cracks grow, the body is split, nodes and surface
// move.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "kerf/body.h"
#include "kerf/contact.h"
#include "kerf/crack.h"
#include "kerf/glue.h"
#include "kerf/mesh.h"
#include "kerf/progress.h"
#include "kerf/scene.h"
#include "kerf/solid.h"
#include "kerf/vec.h"

namespace geo {

// ---- State of a run between two frames; statistics of a frame: counts, and seconds by phase

/// A front that a blade's edge leaves, with the edge parameter of each of its points (§ 5.1).
struct EdgeFront {
  FrontState front;
  std::vector<double> at;  ///< per point, ascending: i + t lies between the blade's points i and i + 1
  bool is_left = false;    ///< the edge is elsewhere, and goes on here when it comes back through its cut
};

/// The front of a crack that grows by stress. The growth direction at point i is tangent × normal,
/// where the tangent follows the order of the points.
struct GrowingFront {
  FrontState front;
  std::vector<Vec3> normal;         ///< per point: of the crack plane, unit, material coordinates
  std::vector<double> owed;         ///< per point: growth that is due but not made, model units
  std::vector<std::uint8_t> ended;  ///< per point: 1 where it has reached a surface, skin or crack
  double length = 0;                ///< largest growth of a point since the front started or branched

  /// Number of points.
  std::size_t size() const { return front.points.size(); }
  /// True where point i is inside the material and may grow.
  bool live(std::size_t i) const { return !ended[i] && front.points[i].id.valid(); }
};

/// Cracks that grow by stress, between two time steps.
struct FractureState {
  std::vector<GrowingFront> fronts;  ///< inside the material, growing or arrested
  std::int32_t cracks = 0;           ///< number of cracks started so far, branches included
};

/// Where a growing front is.
struct CrackTip {
  std::int32_t crack = 0;  ///< number of the crack behind it
  Vec3 at = Vec3::Zero();  ///< mean of its points in the material, material coordinates
  double length = 0;       ///< largest growth of a point since the front started or branched, model units
};

/// Statistics of fracture by stress.
struct FractureStats {
  std::size_t begun = 0;            ///< cracks started
  std::size_t divided = 0;          ///< branches
  std::size_t advanced = 0;         ///< steps of fronts
  std::size_t refused = 0;          ///< steps that could not be made
  std::size_t broken = 0;           ///< glued bonds broken
  double broken_area = 0;           ///< of these, undeformed, model units²
  double spent = 0;                 ///< energy that the tractions of broken bonds have taken, J
  std::vector<CrackTip> tips = {};  ///< fronts at the frame's end
};

/// Shape of the sheets that blades cut. Largest values of the frame, or of the run.
struct SheetStats {
  double deviation = 0;        ///< of the surface that an edge sweeps, mapped into the material, from the sheet;
                               ///< node spacings
  double turning = 0;          ///< angle between neighbouring faces, degrees; without faces lower than a tenth of a
                               ///< spacing
  std::size_t retreating = 0;  ///< front points held, because their edge goes back in its own cut
  std::size_t crumbs = 0;      ///< pieces with less than a tenth of a node's volume, at the frame's end
};

/// Statistics of a frame, or of a run.
struct FrameStats {
  SplitStats split;  ///< cutting: complex, graph, sampling, binding
  FractureStats fracture;
  ContactStats contact;
  SheetStats sheet;
  std::size_t refused = 0;       ///< crack steps that could not be made
  std::size_t fronts = 0;        ///< steps of blade fronts tried
  std::size_t newton = 0;        ///< Newton iterations
  std::size_t cg = 0;            ///< conjugate-gradient iterations
  std::size_t steps = 0;         ///< time steps
  std::size_t blows = 0;         ///< since the frame before
  std::size_t blow_parts = 0;    ///< that the blows made of the pieces that they hit
  double fracture_seconds = 0;   ///< stresses and plans, without the splits
  double front_seconds = 0;      ///< mapping of blades into the material, as far as it is not beside contact
  double mechanics_seconds = 0;  ///< after a cut, points of the solid count in the next frame, as far as they are not
                                 ///< beside contact
  double contact_seconds = 0, write_seconds = 0;
  double energy = 0;                  ///< elastic, J, at the frame's end
  double kinetic = 0;                 ///< kinetic energy, J, at the frame's end
  double weight = 0;                  ///< energy of weight, J, at the frame's end; 0 where nothing has moved
  std::vector<Vec3> blade_force;      ///< per blade: exerted by the material, N, mean over the frame
  double work = 0;                    ///< of loads, supports, pulls, stitches and blades on the bodies, J
  double cut_energy = 0;              ///< that the resistance to blades has taken, J
  std::vector<Vec3> support_force;    ///< per support: exerted by the material along its axes, N, mean over the frame
  std::vector<Vec3> pull_force;       ///< per pull: exerted by the material, N, mean over the frame
  std::vector<double> stitch_force;   ///< per stitch: tension of the thread, N, mean over the frame
  std::vector<Vec3> obstacle_force;   ///< per obstacle, then the ground: exerted by the bodies, N, mean
  std::vector<Vec3> obstacle_torque;  ///< likewise: about the obstacle's origin, N m
  /// Adds counts, seconds, work; takes energy, forces, tips and crumbs of `o`, the larger deviation
  /// and turning.
  FrameStats& operator+=(const FrameStats& o);
  /// Seconds of all phases of cutting.
  double split_seconds() const;
  /// Seconds of all phases.
  double phase_seconds() const;
};

/// For how long nodes have been where they are (Scene::sleep). Nodes may lack at the end.
struct RestState {
  std::vector<Vec3> anchor;  ///< per node: the displacement that it stays near, model units
  std::vector<double> time;  ///< per node: s, the same for all nodes of a component of the graph
};

/// All that a run needs to continue, in addition to its body.
struct RunState {
  State motion;
  RestState rest;
  std::vector<std::vector<EdgeFront>> fronts;  ///< per blade: a front for each part of the edge that cuts
  FractureState fracture;
  GluedBonds glued;                       ///< walls of glued scores
  std::vector<Vec3> surface;              ///< position of each living surface vertex, ascending by id; empty without
                                          ///< self-contact and before the first frame
  std::vector<std::uint32_t> body_index;  ///< per node: its body of the scene
  double time = 0;                        ///< s
  int frame = 0;                          ///< frames computed so far
  FrameStats total;                       ///< counts since the run began; seconds since the program started
};

// ---- The run

/// The models of a scene's bodies in the world. The bodies never see each other's nodes, so one
/// Body holds them all.
struct PlacedModels {
  TriangleMesh all;                  ///< all bodies, in their order; attributes only where there is one body
  std::vector<TriangleMesh> bodies;  ///< one for each body of the scene
  /// Pairs of bodies that touched, ascending, and the gap that was made between their surfaces, m.
  std::vector<std::pair<std::uint32_t, std::uint32_t>> touching{};
  double gap = 0;
};

/// Places one mesh for each of scene.bodies; each is a valid model (require_solid()). Bodies that
/// touch, or overlap by rounding alone, are moved apart where they do, by a ten-thousandth of the
/// mean edge. Throws InputError where the numbers of meshes and bodies differ. Also where two
/// bodies overlap, or lie in each other: the message names both and says how deep.
PlacedModels place_models(const Scene& scene, std::vector<TriangleMesh> meshes);

/// A line for the user that names the bodies that touched; empty where none did.
std::string touching_note(const Scene& scene, const PlacedModels& models);

/// The scene's obstacles at a time in seconds, as one mesh, for pictures. A plane is shown as a
/// square near the bodies' initial places, 1.5 times as wide. Empty where the scene has none.
TriangleMesh place_obstacles(const Scene& scene, const PlacedModels& models, double time);

/// A run before its first step.
struct RunStart {
  Body body;
  RunState state;
};

/// Samples the models, builds the body, inserts the scene's prescored cracks and finds its
/// prestretch. Throws InputError where the models do not fit the scene, GeometryError where a
/// prescored crack cannot be inserted, or loaded bodies do not come to rest.
RunStart begin_run(const Scene& scene, const PlacedModels& models, const Progress& progress = {});

/// A run: a scene, its body, and the state of motion, fronts and contact. The result is the same
/// for any number of threads.
class Simulation {
 public:
  /// A new run; throws as begin_run().
  Simulation(const Scene& scene, const PlacedModels& models, const Progress& progress = {});
  /// A new run of a scene with one body, which stands where it was modelled.
  Simulation(const Scene& scene, const TriangleMesh& solid, const Progress& progress = {});
  /// Continues a run from a checkpoint's body and state. Without body indices, all nodes belong to
  /// the first body. Throws InputError where the state does not fit the scene.
  Simulation(const Scene& scene, Body body, RunState state);
  /// Takes the run of `other`, which must not be used afterwards.
  Simulation(Simulation&& other) noexcept;
  /// Likewise.
  Simulation& operator=(Simulation&& other) noexcept;
  ~Simulation();

  /// Continues this run from its own checkpoint, as read back from a file. The result equals that
  /// of a new Simulation(scene, body, state); shape functions are kept if nothing was cut since
  /// they were built. Throws InputError as the constructor.
  void restore(Body body, RunState state);

  /// Makes time steps up to the next frame. A crack step that cannot be made is counted, and tried
  /// again in the next time step. Throws GeometryError where a position is no longer finite, or
  /// where a blow of the scene breaks nothing,
  /// Interrupted where `progress` requests it.
  FrameStats advance_frame(const Progress& progress = {});

  class Handle;
  class GripHandle;
  class PullHandle;
  class StitchHandle;
  /// The blade with this index in the scene. Throws std::out_of_range without one; so do the
  /// others.
  Handle blade(std::size_t index);
  /// The obstacle with this index.
  Handle obstacle(std::size_t index);
  /// The grip with this index.
  GripHandle grip(std::size_t index);
  /// The pull with this index.
  PullHandle pull(std::size_t index);
  /// The stitch with this index.
  StitchHandle stitch(std::size_t index);

  /// Adds a blade with the motion of a scene. A run of a scene that has had the blade from the
  /// start gives the same frames, to the bit, if its first key is not earlier than the present
  /// time. Throws InputError for fewer than two points, or three where it is closed.
  Handle add_blade(Blade blade);
  /// Adds a blade that is at `pose` now, and cuts once it is driven.
  Handle add_blade(Blade blade, const Pose& pose);
  /// Adds a grip; see add_blade(). It holds nothing before the present time.
  GripHandle add_grip(Grip grip);
  /// Adds a pull; see add_blade(). Throws InputError for a node that does not exist.
  PullHandle add_pull(Pull pull);
  /// Adds a pull whose other end is here now, world, and which pulls once it is driven.
  PullHandle add_pull(Pull pull, const Vec3& end);
  /// Adds a stitch that is made now, to which stitch.from is set. Where it has no slack, that is
  /// the distance of its ends now. Throws InputError for a node that does not exist.
  StitchHandle add_stitch(Stitch stitch);
  /// Breaks the piece that is hit, at the present time, to which blow.time is set. A run of a scene
  /// that has had the blow from the start gives the same frames, to the bit. Throws InputError
  /// where a blade is in the body, or for less than 2 cells; GeometryError where the piece does not
  /// break. The run is then as it was.
  void strike(Blow blow);
  /// Changes values from the present time on, up to the scene's next change of the same value;
  /// change.time is set to it. Throws InputError for values that a scene may not have.
  void change(SceneChange change);

  /// The deformed two-sided surface with patch, site and source: by Eq. 1, or as far as contact
  /// lets it follow Eq. 1. With `model`, the surface that the run began with, it also carries the
  /// model's attributes except normals, which deformation changes.
  TriangleMesh surface(const TriangleMesh* model = nullptr) const;
  /// The body in material coordinates.
  const Body& body() const;
  /// Motion, fronts and time.
  const RunState& state() const;
  /// The mechanics of the nodes: energy, stress, fields. After a cut, updates the solid's points
  /// first, if the next frame has not yet. So call it anew after each frame. Several threads may
  /// call it, but not tasks of one parallel loop.
  const Solid& solid() const;
  /// The scene with all that was added, moved and changed, and with the values that hold now.
  const Scene& scene() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// A blade, grip or obstacle of a run, which a program may move between two frames. Valid as long
/// as the run; copies are the same object. Checkpoints do not hold motions: drive it again after
/// Simulation::restore() of a new run.
class Simulation::Handle {
 public:
  /// The kinds of objects that move.
  enum class Kind { blade, grip, obstacle };
  /// For Simulation alone.
  Handle(Impl& run, Kind kind, std::size_t index);

  /// Its index in the scene.
  std::size_t index() const { return index_; }
  /// Its motion, with all that drive_to() has added.
  const Motion& motion() const;
  /// Where it is now, relative as in the scene's motions.
  Pose pose() const;
  /// Moves it from there straight to `pose` by the end of the next frame. Its keys up to now stay,
  /// later ones go, also those of a call before in the same frame. A blade cuts on its way. Unless
  /// it is driven on, it is removed after that frame, while grips and obstacles stay at `pose`. A
  /// blade that was removed begins anew where it was.
  void drive_to(const Pose& pose);

 protected:
  /// The run.
  Impl& run() const { return *run_; }

 private:
  Impl* run_;
  Kind kind_;
  std::size_t index_;
};

/// A grip of a run.
class Simulation::GripHandle : public Handle {
 public:
  /// For Simulation alone.
  GripHandle(Impl& run, std::size_t index) : Handle(run, Kind::grip, index) {}
  /// Lets go at the present time, if it has not yet.
  void end();
};

/// A pull of a run.
class Simulation::PullHandle {
 public:
  /// For Simulation alone.
  PullHandle(Impl& run, std::size_t index);
  /// Its index in the scene.
  std::size_t index() const { return index_; }
  /// Where the end is now that is not in the material, world.
  Vec3 end() const;
  /// Moves that end from there straight to `position` by the end of the next frame, as
  /// Handle::drive_to() does with a blade.
  void drive_to(const Vec3& position);

 private:
  Impl* run_;
  std::size_t index_;
};

/// A stitch of a run.
class Simulation::StitchHandle {
 public:
  /// For Simulation alone.
  StitchHandle(Impl& run, std::size_t index);
  /// Its index in the scene.
  std::size_t index() const { return index_; }
  /// Cuts the thread at the present time, if it is not cut yet.
  void end();

 private:
  Impl* run_;
  std::size_t index_;
};

/// The scene that a run began with, and all that was added, driven and changed since. A run of it
/// has the same frames, to the bit, if it goes on from a checkpoint after the same frames
/// (Scene::checkpoints). Blades and pulls with fewer than two keys, which have not existed, are
/// left out. Not for runs that have driven blades which were removed, or objects off their
/// keyframes.
Scene recording_of(const Scene& original, const Simulation& run);

}  // namespace geo
