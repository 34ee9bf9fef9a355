// begin_run() of kerf/simulation.h. Order: sample and build the body, insert the prescored cracks,
// then assign velocities and prestretch. Nodes that a crack inserts belong to the body of their
// donor.
#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "body/locate.h"
#include "kerf/crack.h"
#include "kerf/error.h"
#include "kerf/simulation.h"
#include "simulation/crack_writer.h"
#include "simulation/fracture_front.h"
#include "simulation/glued_walls.h"
#include "simulation/next_crack.h"
#include "simulation/prestretch.h"
#include "simulation/scene_body.h"

namespace geo {
namespace {

// Where the cracks of a scene go.
struct Prescoring {
  const Scene& scene;
  const PlacedModels& models;
  RunStart& run;
};

// An edit that brings the complex to one which has grown from it.
CrackEdit edit_to(Complex scored) {
  return
      [scored = std::move(scored)](Complex& complex, CrackStats*) { return complex.apply(complex.difference(scored)); };
}

// The crack of a sheet; throws as insert_sheet(). Where it is glued, only its outline on the skin
// is inserted, and its bonds are appended to the run's.
CrackEdit sheet_edit(const Prescoring& to, const SceneScore& score, std::int32_t crack) {
  TriangleMesh walls;
  walls.vertices = score.front.steps[0];
  walls.triangles = score.front.triangles;
  Complex scored = to.run.body.surface;
  if (score.glue)
    glue_walls({.model = to.models.bodies.at(score.body),
                .body = score.body,
                .strength = *score.glue,
                .spacing = to.run.body.finest_spacing,
                .seed = to.scene.fracture.seed},
               walls, crack, scored, to.run.state.glued);
  else
    insert_sheet(scored, walls, crack);
  return edit_to(std::move(scored));
}

// The points of a front, as many in each step.
std::vector<std::vector<Vec3>> rows_of(const Front& front) {
  std::vector<std::vector<Vec3>> rows{front.steps.at(0)};
  for (std::size_t k = 1; k < front.steps.size(); ++k)
    rows.push_back(resample_front(front.steps[0], front.steps[k], front.closed));
  return rows;
}

// The same, for a front that may grow by its load: it does so at points that lie in the material.
// Where its last step has none, segments are divided into parts of a spacing.
std::vector<std::vector<Vec3>> rows_to_grow(const Front& front, const Body& body) {
  std::vector<std::vector<Vec3>> rows = rows_of(front);
  const auto is_in_material = [&](const Vec3& x) { return is_inside(body.surface, x); };
  if (std::any_of(rows.back().begin(), rows.back().end(), is_in_material)) return rows;
  const std::size_t points = rows[0].size(), segments = front.closed ? points : points - 1;
  std::vector<std::vector<Vec3>> finer(rows.size());
  for (std::size_t i = 0; i < points; ++i) {
    const std::size_t next = (i + 1) % points;
    double length = 0;
    for (const auto& row : rows) length = std::max(length, (row[next] - row[i]).norm());
    const double parts = i < segments ? std::max(1.0, std::ceil(length / body.finest_spacing)) : 1;
    for (std::size_t r = 0; r < rows.size(); ++r)
      for (int k = 0; k < parts; ++k) finer[r].push_back(rows[r][i] + k / parts * (rows[r][next] - rows[r][i]));
  }
  return finer;
}

// Inserts the scene's prescored cracks: fronts step by step, sheets whole. Where bodies break by
// stress, a front that ends in the material goes on by its load.
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
    const bool may_grow = scene.fracture.on && scene.fracture.of_body(scene.scores[s].body).has_fronts();
    const auto rows = may_grow ? rows_to_grow(front, run.body) : rows_of(front);
    FrontState state = begin_front(rows[0], front.closed, crack), before = state;
    for (std::size_t k = 1; k < rows.size(); ++k) {
      report(progress, "prescoring", s, scene.scores.size());
      auto written = writer.write(state, rows[k], unused);
      if (!written)
        throw GeometryError("step " + std::to_string(k) + " of the prescored front '" + front.name +
                            "' cannot be made");
      before = std::exchange(state, std::move(written->front));
    }
    if (!may_grow) continue;
    if (auto grows = growing_after(before, std::move(state))) run.state.fracture.fronts.push_back(std::move(*grows));
  }
}

// Glues the walls of cells in the bodies that break along them.
void glue_cells(const Prescoring& to, const Progress& progress) {
  if (!to.scene.fracture.on) return;
  RunStart& run = to.run;
  CrackWriter writer(run.body, run.state.body_index, {.seed = to.scene.seed});
  FrameStats unused;
  for (std::size_t b = 0; b < to.scene.bodies.size(); ++b) {
    const Breakage& breakage = to.scene.fracture.of_body(b);
    if (breakage.cells < 2) continue;
    report(progress, "cells", b, to.scene.bodies.size());
    Complex scored = run.body.surface;
    glue_cells({.model = to.models.bodies[b],
                .body = static_cast<std::uint32_t>(b),
                .strength = breakage,
                .spacing = run.body.finest_spacing,
                .seed = to.scene.fracture.seed},
               to.scene.fracture, next_crack(run.body.surface, run.state), scored, run.state.glued);
    if (!writer.write(edit_to(std::move(scored)), unused))
      throw GeometryError("the cells of '" + to.scene.bodies[b].name + "' cannot be made; change their number");
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
  const Prescoring to{.scene = scene, .models = models, .run = run};
  prescore(to, progress);
  glue_cells(to, progress);
  begin_motion(scene, run.body, run.state);
  begin_prestretch(scene, models, run.body, run.state);
  if (scene.loaded) bear_load(scene, run, progress);
  return run;
}

}  // namespace geo
