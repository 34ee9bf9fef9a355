// Reads a model for a tool: a valid solid, or one clear error.
#pragma once

#include <algorithm>
#include <functional>
#include <string>
#include <utility>

#include <kerf/check.h>
#include <kerf/complex.h>
#include <kerf/crack.h>
#include <kerf/error.h>
#include <kerf/export.h>
#include <kerf/files.h>
#include <kerf/repair.h>
#include "tool.h"

namespace tool {

/// Takes a line for the user, such as Tool::say().
using Say = std::function<void(const std::string&)>;

/// Throws InputError unless a surface, read from these bytes, is closed, manifold, oriented
/// outwards, free of self-intersection.
inline void require_solid(const geo::TriangleMesh& mesh, const std::string& path, const std::string& bytes) {
  try {
    geo::require_solid(mesh);
  } catch (const geo::InputError& e) {
    if (!mesh.two_sided() && bytes.find("\ng patch_-") != bytes.npos)
      throw geo::InputError(path +
                            ": is a cut surface as OBJ, which cannot say how the two sides of a crack belong together; "
                            "give the PLY of it");
    throw geo::InputError(path + ": " + e.what() + (mesh.two_sided() ? "" : ", or try kerf-repair"));
  }
}

/// A surface, checked by require_solid().
inline geo::SurfaceFile parse_solid(const std::string& bytes, const std::string& path) {
  geo::SurfaceFile file = tool::parse_surface(bytes, path);
  require_solid(file.mesh, path, bytes);
  return file;
}
inline geo::SurfaceFile read_solid(const std::string& path) { return parse_solid(geo::read_all(path), path); }

/// Words for what a repair decided about shells, and the option of kerf-repair that decides
/// otherwise; empty where there was nothing to decide.
inline std::string shell_decisions(const geo::RepairStats& done) {
  std::string text;
  const auto add = [&](std::size_t n, const std::string& verb) {
    if (n > 0) text += (text.empty() ? "" : ", ") + counted(n, "shell") + " " + verb;
  };
  add(done.inverted_shells, "inside out turned");
  add(done.dropped_shells, "in solid material, oriented like it, left out as hidden (--inner cavities makes " +
                               std::string(done.dropped_shells == 1 ? "it a cavity" : "them cavities") + ")");
  add(done.hollowed_shells, "in solid material, oriented like it, made " +
                                std::string(done.hollowed_shells == 1 ? "a cavity" : "cavities") +
                                " (--inner oriented leaves " + (done.hollowed_shells == 1 ? "it" : "them") + " out)");
  add(done.filled_shells,
      "left out, so that " + std::string(done.filled_shells == 1 ? "a cavity is" : "cavities are") + " filled");
  return text;
}

/// Repairs a plain surface, as kerf-repair does without options, and says what it decided about
/// shells. Throws InputError where the result is no solid.
inline void repair_plain(geo::TriangleMesh& mesh, const std::string& path, const Say& say) {
  if (mesh.two_sided()) return;
  geo::SolidRepairStats done;
  try {
    mesh = geo::repaired_solid(std::move(mesh), {}, &done);
  } catch (const std::runtime_error& e) {
    const std::string what = e.what();
    throw geo::InputError(path + ": cannot be repaired: " + what.substr(0, what.rfind("; ")) +
                          "; wrap it in a new surface first: kerf-repair --voxel 0.005");
  }
  if (const std::string decisions = shell_decisions(done.repair); !decisions.empty())
    say(path + ": " + decisions + "; kerf-repair with that option, instead of --repair, decides otherwise");
}

/// As read_solid(), where `repair` is false. Else a plain surface is repaired first.
inline geo::SurfaceFile read_solid(const std::string& path, bool repair, const Say& say) {
  if (!repair) return read_solid(path);
  geo::SurfaceFile file = tool::read_surface(path);
  repair_plain(file.mesh, path, say);
  return file;
}

/// Removes the sites of an uncut surface: frames of a run have them from the first on. Throws
/// InputError, with the file's name and `advice`, where the surface is cut.
inline void require_whole(geo::TriangleMesh& mesh, const std::string& path, const std::string& advice) {
  if (std::any_of(mesh.patch.begin(), mesh.patch.end(), [](auto patch) { return patch != 0; }))
    throw geo::InputError(path + ": is cut already; " + advice);
  mesh.patch.clear();
  mesh.site.clear();
}

/// A model for a scene: in metres, and without its materials, which are handed back. Prints a unit
/// of the file that `scale` leaves out.
inline geo::MaterialLibrary for_scene(geo::TriangleMesh& mesh, const std::string& path, double scale) {
  geo::SurfaceFile about;
  if (mesh.unit > 0 && mesh.unit != 1 && scale == 1)
    about.notes.push_back("states a unit of " + number(mesh.unit) +
                          " m, but a scene is in metres; give the body scale = " + number(mesh.unit));
  say_notes(about, path);
  mesh.unit = mesh.unit > 0 ? 1 : 0;
  return std::exchange(mesh.attributes.library, {});
}

/// Says what a format does not hold of a surface; nothing where `things` is empty.
inline void say_left_out(const std::vector<std::string>& things, const std::string& path, const std::string& keeps,
                         const Tool& t) {
  std::string text;
  for (const std::string& thing : things) text += (text.empty() ? "" : ", ") + thing;
  if (!text.empty()) t.say(t.name() + ": " + path + ": left out: " + text + "; a " + keeps + " keeps them");
}

/// Says what STL and OFF do not hold. Throws InputError where single precision is too coarse.
inline void say_left_out_of_plain(const geo::TriangleMesh& mesh, const std::string& path, const Tool& t) {
  if (path.ends_with(".stl") && !geo::single_precision_offset(geo::bounding_box(mesh)).isZero(0))
    throw geo::InputError(path + ": the model is too far from the origin for single precision; write a .ply");
  std::vector<std::string> things;
  if (!mesh.attributes.empty() || !mesh.patch.empty()) things.push_back("all but vertices and faces");
  if (mesh.unit > 0 && mesh.unit != 1) things.push_back("the unit");
  say_left_out(things, path, ".ply", t);
}

/// Writes a surface in the format that the ending of `path` names, PLY without one, with materials
/// beside an OBJ. Says what the format does not hold.
inline void write_surface(const geo::TriangleMesh& mesh, const std::vector<geo::FrontState>& fronts,
                          const std::string& path, const Tool& t) {
  if (path.ends_with(".obj")) return say_left_out(geo::save_obj(path, mesh), path, ".ply", t);
  const bool stl = path.ends_with(".stl"), off = path.ends_with(".off");
  if (stl || off) say_left_out_of_plain(mesh, path, t);
  geo::write_all(path, [&](std::ostream& out) {
    if (stl) return geo::write_stl(out, mesh);
    if (off) return geo::write_off(out, mesh);
    geo::write_ply(out, mesh, fronts, t.name());
  });
}

/// The complex of a surface from a file. Errors begin with the file's name.
inline geo::Complex complex_of(const geo::SurfaceFile& file, const std::string& path) {
  try {
    return geo::Complex::from_two_sided(file.mesh);
  } catch (const geo::InputError& e) {
    throw geo::InputError(path + ": " + e.what());
  }
}

}  // namespace tool
