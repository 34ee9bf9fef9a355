// Frames a second of the scenes of samples/scenes with blades, at their own size and far beyond it.
#include <cstdio>

#include "bench.h"
#include "kerf/check.h"
#include "kerf/progress.h"
#include "kerf/simulation.h"
#include "sample_scenes.h"

namespace bench {
namespace {

struct Case {
  std::string name, scene;
  int fineness = 0, nodes = 0;  // of the models, as for sample_models(); of each body; 0: as the scene says
};

// The large ones have as many triangles for a node.
const Case cases[] = {{"polyp", "polyp"},
                      {"apple", "apple"},
                      {"jello", "jello"},
                      {"letters", "letters"},
                      {"halve", "halve"},
                      {"apple_50k", "apple", 50, 50000},
                      {"letters_108k", "letters", 70, 27000}};

// The keys that give each of some bodies a number of nodes.
geo::SceneOverrides changes_of(const Case& c, std::size_t bodies) {
  geo::SceneOverrides changes;
  for (std::size_t i = 0; c.nodes > 0 && i < bodies; ++i)
    changes.emplace_back(bodies == 1 ? "body.nodes" : "body." + std::to_string(i) + ".nodes", std::to_string(c.nodes));
  return changes;
}

}  // namespace

void simulation_scenes(bool json, Figures& figures) {
  for (const Case& c : cases) {
    std::vector<geo::TriangleMesh> models = sample_models(c.scene, c.fineness);
    const geo::Scene scene = sample_scene(c.scene, changes_of(c, models.size()));
    geo::Simulation run(scene, geo::place_models(scene, std::move(models)));
    geo::FrameStats total;
    std::size_t crossings = 0;
    double seconds = 0;
    for (int f = 0; f < scene.frames; ++f) {
      geo::Stopwatch watch;
      total += run.advance_frame();
      seconds += watch.lap();
      crossings += geo::count_crossings(run.surface());
    }
    if (!json)
      std::fprintf(stderr, "%s: %d frames, %.1f a second; mechanics %.2f s, contact %.2f s\n", c.name.c_str(),
                   scene.frames, scene.frames / seconds, total.mechanics_seconds, total.contact_seconds);
    figures["frames_per_second_" + c.name] = scene.frames / seconds;
    figures["crossings_" + c.name] = double(crossings);
    figures["refused_" + c.name] = double(total.refused);
    figures["crumbs_" + c.name] = double(total.sheet.crumbs);
  }
}

}  // namespace bench
