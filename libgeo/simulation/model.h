// The bodies of a scene as one: placed models and their nodes.
#pragma once

#include <span>

#include "kerf/body.h"
#include "kerf/material.h"
#include "kerf/progress.h"
#include "kerf/scene.h"

namespace geo {

/// All solids of a scene, placed. A component never sees another one, so that one Body holds them all.
struct Model {
  TriangleMesh mesh;                ///< of all parts, in their order; attributes of a single part only
  std::vector<TriangleMesh> parts;  ///< one a body of the scene
};

/// Places the meshes of scene.bodies. Throws InputError when their number differs.
Model place_models(const Scene& scene, std::vector<TriangleMesh> meshes);

/// What the scene's obstacles look like where they are at that time, as one mesh: of a plane a square beside the bodies
/// (`model`) as they were placed, half as wide again as these. Empty: there are none.
TriangleMesh place_obstacles(const Scene& scene, const Model& model, double time);

/// Samples each part and builds the body; `part` receives the row of each node's part. Throws InputError as sampling
/// does.
Body build_model(const Scene& scene, const Model& model, std::vector<std::uint32_t>& part,
                 const Progress& progress = {});

/// What the nodes of each part are made of.
Materials materials_of(const Scene& scene, const std::vector<std::uint32_t>& part);

}  // namespace geo
