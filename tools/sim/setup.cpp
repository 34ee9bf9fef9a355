// Overrides of keys come from --set. Warnings compare models, sampling, grips and blades with the
// scene.
#include "sim/setup.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>

#include <utility>

#include <kerf/appearance.h>
#include <kerf/files.h>
#include "model.h"

namespace sim {

namespace fs = std::filesystem;

namespace {

std::string in_words(const geo::Vec3& p) {
  return tool::number(p.x()) + ", " + tool::number(p.y()) + ", " + tool::number(p.z());
}

double longest_edge(const geo::TriangleMesh& mesh) {
  double longest = 0;
  for (const auto& [p, q, r] : geo::corners_of(mesh))
    longest = std::max({longest, (q - p).norm(), (r - q).norm(), (p - r).norm()});
  return longest;
}

}  // namespace

geo::SceneOverrides parse_overrides(const std::vector<std::string>& settings) {
  geo::SceneOverrides overrides;
  for (const auto& s : settings) {
    const auto equals = s.find('=');
    if (equals == std::string::npos || equals == 0) throw tool::UsageError("--set '" + s + "' is not KEY=VALUE");
    overrides.push_back({s.substr(0, equals), s.substr(equals + 1)});
    auto& [key, value] = overrides.back();
    const std::string last = key.substr(key.find_last_of('.') + 1);
    if (last != "mesh" && last != "motion" && last != "file") continue;
    if (value.empty()) throw tool::UsageError("--set '" + s + "' names no file; write " + key + "=FILE");
    value = "\"" + fs::absolute(value).string() + "\"";
  }
  return overrides;
}

Setup read_setup(const std::string& path, const geo::SceneOverrides& overrides) {
  Setup setup{.scene = geo::read_scene(path, overrides), .models = {}};
  std::vector<geo::TriangleMesh> meshes;
  std::vector<geo::MaterialLibrary> libraries;
  std::string hashes = std::to_string(setup.scene.fingerprint);
  for (const geo::SceneBody& body : setup.scene.bodies) {
    const std::string bytes = geo::read_all(body.mesh);
    meshes.push_back(tool::parse_solid(bytes, body.mesh).mesh);
    tool::require_whole(meshes.back(), body.mesh, "a scene begins with whole models");
    libraries.push_back(tool::for_scene(meshes.back(), body.mesh, body.scale));
    if (libraries.back().glb) setup.with_materials.push_back(body.mesh);
    hashes += " " + std::to_string(geo::fingerprint(bytes));
  }
  setup.fingerprint = geo::fingerprint(hashes);
  try {
    setup.models = geo::place_models(setup.scene, std::move(meshes));
  } catch (const geo::InputError& e) {
    throw geo::InputError(path + ": " + e.what());
  }
  geo::Attributes& all = setup.models.all.attributes;
  if (libraries.size() == 1) {
    setup.materials = libraries[0];
    return setup;
  }
  std::vector<geo::TriangleMesh>& bodies = setup.models.bodies;
  for (std::size_t b = 0; b < bodies.size(); ++b) bodies[b].attributes.library = libraries[b];
  all = geo::joined_attributes(bodies);
  for (geo::TriangleMesh& body : bodies) body.attributes.library = {};
  setup.materials = std::exchange(all.library, {});  // each frame would hold its images
  return setup;
}

void tell_lost_materials(const Setup& setup) {
  for (const std::string& path : setup.with_materials) {
    geo::SurfaceFile about;
    about.notes.push_back("left out: materials but their names, which are not shown");
    tool::say_notes(about, path);
  }
}

void warn_of_large_models(const Setup& setup, const tool::Tool& t) {
  const double across = geo::bounding_box(setup.models.all).diagonal();
  const bool unscaled = std::all_of(setup.scene.bodies.begin(), setup.scene.bodies.end(),
                                    [](const geo::SceneBody& b) { return b.scale == 1; });
  if (across >= 100 && unscaled)
    t.say(t.name() + ": the bodies are " + tool::rounded(across) +
          " m across, as units are metres; give them scale = 0.001 if they are in mm");
}

void tell_touching_bodies(const Setup& setup, const std::string& name, const tool::Tool& t) {
  if (const std::string note = geo::touching_note(setup.scene, setup.models); !note.empty()) t.say(name + ": " + note);
}

void warn_of_coarse_models(const Setup& setup, const geo::Body& body, const tool::Tool& t) {
  const double coarsest = *std::max_element(body.nodes.spacing.begin(), body.nodes.spacing.end());
  for (std::size_t b = 0; b < setup.models.bodies.size(); ++b) {
    const geo::TriangleMesh& model = setup.models.bodies[b];
    const double longest = longest_edge(model);
    // A surface bends at its vertices only. With edges above 4 spacings it is coarser than the
    // motion of the nodes.
    if (longest <= 4 * coarsest) continue;
    char share[16];
    std::snprintf(share, sizeof share, "%.1g", coarsest / geo::bounding_box(model).diagonal());
    t.say(t.name() + ": " + fs::path(setup.scene.bodies[b].mesh).filename().string() + " has edges of up to " +
          tool::rounded(longest) + ", nodes are at most " + tool::rounded(coarsest) +
          " apart; a surface bends and touches at its vertices: body.refine = " + tool::rounded(coarsest) +
          ", or kerf-repair --edge " + share + ", gives it more");
  }
}

std::vector<std::string> thin_models(const Setup& setup, const geo::Body& body) {
  // Ears and rims taper off in most models, and hardly matter for how these bend.
  constexpr double least_thin_surface = 0.1;
  std::vector<std::string> sentences;
  for (std::size_t b = 0; b < setup.models.bodies.size(); ++b) {
    const geo::ThinMaterial thin = geo::find_thin_material(setup.models.bodies[b], body.nodes);
    if (thin.share < least_thin_surface) continue;
    const double volume = geo::signed_volume(setup.models.bodies[b]);
    sentences.push_back(fs::path(setup.scene.bodies[b].mesh).filename().string() + ": " +
                        tool::rounded(std::round(100 * thin.share)) + " % of its surface has walls of about " +
                        tool::rounded(thin.thickness) + ", as near (" + tool::rounded(thin.at) +
                        "), with fewer than 2 nodes across at a spacing of " + tool::rounded(thin.spacing) +
                        ": they bend too little; body.spacing = " + tool::rounded(thin.enough) + " is needed, about " +
                        tool::rounded(volume / std::pow(thin.enough, 3)) + " nodes");
  }
  return sentences;
}

void warn_of_empty_grips(const Setup& setup, const geo::Body& body, const tool::Tool& t) {
  const auto& positions = body.nodes.position;
  for (const geo::Grip& g : setup.scene.grips)
    if (std::none_of(positions.begin(), positions.end(), [&](const geo::Vec3& p) {
          return (p.array() >= g.lo.array() && p.array() <= g.hi.array()).all();
        }))
      t.say(t.name() + ": no node is in the box from (" + in_words(g.lo) + ") to (" + in_words(g.hi) +
            "), which is to hold some; bodies are where their scale, rotation and position put them");
}

void warn_of_missed_blades(const Setup& setup, double time, const tool::Tool& t) {
  const auto& blades = setup.scene.blades;
  double from = blades[0].motion.keys.front().time, to = blades[0].motion.keys.back().time;
  geo::Box3 box;
  for (const geo::Blade& blade : blades) {
    from = std::min(from, blade.motion.keys.front().time);
    to = std::max(to, blade.motion.keys.back().time);
    for (const auto& key : blade.motion.keys)
      for (const geo::Vec3& p : blade.at(key.time)) box.add(p);
  }
  t.say(t.name() + ": no blade met the material in " + tool::rounded(time) +
        " s; by their keys, blades are there from " + tool::rounded(from) + " to " + tool::rounded(to) +
        " s, within (" + tool::rounded(box.lo) + ") to (" + tool::rounded(box.hi) + ")");
}

}  // namespace sim
