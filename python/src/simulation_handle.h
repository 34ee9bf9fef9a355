// One blade, grip, obstacle, pull or stitch of a run, as Python holds it.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "arrays.h"
#include "simulation.h"

namespace kerf_python {

/// Kinds of objects that act on the bodies of a run.
enum class Kind { blade, grip, obstacle, pull, stitch };

/// One object of a run, which it keeps alive.
template <Kind kind>
struct Handle {
  std::shared_ptr<Simulation> simulation;
  std::size_t index;
};

/// The objects of a kind in a scene.
template <Kind kind>
const auto& objects_of(const geo::Scene& scene) {
  if constexpr (kind == Kind::blade)
    return scene.blades;
  else if constexpr (kind == Kind::grip)
    return scene.grips;
  else if constexpr (kind == Kind::obstacle)
    return scene.obstacles;
  else if constexpr (kind == Kind::pull)
    return scene.pulls;
  else
    return scene.stitches;
}

/// The object itself. To be called while the run is not changed.
template <Kind kind>
const auto& scene_object(const Handle<kind>& handle) {
  return objects_of<kind>(handle.simulation->run().scene())[handle.index];
}

/// The force on an object in the last frame, (3,) float64; zero on one that was added since.
/// `forces`: on all objects of its kind.
inline py::array last_force(const std::vector<geo::Vec3>& forces, std::size_t index) {
  return point(index < forces.size() ? forces[index] : geo::Vec3(geo::Vec3::Zero()));
}

/// Throws geo::InputError unless the last key of a motion is at the present time: keys after a
/// pause would let the object have existed meanwhile. `what`: the object, for the message.
void require_present_end(const geo::Motion& motion, const geo::RunState& now, const char* what);

}  // namespace kerf_python
