// A run as kerf-sim reads it: the scene, its placed models, and warnings about both.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <kerf/files.h>
#include <kerf/simulation.h>
#include "tool.h"

namespace sim {

struct Setup {
  geo::Scene scene;
  geo::PlacedModels models;
  std::uint64_t fingerprint = 0;                 ///< of scene and models
  std::vector<std::string> with_materials = {};  ///< paths of models that bring materials
  geo::MaterialLibrary materials = {};           ///< of all models, by the names of the groups of models.all
};

/// Overrides from the command line, as KEY=VALUE. Paths there are relative to the current folder,
/// not to the scene. Throws tool::UsageError.
geo::SceneOverrides parse_overrides(const std::vector<std::string>& settings);

/// Reads a scene and its models. Throws geo::InputError, also where placed bodies overlap.
Setup read_setup(const std::string& path, const geo::SceneOverrides& overrides);

/// Says which bodies touched and were moved apart; the line begins with the tool's name.
void tell_touching_bodies(const Setup& setup, const std::string& name, const tool::Tool& t);
/// Says of which models the materials are not shown.
void tell_lost_materials(const Setup& setup);
/// Warns of models that are probably in millimetres.
void warn_of_large_models(const Setup& setup, const tool::Tool& t);
/// Warns of models with triangles much larger than the node spacing, as CAD programs write them: a
/// surface bends and touches at its vertices only.
void warn_of_coarse_models(const Setup& setup, const geo::Body& body, const tool::Tool& t);
/// A sentence for each model of which a tenth of the surface and more are walls with fewer than two
/// nodes across: they bend too little. It names the spacing that is needed.
std::vector<std::string> thin_models(const Setup& setup, const geo::Body& body);
/// Warns of grips that hold no node.
void warn_of_empty_grips(const Setup& setup, const geo::Body& body, const tool::Tool& t);
/// Warns that no blade has met the material, and says when and where blades move.
void warn_of_missed_blades(const Setup& setup, double time, const tool::Tool& t);

}  // namespace sim
