#include "simulation/run_state.h"

#include "kerf/crack.h"
#include "kerf/error.h"

namespace geo {
namespace {

// Cracks that are there before time begins: fronts step by step, sheets whole.
void score(const Scene& scene, Beginning& run, const Progress& progress) {
  const auto adopt = [&](const BodyDelta& delta) {
    for (const NodeId d : delta.donors) run.state.part.push_back(std::uint32_t(run.state.part[d.index()]));
  };
  CrackOptions options;
  options.seed = scene.seed;
  for (std::size_t s = 0; s < scene.scores.size(); ++s) {
    const Front& front = scene.scores[s];
    const std::int32_t crack = run.body.surface.crack_count() + 1;
    if (front.is_sheet()) {
      report(progress, "prescoring", s, scene.scores.size());
      TriangleMesh sheet;
      sheet.vertices = front.steps[0], sheet.triangles = front.triangles;
      Complex scored = run.body.surface;
      insert_sheet(scored, sheet, crack);
      adopt(follow(run.body, scored));
      continue;
    }
    FrontState state = begin_front(front.steps.at(0), front.closed, crack);
    for (std::size_t k = 1; k < front.steps.size(); ++k) {
      report(progress, "prescoring", s, scene.scores.size());
      try {
        adopt(split(run.body, state, correspond(front.steps[0], front.steps[k], front.closed), options));
      } catch (const GeometryError&) {
        throw GeometryError("step " + std::to_string(k) + " of the prescored front '" + front.name +
                            "' cannot be made");
      }
    }
  }
}

void begin_motion(const Scene& scene, const Body& body, RunState& state) {
  const std::size_t n = body.nodes.size();
  std::vector<Box3> box(scene.bodies.size());
  for (std::size_t i = 0; i < n; ++i) box[state.part[i]].add(body.nodes.position[i]);
  state.motion.displacement.assign(n, Vec3::Zero());
  for (std::size_t i = 0; i < n; ++i) {
    const SceneBody& of = scene.bodies[state.part[i]];
    state.motion.velocity.push_back(of.velocity + of.spin.cross(body.nodes.position[i] - box[state.part[i]].center()));
  }
}

}  // namespace

Beginning begin_run(const Scene& scene, const Model& model, const Progress& progress) {
  Beginning run;
  run.body = build_model(scene, model, run.state.part, progress);
  run.state.fronts.resize(scene.blades.size());
  score(scene, run, progress);
  begin_motion(scene, run.body, run.state);
  return run;
}

}  // namespace geo
