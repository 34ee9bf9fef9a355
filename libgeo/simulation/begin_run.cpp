// begin_run() of kerf/simulation.h. Order: sample and build the body, insert the prescored cracks,
// then assign velocities. Nodes that a crack inserts belong to the body of their donor.
#include <algorithm>

#include "geometry/bvh.h"
#include "kerf/crack.h"
#include "kerf/error.h"
#include "kerf/simulation.h"
#include "score/jagged.h"
#include "simulation/bond_breaking.h"
#include "simulation/crack_writer.h"
#include "simulation/next_crack.h"
#include "simulation/scene_body.h"
#include "surface/skin.h"

namespace geo {
namespace {

// Divides the walls of a sheet so that they can follow the deformed material where they open:
// triangles as large as cells cannot.
void refine(TriangleMesh& walls, const Body& body) {
  const TriangleBvh skin(corners_of(skin_of(body.surface)));
  refine_walls(walls, skin, body.finest_spacing, body.finest_spacing);
}

// Forgets the bonds from `first` on that are not in a body: walls may reach into others.
void keep_within(const TriangleMesh& body, std::size_t first, GluedBonds& glued) {
  const TriangleBvh own(corners_of(body));
  const auto is_elsewhere = [&](const GluedBond& bond) {
    const auto& [a, b, c] = bond.faces.at(0);
    return !own.inside((glued.points[a] + glued.points[b] + glued.points[c]) / 3);
  };
  auto& bonds = glued.bonds;
  bonds.erase(std::remove_if(bonds.begin() + static_cast<std::ptrdiff_t>(first), bonds.end(), is_elsewhere),
              bonds.end());
}

// Where the cracks of a scene go.
struct Prescoring {
  const Scene& scene;
  const PlacedModels& models;
  RunStart& run;
};

// The crack of a sheet; throws as insert_sheet(). Where it is glued, only its outline on the skin
// is inserted, and its bonds are appended to the run's.
CrackEdit sheet_edit(const Prescoring& to, const SceneScore& score, std::int32_t crack) {
  TriangleMesh walls;
  walls.vertices = score.front.steps[0];
  walls.triangles = score.front.triangles;
  if (score.glue) refine(walls, to.run.body);
  Complex scored = to.run.body.surface;
  insert_sheet(scored, walls, crack);
  if (score.glue) {
    GluedBonds& glued = to.run.state.glued;
    const std::size_t first = glued.bonds.size();
    glue_crack(scored, crack, glued);
    keep_within(to.models.bodies.at(score.body), first, glued);
    set_strength(glued, first, *score.glue, to.scene.fracture.seed, scored.extent().diagonal(), score.body);
  }
  return
      [scored = std::move(scored)](Complex& complex, CrackStats*) { return complex.apply(complex.difference(scored)); };
}

// Inserts the scene's prescored cracks: fronts step by step, sheets whole.
void prescore(const Prescoring& to, const Progress& progress) {
  const Scene& scene = to.scene;
  RunStart& run = to.run;
  CrackWriter writer(run.body, run.state.body_index, {.seed = scene.seed});
  FrameStats unused;
  for (std::size_t s = 0; s < scene.scores.size(); ++s) {
    const Front& front = scene.scores[s].front;
    const std::int32_t crack = next_crack(run.body.surface, run.state);
    if (front.is_sheet()) {
      report(progress, "prescoring", s, scene.scores.size());
      if (!writer.write(sheet_edit(to, scene.scores[s], crack), unused))
        throw GeometryError("the prescored sheet '" + front.name + "' cannot be inserted");
      continue;
    }
    FrontState state = begin_front(front.steps.at(0), front.closed, crack);
    for (std::size_t k = 1; k < front.steps.size(); ++k) {
      report(progress, "prescoring", s, scene.scores.size());
      auto written = writer.write(state, resample_front(front.steps[0], front.steps[k], front.closed), unused);
      if (!written)
        throw GeometryError("step " + std::to_string(k) + " of the prescored front '" + front.name +
                            "' cannot be made");
      state = std::move(written->front);
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
  prescore({.scene = scene, .models = models, .run = run}, progress);
  begin_motion(scene, run.body, run.state);
  return run;
}

}  // namespace geo
