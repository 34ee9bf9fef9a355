// The scene is text, as a user would write it: overrides then work as they do for files.
#include "live/bare_model.h"

#include <filesystem>

#include "model.h"

namespace live {
namespace {

std::string row(const geo::Vec3& p) {
  return "[" + tool::number(p.x()) + ", " + tool::number(p.y()) + ", " + tool::number(p.z()) + "]";
}

// Gravity is such that a fall over the model's own size takes about 0.6 s, as that of a thing that
// one holds in two hands. Young's modulus is a hundred times the weight per area.
std::string scene_of(const geo::TriangleMesh& mesh, const std::string& path, int nodes, char up) {
  constexpr double density = 1000, falls = 6, stiffness = 60;
  const geo::Box3 box = geo::bounding_box(mesh);
  const double size = box.diagonal();
  const int axis = up == 'y' ? 1 : 2;
  const geo::Vec3 normal = geo::Vec3::Unit(axis);
  geo::Vec3 low = box.center();
  low[axis] = box.lo[axis];
  const double gravity = falls * size;
  return "gravity = " + row(-gravity * normal) + "\n[body]\nmesh = " + tool::quoted(path) +
         "\nnodes = " + std::to_string(nodes) +
         "\n[material]\nyoung = " + tool::number(stiffness * density * gravity * size) +
         "\ndensity = " + tool::number(density) + "\npoisson = 0.35\ndamping = 1.5\n[ground]\npoint = " + row(low) +
         "\nnormal = " + row(normal) +
         "\nfriction = 0.5\n[contact]\nfriction = 0.1\n[time]\nstep = 0.0167\naccuracy = 0.01\n";
}

}  // namespace

bool is_scene(const std::string& path) {
  const std::string ending = std::filesystem::path(path).extension().string();
  return ending == ".toml" || ending == ".json";
}

BareModel bare_model(const std::string& path, const std::string& bytes, int nodes, char up,
                     const geo::SceneOverrides& overrides) {
  geo::SurfaceFile file = tool::parse_solid(bytes, path);
  BareModel result;
  const std::string name = std::filesystem::path(path).filename().string();
  for (const std::string& note : file.notes) result.notes.push_back(name + ": " + note);
  geo::TriangleMesh& mesh = file.mesh;
  tool::require_whole(mesh, path, "a scene begins with whole models");
  const geo::Attributes& attributes = mesh.attributes;
  if (!attributes.materials.empty() || attributes.library != geo::MaterialLibrary() || !attributes.uv.empty())
    result.notes.push_back(name + ": materials and images are not shown, and files that are saved here have none");
  mesh.attributes.library = {};  // each frame would hold its images
  sim::Setup& setup = result.setup;
  setup.scene = geo::parse_scene(scene_of(mesh, path, nodes, up), path, overrides);
  setup.models = geo::place_models(setup.scene, {std::move(mesh)});
  setup.fingerprint = setup.scene.fingerprint;
  return result;
}

}  // namespace live
