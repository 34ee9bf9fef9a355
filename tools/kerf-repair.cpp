// kerf-repair: makes a valid solid from a surface with faults, or wraps it in a new surface.
#include <algorithm>
#include <iostream>
#include <optional>

#include <kerf/check.h>
#include <kerf/crack.h>
#include <kerf/files.h>
#include <kerf/mesh.h>
#include <kerf/repair.h>
#include "model.h"
#include "scan/scan.h"
#include "tool.h"

namespace {

struct Command {
  std::string model;
  double weld = 0, voxel = 0, edge = 0, unit = 0;
  bool smooth = false, single = false;
  std::string inner = "oriented", open = "auto";
  scan::Options scan;
};

struct Outcome {
  std::optional<scan::Stats> scan;
  geo::SolidRepairStats solid;
  geo::OpenSheetStats sheets;  // with --voxel
  geo::RoundingStats rounding;
};

geo::InnerShells inner_of(const Command& w) {
  if (w.inner == "cavities") return geo::InnerShells::cavities;
  return w.inner == "filled" ? geo::InnerShells::filled : geo::InnerShells::by_orientation;
}

geo::OpenParts open_of(const Command& w) {
  if (w.open == "closed") return geo::OpenParts::closed;
  return w.open == "sheets" ? geo::OpenParts::sheets : geo::OpenParts::by_area;
}

std::string in_words(const geo::RepairStats& r) {
  std::string text;
  const auto counted = [](std::size_t n, const std::string& one, const std::string& many) {
    return std::to_string(n) + " " + (n == 1 ? one : many);
  };
  const auto add = [&](std::size_t n, const std::string& one, const std::string& many, const std::string& done) {
    if (n > 0) text += (text.empty() ? "" : ", ") + counted(n, one, many) + " " + done;
  };
  add(r.welded_vertices, "vertex", "vertices", "welded");
  add(r.dropped_triangles, "triangle", "triangles", "dropped");
  add(r.flipped_triangles, "triangle", "triangles", "turned");
  const std::string smoothly = r.smooth_fills == 0 ? ""
                               : r.smooth_fills == r.filled_holes
                                   ? "smoothly "
                                   : "(" + std::to_string(r.smooth_fills) + " smoothly) ";
  add(r.filled_holes, "hole", "holes", smoothly + "closed with " + counted(r.added_triangles, "triangle", "triangles"));
  if (const std::string shells = tool::shell_decisions(r); !shells.empty()) text += (text.empty() ? "" : ", ") + shells;
  return text;
}

std::string in_words(const scan::Stats& scan, double diagonal) {
  const auto percent = [&](double share) { return tool::rounded(100 * share) + " %"; };
  std::string text = tool::counted(scan.points, "point");
  if (scan.outliers > 0) text += ", " + tool::counted(scan.outliers, "outlier") + " left out";
  if (scan.estimated) text += ", normals estimated";
  text += "; surface of depth " + std::to_string(scan.depth) + ", from the points " + percent(scan.median / diagonal) +
          " of the diagonal (median), " + percent(scan.upper / diagonal) + " (95 of 100)";
  if (scan.blobs > 0) text += "; " + tool::counted(scan.blobs, "part") + " without points left out";
  if (scan.holes > 0)
    text += "; " + tool::counted(scan.holes, "region") + " without points filled, " + percent(scan.hole_share) +
            " of the area: look there first";
  return text;
}

std::string in_words(const Outcome& done, const Command& w) {
  geo::RepairStats all = done.solid.repair;
  all.welded_vertices += done.sheets.welded_vertices;
  all.dropped_triangles += done.sheets.dropped_triangles;
  std::string text = in_words(all);
  const auto add = [&](const std::string& more) { text += (text.empty() ? "" : ", ") + more; };
  if (done.solid.united)
    add("crossing triangles cut: " + tool::counted(done.solid.united->cells, "enclosed region") + " united, " +
        tool::counted(done.solid.united->removed_faces, "face") + " inside left out");
  if (done.sheets.sheets > 0)
    add(tool::counted(done.sheets.sheets, "open sheet") + " made " + (done.sheets.sheets == 1 ? "a plate" : "plates") +
        " one voxel thick (--open closed closes holes instead)");
  if (done.rounding.rounds > 0)
    add(tool::counted(done.rounding.crossings, "pair") + " of triangles that " +
        (done.rounding.crossings == 1 ? "crosses" : "cross") + " in single precision divided");
  if (w.voxel > 0 && w.open == "auto" && done.solid.repair.filled_holes > 0) add("(--open sheets leaves holes open)");
  return text.empty() ? "nothing to mend" : text;
}

std::string figures(const Outcome& done, const geo::TriangleMesh& mesh) {
  const geo::RepairStats& repair = done.solid.repair;
  std::string text = "{";
  const auto add = [&](const std::string& key, const std::string& value) {
    text += (text.size() > 1 ? ",\"" : "\"") + key + "\":" + value;
  };
  const auto count = [&](const std::string& key, std::size_t n) { add(key, std::to_string(n)); };
  count("welded", repair.welded_vertices + done.sheets.welded_vertices);
  count("dropped", repair.dropped_triangles + done.sheets.dropped_triangles);
  count("turned", repair.flipped_triangles);
  count("holes", repair.filled_holes);
  count("smooth", repair.smooth_fills);
  count("added", repair.added_triangles);
  count("inverted", repair.inverted_shells);
  count("hidden", repair.dropped_shells);
  count("hollowed", repair.hollowed_shells);
  count("filled", repair.filled_shells);
  count("sheets", done.sheets.sheets);
  count("united", done.solid.united ? done.solid.united->cells : 0);
  count("inside", done.solid.united ? done.solid.united->removed_faces : 0);
  count("rounded", done.rounding.crossings);
  count("vertices", mesh.vertices.size());
  count("faces", mesh.triangles.size());
  add("volume", tool::number(geo::signed_volume(mesh)));
  if (done.scan) {
    count("points", done.scan->points);
    count("outliers", done.scan->outliers);
    count("depth", static_cast<std::size_t>(done.scan->depth));
    count("unseen", done.scan->holes);
    add("unseen_share", tool::number(done.scan->hole_share));
    add("median", tool::number(done.scan->median));
    add("upper", tool::number(done.scan->upper));
  }
  return text + "}";
}

// The model's mesh, made of its points where the file is a scan.
geo::TriangleMesh read_model(const Command& w, Outcome& done) {
  const std::string bytes = geo::read_all(w.model);
  if (!geo::holds_points(bytes, w.model)) return tool::parse_surface(bytes, w.model).mesh;
  const geo::PointCloud cloud = geo::parse_points(bytes, w.model);
  if (cloud.left_out > 0) {
    geo::SurfaceFile about;
    about.notes.push_back("left out: " + tool::counted(cloud.left_out, "point") + " without a place or a normal");
    tool::say_notes(about, w.model);
  }
  try {
    scan::Result result = scan::reconstruct(cloud, w.scan);
    done.scan = result.stats;
    return std::move(result.mesh);
  } catch (const geo::InputError& error) {
    throw geo::InputError(w.model + ": " + error.what());
  }
}

// Throws InputError for a mesh of which nothing can be made, whatever the options.
void require_triangles(const std::string& path, const geo::TriangleMesh& mesh) {
  const bool any = std::any_of(mesh.triangles.begin(), mesh.triangles.end(), [&](const geo::Triangle& t) {
    const geo::Vec3 &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &c = mesh.vertices[t[2]];
    return a != b && b != c && c != a;
  });
  if (!any) throw geo::InputError(path + ": no triangle has three different corners; give a surface");
}

// The mesh as a solid, with its triangles where they are sound.
geo::TriangleMesh solid_of(const Command& w, geo::TriangleMesh mesh, double diagonal, Outcome& done) {
  const geo::RepairOptions options{w.weld * diagonal, w.smooth, inner_of(w)};
  try {
    if (w.voxel > 0) {
      geo::WrapStats wrapped;
      mesh = geo::wrapped_solid(std::move(mesh), w.voxel * diagonal, options, open_of(w), &wrapped);
      done.solid.repair = wrapped.repair;
      done.sheets = wrapped.sheets;
    } else {
      mesh = geo::repaired_solid(std::move(mesh), options, &done.solid);
    }
    if (w.edge > 0) {
      mesh = geo::refined(mesh, w.edge * diagonal);
      geo::require_solid(mesh);
    }
    if (w.single) mesh = geo::rounded_solid(mesh, &done.rounding);
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
      R"(  kerf-repair scan.obj -o solid.ply
  kerf-repair scan.stl --weld 1e-5 -o solid.ply
  kerf-repair scan.ply --smooth -o solid.ply
  kerf-repair parts.obj --voxel 0.005 -o solid.ply
  kerf-repair scan.pcd -o solid.ply
  kerf-repair part.stl --edge 0.03 -o fine.ply
  kerf-repair prop.obj | kerf-score - --pieces 30 -o score.front)");
  Command w;
  t.argument("MODEL", w.model,
             "Surface (PLY, OBJ, STL, OFF, glTF, FBX), or points of a scan (PCD, PLY, XYZ); - reads standard input");
  t.option("--weld", w.weld, "Also weld open vertices up to this fraction of the model's diagonal apart");
  t.flag("--smooth", w.smooth, "Close holes by patches that go on from the surface around them, as fine as their rims");
  t.option("--voxel", w.voxel,
           "Make a new surface around all parts, of voxels of this fraction of the diagonal; 0: keep the triangles");
  t.choice("--inner", w.inner, {"oriented", "cavities", "filled"},
           "Shells in solid material: those oriented against it are cavities and others hidden; all cavities; none");
  t.choice("--open", w.open, {"auto", "closed", "sheets"},
           "With --voxel, parts with open edges: plates where closing them takes half their area; closed; plates");
  t.option("--edge", w.edge, "At last, divide edges longer than this fraction of the diagonal; 0: none");
  t.flag("--single", w.single, "Coordinates in single precision, valid as such; always for an .stl");
  t.option("--outliers", w.scan.outliers,
           "Of a scan: leave out points whose neighbours are farther than the mean by this many standard deviations; "
           "0: none");
  t.option(
      "--depth", w.scan.depth,
      "Of a scan: finest cells have this power of a half of its size, from 4 to 12; 0: by the spacing of its points");
  t.unit_option(w.unit, "Unit of the model's coordinates, which the output states: m, cm, mm, in, ft ...");
  t.output("The solid (PLY; .obj, .stl or .off on request)", {".ply", ".obj", ".stl", ".off"});
  return t.run(argc, argv, [&] {
    if (!(w.weld >= 0 && w.weld <= 0.1)) throw tool::UsageError("--weld must be from 0 to 0.1");
    if (w.voxel != 0 && !(w.voxel >= 0.0005 && w.voxel <= 0.1))
      throw tool::UsageError("--voxel must be from 0.0005 to 0.1, or 0");
    if (w.edge != 0 && !(w.edge >= 0.0005 && w.edge <= 1))
      throw tool::UsageError("--edge must be from 0.0005 to 1, or 0");
    if (!(w.scan.outliers >= 0 && w.scan.outliers <= 1000)) throw tool::UsageError("--outliers must be from 0 to 1000");
    if (w.scan.depth != 0 && (w.scan.depth < 4 || w.scan.depth > 12))
      throw tool::UsageError("--depth must be from 4 to 12, or 0");
    const std::string target = t.target(true);
    Outcome done;
    geo::TriangleMesh mesh = read_model(w, done);
    if (w.unit > 0) mesh.unit = w.unit;
    if (mesh.two_sided())
      throw geo::InputError(w.model + ": is cut, and sound as it is; give the model before the cut");
    require_triangles(w.model, mesh);
    const double diagonal = geo::bounding_box(mesh).diagonal();
    w.single = w.single || target.ends_with(".stl");
    mesh = solid_of(w, std::move(mesh), diagonal, done);
    tool::write_surface(mesh, {}, target, t);
    if (t.json)
      (target == "-" ? std::cerr : std::cout) << figures(done, mesh) << '\n';
    else
      t.say("kerf-repair: " + w.model + ": " + (done.scan ? in_words(*done.scan, diagonal) + "; " : "") +
            in_words(done, w) +
            (w.voxel > 0 ? "; wrapped in " + std::to_string(mesh.triangles.size()) + " triangles" : "") +
            (w.edge > 0 ? "; divided into " + std::to_string(mesh.triangles.size()) + " triangles" : ""));
  });
}
