// begin_run() of kerf/simulation.h. Order: sample and build the body, insert the prescored cracks,
// then assign velocities. Nodes that a crack inserts belong to the body of their donor.
#include "kerf/crack.h"
#include "kerf/error.h"
#include "kerf/simulation.h"
#include "simulation/scene_body.h"

namespace geo {
namespace {

void follow_donors(const BodyDelta& delta, RunState& state) {
  for (const NodeId d : delta.donors) state.body_index.push_back(std::uint32_t(state.body_index[d.index()]));
}

void insert_scored_sheet(const Front& sheet, std::int32_t crack, RunStart& run) {
  TriangleMesh mesh;
  mesh.vertices = sheet.steps[0];
  mesh.triangles = sheet.triangles;
  Complex scored = run.body.surface;
  insert_sheet(scored, mesh, crack);
  follow_donors(update_body(run.body, scored), run.state);
}

// Inserts the scene's prescored cracks: fronts step by step, sheets whole.
void prescore(const Scene& scene, RunStart& run, const Progress& progress) {
  CrackOptions options;
  options.seed = scene.seed;
  for (std::size_t s = 0; s < scene.scores.size(); ++s) {
    const Front& front = scene.scores[s];
    const std::int32_t crack = run.body.surface.crack_count() + 1;
    if (front.is_sheet()) {
      report(progress, "prescoring", s, scene.scores.size());
      insert_scored_sheet(front, crack, run);
      continue;
    }
    FrontState state = begin_front(front.steps.at(0), front.closed, crack);
    for (std::size_t k = 1; k < front.steps.size(); ++k) {
      report(progress, "prescoring", s, scene.scores.size());
      try {
        follow_donors(split(run.body, state, resample_front(front.steps[0], front.steps[k], front.closed), options),
                      run.state);
      } catch (const GeometryError&) {
        throw GeometryError("step " + std::to_string(k) + " of the prescored front '" + front.name +
                            "' cannot be made");
      }
    }
  }
}

// Initial velocities: each body's own, and its spin about the centre of its nodes' box.
void begin_motion(const Scene& scene, const Body& body, RunState& state) {
  const std::size_t n = body.nodes.size();
  std::vector<Box3> box(scene.bodies.size());
  for (std::size_t i = 0; i < n; ++i) box[state.body_index[i]].add(body.nodes.position[i]);
  state.motion.displacement.assign(n, Vec3::Zero());
  for (std::size_t i = 0; i < n; ++i) {
    const auto b = state.body_index[i];
    const SceneBody& own = scene.bodies[b];
    state.motion.velocity.push_back(own.velocity + own.spin.cross(body.nodes.position[i] - box[b].center()));
  }
}

}  // namespace

RunStart begin_run(const Scene& scene, const PlacedModels& models, const Progress& progress) {
  RunStart run;
  run.body = build_scene_body(scene, models, run.state.body_index, progress);
  run.state.fronts.resize(scene.blades.size());
  prescore(scene, run, progress);
  begin_motion(scene, run.body, run.state);
  return run;
}

}  // namespace geo
