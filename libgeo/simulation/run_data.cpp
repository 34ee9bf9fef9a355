// A state is checked before anything changes.
#include "simulation/run_data.h"

#include <algorithm>
#include <utility>

#include "kerf/error.h"
#include "simulation/scene_body.h"

namespace geo {
namespace {

// The state with a body index for each node. Throws InputError where it does not fit.
RunState checked(const Scene& scene, const Body& body, RunState state) {
  const std::size_t n = body.nodes.size();
  if (state.body_index.empty()) state.body_index.assign(n, 0);
  const std::size_t rested = state.rest.time.size();
  const bool known =
      std::all_of(state.body_index.begin(), state.body_index.end(), [&](auto b) { return b < scene.bodies.size(); });
  if (state.motion.displacement.size() != n || state.motion.velocity.size() != n || state.body_index.size() != n ||
      rested > n || state.rest.anchor.size() != rested || !known || state.fronts.size() != scene.blades.size())
    throw InputError("the checkpoint does not belong to this scene");
  return state;
}

}  // namespace

RunData::RunData(const Scene& scene_in, Body body_in, RunState state_in)
    : scene(scene_in),
      changes(scene),
      state(checked(scene, body_in, std::move(state_in))),
      body(std::move(body_in)),
      solid(body, state.motion, materials_of(scene, state.body_index)) {}

void RunData::restore(Body new_body, RunState new_state) {
  RunState fitting = checked(scene, new_body, std::move(new_state));
  if (!solid.fits(new_body.nodes.size())) throw InputError("the checkpoint does not belong to this scene");
  state = std::move(fitting);
  body = std::move(new_body);
  changes.revert(scene);
  solid.restart(materials_of(scene, state.body_index));
}

void RunData::become(RunStart other) {
  state = checked(scene, other.body, std::move(other.state));
  body = std::move(other.body);
  changes.revert(scene);
  solid.rebuild(materials_of(scene, state.body_index));
}

}  // namespace geo
