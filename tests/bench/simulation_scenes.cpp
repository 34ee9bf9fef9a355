// Frames a second of the scenes of samples/scenes with blades, at their own size and far beyond it.
#include <cstdio>

#include "bench.h"
#include "kerf/check.h"
#include "kerf/files.h"
#include "kerf/mesh.h"
#include "kerf/progress.h"
#include "kerf/simulation.h"

namespace bench {
namespace {

struct Case {
  std::string name, scene;
  std::vector<geo::TriangleMesh> models;
  int nodes = 0;  // of each body; 0: as the scene says
};

std::vector<geo::TriangleMesh> letters(int resolution) {
  std::vector<geo::TriangleMesh> models;
  for (const char letter : {'K', 'E', 'R', 'F'}) models.push_back(geo::make_letter(letter, 0.25, resolution));
  return models;
}

// Models are those of samples/scenes/run; the large ones have as many triangles for a node.
std::vector<Case> cases() {
  return {{"polyp", "polyp", {geo::make_polyp(8)}},
          {"apple", "apple", {geo::make_apple(18)}},
          {"jello", "jello", {geo::make_block({2, 1, 1}, 0.08)}},
          {"letters", "letters", letters(24)},
          {"halve", "halve", {geo::make_pumpkin(22)}},
          {"apple_50k", "apple", {geo::make_apple(50)}, 50000},
          {"letters_108k", "letters", letters(70), 27000}};
}

// The keys that give each body a number of nodes.
std::vector<std::pair<std::string, std::string>> changes_of(const Case& c) {
  std::vector<std::pair<std::string, std::string>> changes;
  for (std::size_t i = 0; c.nodes > 0 && i < c.models.size(); ++i)
    changes.emplace_back(c.models.size() == 1 ? "body.nodes" : "body." + std::to_string(i) + ".nodes",
                         std::to_string(c.nodes));
  return changes;
}

}  // namespace

void simulation_scenes(bool json, Figures& figures) {
  for (Case& c : cases()) {
    const std::string folder = KERF_SCENES;
    const geo::Scene scene =
        geo::parse_scene(geo::read_all(folder + "/" + c.scene + ".toml"), c.scene, changes_of(c), folder);
    geo::Simulation run(scene, geo::place_models(scene, std::move(c.models)));
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
