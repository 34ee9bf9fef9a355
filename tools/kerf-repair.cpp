// kerf-repair: makes a valid solid from a surface with faults, or wraps it in a new surface.
#include <iostream>

#include <kerf/check.h>
#include <kerf/crack.h>
#include <kerf/files.h>
#include <kerf/mesh.h>
#include "model.h"
#include "tool.h"

namespace {

struct Command {
  std::string model;
  double weld = 0, voxel = 0, edge = 0, unit = 0;
  bool smooth = false;
};

std::string in_words(const geo::RepairStats& r) {
  std::string text;
  const auto counted = [](std::size_t n, const std::string& one, const std::string& many) {
    return std::to_string(n) + " " + (n == 1 ? one : many);
  };
  const auto add = [&](std::size_t n, const std::string& one, const std::string& many, const std::string& done) {
    if (n > 0) text += (text.empty() ? "" : ", ") + counted(n, one, many) + " " + done;
  };
  add(r.welded_vertices, "vertex", "vertices", "welded"), add(r.dropped_triangles, "triangle", "triangles", "dropped"),
      add(r.flipped_triangles, "triangle", "triangles", "turned");
  add(r.filled_holes, "hole", "holes",
      (r.smooth_fills == 0                ? ""
       : r.smooth_fills == r.filled_holes ? "smoothly "
                                          : "(" + std::to_string(r.smooth_fills) + " smoothly) ") +
          "closed with " + counted(r.added_triangles, "triangle", "triangles")),
      add(r.dropped_shells, "hidden shell", "hidden shells", "left out");
  return text.empty() ? "nothing to mend" : text;
}

std::string in_words(const geo::SolidRepairStats& done) {
  if (!done.united) return in_words(done.repair);
  return (done.repair.nothing() ? "" : in_words(done.repair) + ", ") +
         "crossing triangles cut: " + tool::counted(done.united->cells, "enclosed region") + " united, " +
         tool::counted(done.united->removed_faces, "face") + " inside left out";
}

// The mesh as a solid, with its triangles where they are sound.
geo::TriangleMesh solid_of(const Command& w, geo::TriangleMesh mesh, double diagonal, geo::SolidRepairStats& done) {
  if (w.voxel > 0) {
    done.repair = geo::repair(mesh, w.weld * diagonal, w.smooth);
    if (mesh.triangles.empty()) throw geo::InputError(w.model + ": has no triangles that bound anything");
  }
  try {
    if (w.voxel > 0)
      mesh = geo::wrapped(mesh, w.voxel * diagonal);
    else
      mesh = geo::repaired_solid(std::move(mesh), w.weld * diagonal, w.smooth, &done);
    if (w.edge > 0) mesh = geo::refined(mesh, w.edge * diagonal);
    if (w.voxel > 0 || w.edge > 0) geo::require_solid(mesh);
  } catch (const std::runtime_error& e) {
    const std::string what = e.what();
    throw tool::Failure(w.model + ": " + what.substr(0, what.rfind("; ")) +
                        (w.voxel > 0 ? "; try another --voxel" : "; wrap it in a new surface: --voxel 0.005"));
  }
  return mesh;
}

}  // namespace

int main(int argc, char** argv) {
  tool::Tool t(
      "kerf-repair",
      "Makes a solid of a surface: welds, turns triangles the same way, closes holes, unites parts that overlap; or "
      "wraps it in a new surface.",
      "  kerf-repair scan.obj -o solid.ply\n  kerf-repair scan.stl --weld 1e-5 -o solid.ply\n  kerf-repair scan.ply "
      "--smooth -o solid.ply\n  kerf-repair parts.obj --voxel 0.005 -o solid.ply\n  kerf-repair part.stl --edge 0.03 "
      "-o fine.ply\n  kerf-repair prop.obj | kerf-score - --pieces 30 -o score.front");
  Command w;
  t.argument("MODEL", w.model, "Surface (PLY, OBJ, STL, OFF, glTF, FBX); - reads standard input");
  t.option("--weld", w.weld, "Also weld open vertices up to this fraction of the model's diagonal apart");
  t.flag("--smooth", w.smooth, "Close holes by patches that go on from the surface around them, as fine as their rims");
  t.option("--voxel", w.voxel,
           "Make a new surface around all parts, of voxels of this fraction of the diagonal; 0: keep the triangles");
  t.option("--edge", w.edge, "At last, divide edges longer than this fraction of the diagonal; 0: none");
  t.unit_option(w.unit, "Unit of the model's coordinates, which the output states: m, cm, mm, in, ft ...");
  t.output("The solid (PLY; .obj on request)", {".ply", ".obj"});
  return t.run(argc, argv, [&] {
    if (!(w.weld >= 0 && w.weld <= 0.1)) throw tool::UsageError("--weld must be from 0 to 0.1");
    if (w.voxel != 0 && !(w.voxel >= 0.0005 && w.voxel <= 0.1))
      throw tool::UsageError("--voxel must be from 0.0005 to 0.1, or 0");
    if (w.edge != 0 && !(w.edge >= 0.0005 && w.edge <= 1))
      throw tool::UsageError("--edge must be from 0.0005 to 1, or 0");
    const std::string target = t.target(true);
    geo::TriangleMesh mesh = tool::read_surface(w.model).mesh;
    if (w.unit > 0) mesh.unit = w.unit;
    if (mesh.two_sided())
      throw geo::InputError(w.model + ": is cut, and sound as it is; give the model before the cut");
    const double diagonal = geo::bounding_box(mesh).diagonal();
    geo::SolidRepairStats done;
    mesh = solid_of(w, std::move(mesh), diagonal, done);
    if (target.ends_with(".obj")) tool::say_left_out_of_obj(mesh, target, t);
    geo::write_all(target, [&](std::ostream& out) {
      target.ends_with(".obj") ? geo::write_obj(out, mesh) : geo::write_ply(out, mesh, {}, "kerf-repair");
    });
    if (t.json)
      (target == "-" ? std::cerr : std::cout)
          << "{\"welded\":" << done.repair.welded_vertices << ",\"dropped\":" << done.repair.dropped_triangles
          << ",\"turned\":" << done.repair.flipped_triangles << ",\"holes\":" << done.repair.filled_holes
          << ",\"smooth\":" << done.repair.smooth_fills << ",\"added\":" << done.repair.added_triangles
          << ",\"hidden\":" << done.repair.dropped_shells << ",\"united\":" << (done.united ? done.united->cells : 0)
          << ",\"inside\":" << (done.united ? done.united->removed_faces : 0)
          << ",\"vertices\":" << mesh.vertices.size() << ",\"faces\":" << mesh.triangles.size()
          << ",\"volume\":" << tool::number(geo::signed_volume(mesh)) << "}\n";
    else
      t.say("kerf-repair: " + w.model + ": " + in_words(done) +
            (w.voxel > 0 ? "; wrapped in " + std::to_string(mesh.triangles.size()) + " triangles" : "") +
            (w.edge > 0 ? "; divided into " + std::to_string(mesh.triangles.size()) + " triangles" : ""));
  });
}
