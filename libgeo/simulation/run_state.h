// What a run is made of between its frames, and how it begins.
#pragma once

#include <vector>

#include "kerf/body.h"
#include "kerf/run.h"
#include "kerf/solid.h"
#include "simulation/edge_front.h"
#include "simulation/fracture_step.h"
#include "simulation/model.h"

namespace geo {

/// What a run needs to go on besides its body.
struct RunState {
  State motion;
  std::vector<std::vector<EdgeFront>> fronts;  ///< per blade: a front for each part of the edge that cuts
  FractureState fracture;
  std::vector<Vec3> surface;  ///< a row a living surface vertex, ascending: where it is; empty without self-contact,
                              ///< and at the beginning
  std::vector<std::uint32_t> part;  ///< per node: the body of the scene that it belongs to
  double time = 0;
  int frame = 0;
  FrameStats total;  ///< counts since the run began; its seconds since the program did
};

struct Beginning {
  Body body;
  RunState state;
};

/// A run before its first step: samples and builds the body, makes the prescored cracks. Throws InputError when bodies
/// do not fit the scene, GeometryError when a prescored crack cannot be made.
Beginning begin_run(const Scene& scene, const Model& model, const Progress& progress = {});

}  // namespace geo
