// begin_run() of kerf/simulation.h. Order: sample and build the body, insert the prescored cracks,
// then assign velocities. Nodes that a crack inserts belong to the body of their donor.
#include "kerf/crack.h"
#include "kerf/error.h"
#include "kerf/simulation.h"
#include "score/jagged.h"
#include "simulation/bond_breaking.h"
#include "simulation/scene_body.h"

namespace geo {
namespace {

void follow_donors(const BodyDelta& delta, RunState& state) {
  for (const NodeId d : delta.donors) state.body_index.push_back(std::uint32_t(state.body_index[d.index()]));
}

// Divides the walls of a sheet so that they can follow the deformed material where they open:
// triangles as large as cells cannot.
void refine(TriangleMesh& walls, const Body& body) {
  const Complex& complex = body.surface;
  std::vector<std::array<Vec3, 3>> skin;
  for (std::uint32_t f = 0; f < complex.face_count(); ++f)
    if (complex.alive(FaceId(f)) && complex.face(FaceId(f)).crack == 0) skin.push_back(complex.corners(FaceId(f)));
  refine_walls(walls, TriangleBvh(skin), body.finest_spacing, body.finest_spacing);
}

void insert_scored_sheet(const SceneScore& score, std::int32_t crack, std::uint64_t seed, RunStart& run) {
  TriangleMesh walls;
  walls.vertices = score.front.steps[0];
  walls.triangles = score.front.triangles;
  if (score.glue) refine(walls, run.body);
  Complex scored = run.body.surface;
  insert_sheet(scored, walls, crack);
  if (score.glue) {
    GluedBonds& glued = run.state.glued;
    const std::size_t first = glued.bonds.size();
    glue_crack(scored, crack, glued);
    set_strength(glued, first, *score.glue, seed, scored.extent().diagonal(), score.body);
  }
  follow_donors(update_body(run.body, scored), run.state);
}

// Inserts the scene's prescored cracks: fronts step by step, sheets whole.
void prescore(const Scene& scene, RunStart& run, const Progress& progress) {
  CrackOptions options;
  options.seed = scene.seed;
  for (std::size_t s = 0; s < scene.scores.size(); ++s) {
    const Front& front = scene.scores[s].front;
    const std::int32_t crack = run.body.surface.crack_count() + 1;
    if (front.is_sheet()) {
      report(progress, "prescoring", s, scene.scores.size());
      insert_scored_sheet(scene.scores[s], crack, scene.fracture.seed, run);
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
