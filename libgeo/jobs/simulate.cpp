// simulate() of kerf/jobs.h.
#include <string>
#include <utility>

#include "kerf/check.h"
#include "kerf/error.h"
#include "kerf/files.h"
#include "kerf/jobs.h"

namespace geo {
namespace {

// A model of a scene, which is in metres: kerf-sim and Python's Simulation treat it alike. The
// images of its materials would be in each frame.
void make_scene_model(TriangleMesh& mesh, const std::string& name) {
  try {
    require_solid(mesh);
  } catch (const InputError& e) {
    throw InputError(name + ": " + e.what());
  }
  if (mesh.two_sided()) throw InputError(name + ": is a cut surface; a scene begins with whole models");
  mesh.attributes.library = {};
  mesh.unit = mesh.unit > 0 ? 1 : 0;
}

Simulation run_to_the_end(Simulation run, int frames, const FrameSink& sink, const Progress& progress) {
  while (run.state().frame < frames) {
    const FrameStats stats = run.advance_frame(progress);
    if (sink && !sink(run, stats)) break;
  }
  return run;
}

}  // namespace

Simulation simulate(const Scene& scene, const FrameSink& sink, const Progress& progress) {
  std::vector<TriangleMesh> models;
  for (const SceneBody& body : scene.bodies) models.push_back(read_surface(body.mesh).mesh);
  return simulate(scene, std::move(models), sink, progress);
}

Simulation simulate(const Scene& scene, std::vector<TriangleMesh> models, const FrameSink& sink,
                    const Progress& progress) {
  for (std::size_t i = 0; i < models.size(); ++i)
    make_scene_model(models[i], i < scene.bodies.size() && !scene.bodies[i].mesh.empty()
                                    ? scene.bodies[i].mesh
                                    : "model " + std::to_string(i));
  return run_to_the_end(Simulation(scene, place_models(scene, std::move(models)), progress), scene.frames, sink,
                        progress);
}

}  // namespace geo
