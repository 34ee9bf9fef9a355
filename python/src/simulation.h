// Runs of the module: they advance by frames, and hand out snapshots of their state.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "busy.h"
#include "kerf/simulation.h"
#include "mesh.h"
#include "scene.h"

namespace kerf_python {

/// The models of a run, placed, and the hash that checkpoints keep.
struct RunModels {
  geo::PlacedModels placed;
  std::uint64_t fingerprint = 0;  ///< of the scene and its models, as kerf-sim computes it
};

/// The models of a scene: the meshes given, or the files that the scene names. Throws
/// geo::InputError where one is no valid solid, or bodies intersect.
RunModels models_of(const geo::Scene& scene, const std::vector<std::shared_ptr<const Mesh>>& given);

/// A run, always between two frames. Every use holds `busy`.
class Simulation : public std::enable_shared_from_this<Simulation> {
 public:
  /// A new run. Like kerf-sim it begins with what its first checkpoint holds. Throws as
  /// geo::begin_run().
  Simulation(std::shared_ptr<const Scene> source, RunModels run_models, const geo::Progress& progress);
  /// Continues the run of a checkpoint. `scene`: with the motions at that time. Throws
  /// geo::InputError where it belongs to another scene.
  Simulation(std::shared_ptr<const Scene> source, RunModels run_models, const geo::Scene& scene,
             const std::string& checkpoint);

  /// The run. Throws geo::GeometryError where it has failed.
  geo::Simulation& run();
  /// Makes the next frame; passes every checkpoint_every-th one through a checkpoint in memory, as
  /// kerf-sim does, so that a resumed run has the same bytes. A stop takes effect at the end of the
  /// frame.
  geo::FrameStats advance(const geo::Progress& progress);
  /// The bytes of a checkpoint, with which this run continues, too.
  std::string checkpoint();
  /// The scene with all that was added and changed since the run began: it gives this run, to the
  /// bit. Paths are absolute. Throws geo::InputError where it is not possible.
  geo::Scene recording();
  /// Drops the snapshots; to be called, with the GIL, by every change.
  void changed();

  std::shared_ptr<const Scene> scene;
  RunModels models;
  geo::FrameStats last;  ///< of the last frame
  bool acted = false;    ///< whether something was added or changed that the scene does not have
  Busy busy;
  py::object positions, displacement, velocities, stress, surface, body, state;  ///< null until made
  std::string unrecordable;  ///< why recording() is not possible; empty where it is

 private:
  std::string go_on_from_checkpoint(std::uint64_t fingerprint);

  std::optional<geo::Simulation> run_;
  std::string failure_;
  std::vector<int> checkpoints_;  // frames after which save() was called, ascending
};

/// Adds what reads the state of a run.
void add_views(py::class_<Simulation, std::shared_ptr<Simulation>>& simulation);
/// Adds blades, grips and obstacles.
void add_handles(py::module_& module, py::class_<Simulation, std::shared_ptr<Simulation>>& simulation);
/// Adds what a program adds to a run and changes in it, and the recording of that.
void add_hands(py::module_& module, py::class_<Simulation, std::shared_ptr<Simulation>>& simulation);

}  // namespace kerf_python
