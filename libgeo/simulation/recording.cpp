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
  scene.stitches = now.stitches;
  scene.changes = now.changes;
  std::erase_if(scene.blades, [](const Blade& b) { return b.motion.keys.size() < 2; });
  std::erase_if(scene.pulls, [](const Pull& p) { return p.motion.keys.size() < 2; });
  scene.blows = now.blows;
  std::stable_sort(scene.blows.begin(), scene.blows.end(),
                   [](const Blow& a, const Blow& b) { return a.time < b.time; });
  scene.frames = std::max(1, run.state().frame);
  if (!scene.blows.empty() && scene.blows.back().time >= run.state().time) ++scene.frames;  // one that shows it
  return scene;
}

}  // namespace geo
