// The simulation loop (§ 3.3, § 4): blades move, cracks grow, the body is split, nodes and surface
// move.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "kerf/body.h"
#include "kerf/mesh.h"
#include "kerf/progress.h"
#include "kerf/run.h"
#include "kerf/scene.h"
#include "kerf/solid.h"

namespace geo {

/// The models of a scene's bodies in the world. The bodies never see each other's nodes, so one
/// Body holds them all.
struct PlacedModels {
  TriangleMesh all;                  ///< all bodies, in their order; attributes only where there is one body
  std::vector<TriangleMesh> bodies;  ///< one for each body of the scene
};

/// Places one mesh for each of scene.bodies. Throws InputError where their numbers differ.
PlacedModels place_models(const Scene& scene, std::vector<TriangleMesh> meshes);

/// The scene's obstacles at a time in seconds, as one mesh, for pictures. A plane is shown as a
/// square near the bodies' initial places, 1.5 times as wide. Empty where the scene has none.
TriangleMesh place_obstacles(const Scene& scene, const PlacedModels& models, double time);

/// A run before its first step.
struct RunStart {
  Body body;
  RunState state;
};

/// Samples the models, builds the body, and inserts the scene's prescored cracks. Throws InputError
/// where the models do not fit the scene, GeometryError where a prescored crack cannot be inserted.
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
  /// again in the next time step. Throws GeometryError where a position is no longer finite,
  /// Interrupted where `progress` requests it.
  FrameStats advance_frame(const Progress& progress = {});

  /// Moves a blade, grip or obstacle (by its index in the scene) from its present pose to `pose` by
  /// the end of the next frame, in place of its keyframes. A blade cuts on its way; without further
  /// calls it is removed after that frame, while grips and obstacles stay at `pose`. Poses are
  /// relative as in the scene's motions. Throws std::out_of_range for an unknown index. Checkpoints
  /// do not hold such motions: set them again after restore().
  void move_blade(std::size_t blade, const Pose& pose);
  /// See move_blade().
  void move_grip(std::size_t grip, const Pose& pose);
  /// See move_blade().
  void move_obstacle(std::size_t obstacle, const Pose& pose);

  /// The deformed two-sided surface with patch, site and source: by Eq. 1, or as far as contact
  /// lets it follow Eq. 1. With `model`, the surface that the run began with, it also carries the
  /// model's attributes except normals, which deformation changes.
  TriangleMesh surface(const TriangleMesh* model = nullptr) const;
  /// The body in material coordinates.
  const Body& body() const;
  /// Motion, fronts and time.
  const RunState& state() const;
  /// The mechanics of the nodes: energy, stress, fields.
  const Solid& solid() const;
  /// The scene, with motions as set by move_blade(), move_grip() and move_obstacle().
  const Scene& scene() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace geo
