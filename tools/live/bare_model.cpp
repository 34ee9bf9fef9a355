// The scene is text, as a user would write it: overrides then work as they do for files.
#include "live/bare_model.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <random>
#include <utility>

#include <kerf/error.h>

#include "model.h"

namespace live {
namespace {

namespace fs = std::filesystem;

std::string row(const geo::Vec3& p) {
  return "[" + tool::number(p.x()) + ", " + tool::number(p.y()) + ", " + tool::number(p.z()) + "]";
}

// The mean distance of nodes that fill a solid, or, where it is thin, side by side in a sheet. A
// skin of longer edges would hide how the nodes move.
double spacing_of(const geo::TriangleMesh& mesh, int nodes) {
  return std::max(std::cbrt(geo::signed_volume(mesh) / nodes), std::sqrt(0.5 * geo::area(mesh) / nodes));
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
         "\nnodes = " + std::to_string(nodes) + "\nrefine = " + tool::number(spacing_of(mesh, nodes)) +
         "\n[material]\nyoung = " + tool::number(stiffness * density * gravity * size) +
         "\ndensity = " + tool::number(density) + "\npoisson = 0.35\ndamping = 1.5\n[ground]\npoint = " + row(low) +
         "\nnormal = " + row(normal) +
         "\nfriction = 0.5\n[contact]\nfriction = 0.1\n[time]\nstep = 0.0167\naccuracy = 0.01\n";
}

// A folder for a while.
class Folder {
 public:
  Folder() {
    std::random_device random;
    path_ = fs::temp_directory_path() / ("kerf-page-" + std::to_string(random()) + std::to_string(random()));
    fs::create_directories(path_);
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  ~Folder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  std::string file(const std::string& name) const { return (path_ / name).string(); }
  std::string prefix() const { return path_.string() + "/"; }

 private:
  fs::path path_;
};

// Reads a model whose materials and images came with it. They are files for the reader.
geo::SurfaceFile parse_with(const std::string& name, const std::string& bytes, const std::vector<BesideFile>& beside) {
  const Folder folder;
  for (const BesideFile& file : beside) {
    if (fs::path(file.name).filename() != file.name || file.name == ".." || file.name == ".")
      throw geo::InputError(file.name + ": is no name of a file");
    geo::write_all(folder.file(file.name), [&](std::ostream& out) { out << file.bytes; });
  }
  try {
    return tool::parse_solid(bytes, folder.file(name));
  } catch (const geo::InputError& e) {
    std::string what = e.what();
    for (auto at = what.find(folder.prefix()); at != what.npos; at = what.find(folder.prefix()))
      what.erase(at, folder.prefix().size());
    throw geo::InputError(what);
  }
}

}  // namespace

bool is_scene(const std::string& path) {
  const std::string ending = fs::path(path).extension().string();
  return ending == ".toml" || ending == ".json";
}

char up_axis(const std::string& name) {
  const std::string ending = fs::path(name).extension().string();
  return ending == ".glb" || ending == ".GLB" ? 'y' : 0;
}

BareModel bare_model(const std::string& path, const std::string& bytes, int nodes, char up,
                     const geo::SceneOverrides& overrides, const std::optional<std::vector<BesideFile>>& beside) {
  BareModel result;
  const std::string name = fs::path(path).filename().string();
  geo::SurfaceFile file = beside ? parse_with(name, bytes, *beside) : tool::parse_solid(bytes, path);
  for (const std::string& note : file.notes) result.notes.push_back(name + ": " + note);
  geo::TriangleMesh& mesh = file.mesh;
  tool::require_whole(mesh, path, "a scene begins with whole models");
  sim::Setup& setup = result.setup;
  setup.materials = std::exchange(mesh.attributes.library, {});  // each frame would hold its images
  setup.scene = geo::parse_scene(scene_of(mesh, path, nodes, up), path, overrides);
  setup.models = geo::place_models(setup.scene, {std::move(mesh)});
  setup.fingerprint = setup.scene.fingerprint;
  return result;
}

}  // namespace live
