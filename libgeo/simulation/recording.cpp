// recording_of() of kerf/simulation.h.
#include <algorithm>

#include "kerf/simulation.h"

namespace geo {

Scene recording_of(const Scene& original, const Simulation& run) {
  Scene scene = original;
  const Scene& now = run.scene();
  scene.blades = now.blades;
  scene.grips = now.grips;
  scene.pulls = now.pulls;
  scene.changes = now.changes;
  std::erase_if(scene.blades, [](const Blade& b) { return b.motion.keys.size() < 2; });
  std::erase_if(scene.pulls, [](const Pull& p) { return p.motion.keys.size() < 2; });
  scene.frames = std::max(1, run.state().frame);
  return scene;
}

}  // namespace geo
