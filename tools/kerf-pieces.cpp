// kerf-pieces: writes pieces as closed meshes, and the bonds between them: a folder, a .glb or USD.
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <numeric>

#include <kerf/error.h>
#include <kerf/export.h>
#include <kerf/files.h>
#include <kerf/hierarchy.h>
#include <kerf/parallel.h>
#include <kerf/pieces.h>
#include "pieces/subject.h"
#include "tool.h"

namespace {

namespace fs = std::filesystem;

struct Command {
  std::string model, bonds, up = "y", physics = "none", names;
  bool obj = false, hulls = false, repair = false;
  int hull_corners = 64, hull_parts = 1, levels = 1;
  double tile = 0.25, strength = 1, density = 1000, least = 0, unit = 0;
};

void check(const Command& w, const std::string& output) {
  if (output.empty() || output == "-") throw tool::UsageError("give a folder or a .glb with -o");
  if (w.hull_corners < 4 || w.hull_corners > 100000)
    throw tool::UsageError("--hull-corners must be between 4 and 100000");
  if (w.hull_parts < 1 || w.hull_parts > 100) throw tool::UsageError("--hull-parts must be between 1 and 100");
  if (!(w.tile > 0 && w.tile <= 1e6)) throw tool::UsageError("--tile must be positive and at most 1000000");
  if (!(w.strength >= 0 && w.strength <= 1e100)) throw tool::UsageError("--strength must not be negative");
  if (!(w.density > 0 && w.density <= 1e100)) throw tool::UsageError("--density must be positive");
  if (!(w.least >= 0 && w.least < 1))
    throw tool::UsageError("--least must be from 0 to below 1, a share of the volume");
  if (w.levels < 1 || w.levels > 20) throw tool::UsageError("--levels must be between 1 and 20");
  const bool glb = output.ends_with(".glb"), file = glb || output.ends_with(".usda");
  if (!file && !w.bonds.empty()) throw tool::UsageError("--bonds belongs to a .glb or .usda; a folder has pieces.json");
  if (!glb && w.physics != "none") throw tool::UsageError("--physics belongs to a .glb; a .usda always has bodies");
  if (!glb && !w.names.empty()) throw tool::UsageError("--names belongs to a .glb");
}

// Counts of small pieces.
struct Joined {
  std::size_t joined = 0;    // into a neighbour
  std::size_t isolated = 0;  // still small, without a neighbour
};

// Joins pieces below the share `least` of the volume with their neighbours, in the complex.
Joined join_small(pieces::Subject& subject, double least, const std::string& path) {
  Joined result;
  if (least == 0) return result;
  if (!subject.moved.empty())
    throw geo::InputError(path + ": is deformed, its pieces are apart and cannot join; give the undeformed surface");
  const geo::Pieces all = geo::find_pieces(subject.complex);
  double whole = 0;
  for (const double v : all.volume) whole += v;
  const auto group = geo::join_small_pieces(all.volume, geo::find_bonds(subject.complex, all), least * whole);
  geo::heal(subject.complex, all, group);
  const geo::Pieces left = geo::find_pieces(subject.complex);
  result.joined = all.count - left.count;
  for (const double v : left.volume) result.isolated += v < least * whole;
  return result;
}

geo::GlbOptions glb_options(const Command& w) {
  geo::GlbOptions options;
  const bool bodies = w.physics != "none";
  if (w.hulls || bodies) options.hull_corners = static_cast<std::size_t>(w.hull_corners);
  options.hull_parts = static_cast<std::size_t>(w.hull_parts);
  options.z_up = w.up == "z";
  if (w.physics == "omi") options.physics = geo::GlbPhysics::omi;
  if (w.physics == "khr") options.physics = geo::GlbPhysics::khr;
  const std::string names = !w.names.empty() ? w.names : bodies ? "plain" : "unreal";
  options.names = names == "unreal"  ? geo::HullNames::unreal
                  : names == "godot" ? geo::HullNames::godot
                                     : geo::HullNames::plain;
  return options;
}

constexpr const char* materials_file = "materials.mtl";

// The library of the first chunk that has one.
geo::MaterialLibrary library_of(const std::vector<geo::Chunk>& chunks) {
  for (const geo::Chunk& chunk : chunks)
    if (chunk.mesh.attributes.library.glb) return chunk.mesh.attributes.library;
  return {};
}

// Writes the materials of all pieces with their images, if there are some. All pieces name them.
bool write_materials(const fs::path& folder, const std::vector<geo::Chunk>& chunks, const tool::Tool& t) {
  const geo::MaterialLibrary library = library_of(chunks);
  if (!library.glb) return false;
  std::vector<std::string> groups;
  for (const geo::Chunk& chunk : chunks)
    for (const std::string& name : chunk.mesh.attributes.group_names)
      if (std::find(groups.begin(), groups.end(), name) == groups.end()) groups.push_back(name);
  const geo::MtlFiles files = geo::mtl_files(groups, library, "");
  for (const geo::BesideFile& image : files.images) geo::write_beside(folder.string(), image);
  geo::write_beside(folder.string(), {materials_file, files.mtl});
  tool::say_left_out(files.left_out, t.output_path, ".glb", t);
  return true;
}

// Writes the images of a .usda beside it, and returns the beginning of their names.
std::string write_textures(const std::string& path, const std::vector<geo::Chunk>& chunks, const tool::Tool& t) {
  const std::string prefix = fs::path(path).stem().string() + "_";
  const geo::ImageFiles files = geo::image_files(library_of(chunks), prefix);
  for (const geo::BesideFile& image : files.images) geo::write_beside(fs::path(path).parent_path().string(), image);
  tool::say_left_out(files.left_out, path, ".glb", t);
  return prefix;
}

// Writes a temporary folder, then renames it.
void write_folder(fs::path folder, const Command& w, const std::vector<geo::Chunk>& chunks,
                  const std::vector<geo::Bond>& bonds, geo::ChunkLabels labels, const tool::Tool& t) {
  if (folder.filename().empty()) folder = folder.parent_path();
  std::error_code error;
  const fs::path aside = folder.string() + "." + std::to_string(::getpid()) + ".tmp";
  geo::TemporaryOutput unfinished(aside.string());
  if (!fs::create_directories(aside, error))
    throw geo::OutputError(folder.string() + ": cannot be made (" + error.message() + ")");
  const char* end = w.obj ? ".obj" : ".ply";
  const bool materials = write_materials(aside, chunks, t);
  const auto write = [&](const std::string& name, geo::TriangleMesh mesh) {
    mesh.attributes.library = {};  // images would be in the file of each piece
    mesh.attributes.materials = materials ? materials_file : "";
    geo::write_all((aside / name).string(),
                   [&](std::ostream& out) { w.obj ? geo::write_obj(out, mesh) : geo::write_ply(out, mesh); });
  };
  for (std::size_t p = 0; p < chunks.size(); ++p) {
    labels.names.push_back(geo::piece_name(p) + end);
    write(labels.names.back(), chunks[p].mesh);
    if (!w.hulls) continue;
    const auto hulls = geo::convex_decomposition(chunks[p].mesh, static_cast<std::size_t>(w.hull_parts),
                                                 static_cast<std::size_t>(w.hull_corners));
    for (std::size_t h = 0; h < hulls.size(); ++h)
      write("hull_" + geo::piece_name(p).substr(6) + geo::hull_suffix(h, hulls.size()) + end, hulls[h]);
  }
  geo::write_all((aside / "pieces.json").string(),
                 [&](std::ostream& out) { geo::write_bonds(out, chunks, bonds, labels); });
  unfinished.commit(folder.string());  // replaces an empty folder
}

// Refuses an output that would overwrite files.
void require_new_folder(const std::string& path) {
  std::error_code error;
  if (!fs::exists(path, error)) return;
  if (!fs::is_directory(path, error)) throw geo::OutputError(path + ": is not a folder; give another name");
  if (!fs::is_empty(path, error)) throw geo::OutputError(path + ": is not empty; remove it or give another name");
}

void write(const std::string& path, const Command& w, const std::vector<geo::Chunk>& chunks,
           const std::vector<geo::Bond>& bonds, geo::ChunkLabels labels, const tool::Tool& t) {
  const bool usd = path.ends_with(".usda");
  if (!usd && !path.ends_with(".glb")) return write_folder(path, w, chunks, bonds, std::move(labels), t);
  labels.kind = "node";
  labels.names = geo::piece_names(chunks.size());
  geo::UsdOptions stage;
  stage.z_up = w.up == "z";
  stage.hull_parts = static_cast<std::size_t>(w.hull_parts);
  if (usd) stage.image_prefix = write_textures(path, chunks, t);
  geo::write_all(path, [&](std::ostream& out) {
    usd ? geo::write_usd_pieces(out, chunks, bonds, labels, stage)
        : geo::write_glb(out, chunks, bonds, labels, glb_options(w));
  });
  if (w.bonds.empty()) return;
  const geo::PieceSet set = usd ? geo::PieceSet{chunks, bonds, labels} : geo::in_metres(chunks, bonds, labels);
  geo::write_all(w.bonds, [&](std::ostream& out) { geo::write_bonds(out, set.chunks, set.bonds, set.labels); });
}

// Says which pieces cross themselves in the coordinates of a .glb.
void say_crossings(const tool::Tool& t, const std::vector<geo::Chunk>& chunks) {
  std::vector<std::size_t> pairs(chunks.size());
  geo::parallel_for(chunks.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t p = begin; p < end; ++p) pairs[p] = geo::crossings_in_single_precision(chunks[p]);
  });
  const auto pieces = chunks.size() - static_cast<std::size_t>(std::count(pairs.begin(), pairs.end(), 0u));
  if (pieces == 0) return;
  const auto all = std::accumulate(pairs.begin(), pairs.end(), std::size_t(0));
  t.say("kerf-pieces: " + t.output_path + ": " + tool::counted(all, "pair") +
        " of triangles cross in single precision, in " + tool::counted(pieces, "piece") +
        "; a folder of .ply has double precision");
}

// Says what is not as in the model: a unit that is assumed, an offset, what the format does not
// hold.
void say_assumptions(const tool::Tool& t, const Command& w, const std::vector<geo::Chunk>& chunks) {
  const std::string& path = t.output_path;
  const bool usd = path.ends_with(".usda"), glb = path.ends_with(".glb");
  if (chunks.empty()) return;
  const geo::TriangleMesh& mesh = chunks[0].mesh;
  if (mesh.unit == 0 && (usd || w.physics != "none"))
    t.say("kerf-pieces: " + w.model + ": states no unit; one is taken as a metre, and --unit gives another");
  if (!usd && !glb) return;
  const geo::PieceSet set = glb ? geo::in_metres(chunks, {}, {}) : geo::PieceSet{chunks, {}, {}};
  const geo::Vec3 offset = geo::single_precision_offset(geo::bounding_box(set.chunks));
  if (!offset.isZero(0))
    t.say("kerf-pieces: " + path + ": the model is far from the origin; the root node moves the pieces by (" +
          tool::rounded(offset) + "); without that, pieces fit in single precision");
  if (glb) say_crossings(t, set.chunks);
}

// Reports in words or as JSON.
void report(const tool::Tool& t, const Command& w, std::size_t pieces, std::size_t bonds, const Joined& small,
            const std::vector<geo::ClusterLevel>& levels) {
  if (small.isolated > 0)
    t.say("kerf-pieces: " + w.model + ": " + tool::counted(small.isolated, "piece") +
          " below --least without a bond, left as found");
  if (t.json) {
    std::printf("{\"pieces\":%zu,\"bonds\":%zu", pieces, bonds);
    if (w.least > 0) std::printf(",\"joined\":%zu,\"isolated\":%zu", small.joined, small.isolated);
    if (!levels.empty()) {
      std::printf(",\"clusters\":[");
      for (std::size_t k = 0; k < levels.size(); ++k) std::printf(k > 0 ? ",%zu" : "%zu", levels[k].volume.size());
      std::printf("]");
    }
    std::printf("}\n");
  }
  if (!t.verbose) return;
  if (w.least > 0) t.say("kerf-pieces: " + tool::counted(small.joined, "small piece") + " joined with neighbours");
  t.say("kerf-pieces: " + tool::counted(pieces, "piece") + ", " + tool::counted(bonds, "bond"));
}

}  // namespace

int main(int argc, char** argv) {
  tool::Tool t(
      "kerf-pieces",
      "Writes each piece of a cut surface as a closed mesh, with bonds between them: all in one file, or as a folder.",
      R"(  kerf-pieces cut.ply -o pieces.glb
  kerf-pieces cut.ply --hulls --hull-parts 4 --bonds bonds.json -o pieces.glb
  kerf-pieces cut.ply --least 0.001 --levels 3 --physics omi --density 2400 --strength 1e5 -o pieces.glb
  kerf-pieces cut.ply --density 2400 --strength 1e5 --up z -o pieces.usda
  kerf-pieces cut.ply -o pieces/
  kerf-pieces cut.ply --obj --hulls -o objects/
  kerf-pieces out/halve -o halves.glb
  kerf-pieces out/halve/frames/frame_0020.ply -o frame20.glb)");
  Command w;
  t.argument("SURFACE", w.model, "A cut surface (kerf-crack), a body (.kerf), a run's folder, or a frame in it");
  t.flag("--repair", w.repair, "Repair a surface without cracks first, as kerf-repair does; its parts are the pieces");
  t.flag("--obj", w.obj, "In a folder: OBJ instead of PLY");
  t.option(
      "--least", w.least,
      "Least volume of a piece, as a share of the model's; a smaller one joins the neighbour with the greatest bond");
  t.option("--levels", w.levels,
           "Levels of a hierarchy: pieces, then clusters of them, up to one for each connected part; 1: pieces alone");
  t.flag("--hulls", w.hulls,
         "Also the convex hull of each piece, for a physics engine: nodes below the piece, or files hull_...");
  t.option("--hull-corners", w.hull_corners, "How many corners a hull has at most");
  t.option("--hull-parts", w.hull_parts, "Into how many convex parts, each with a hull, a piece is divided at most");
  t.choice("--names", w.names, {"plain", "unreal", "godot"},
           "Of a .glb: names of its hulls: piece_000_hull, UCX_piece_000 (the default without --physics), or "
           "piece_000_hull-convcolonly");
  t.choice("--physics", w.physics, {"none", "omi", "khr"},
           "Of a .glb: rigid bodies and hulls as OMI_physics_body, or as the review draft KHR_physics_rigid_bodies, "
           "which has joints");
  t.option("--density", w.density, "Mass of a cubic metre, for rigid bodies");
  t.unit_option(w.unit, "Unit of the model's coordinates, if its file states none: m, cm, mm, in, ft ...");
  t.option("--tile", w.tile, "Size of one texture tile on inner faces, as a fraction of the model's diagonal");
  t.option("--strength", w.strength, "Force that a square metre withstands; a bond's strength is this times its area");
  t.choice("--up", w.up, {"y", "z"}, "Of a .glb or .usda: which axis of the model is up");
  t.output_option("--bonds", w.bonds, "Of a .glb or .usda: also write pieces, bonds and clusters to this JSON file");
  t.output("pieces.glb, pieces.usda, or a folder; made when it is not there", {"a folder", ".glb", ".usda"});
  return t.run(argc, argv, [&] {
    check(w, t.output_path);
    const bool file = t.output_path.ends_with(".glb") || t.output_path.ends_with(".usda");
    file ? void(t.target(true)) : t.require_ending();
    if (!file) require_new_folder(t.output_path);
    pieces::Subject subject =
        pieces::read_subject(w.model, w.repair, [&](const std::string& line) { t.say("kerf-pieces: " + line); });
    const Joined small = join_small(subject, w.least, w.model);
    const geo::Complex& complex = subject.complex;
    const geo::Pieces found = geo::find_pieces(complex);
    const auto bonds = geo::find_bonds(complex, found, subject.moved);
    auto chunks = geo::make_chunks(complex, found, subject.mesh, w.tile * complex.extent().diagonal(), subject.moved);
    if (w.unit > 0)
      for (geo::Chunk& chunk : chunks) chunk.mesh.unit = w.unit;
    geo::ChunkLabels labels;
    labels.strength = w.strength;
    labels.density = w.density;
    labels.levels = geo::make_hierarchy(found.volume, bonds, static_cast<std::size_t>(w.levels));
    say_assumptions(t, w, chunks);
    write(t.output_path, w, chunks, bonds, labels, t);
    report(t, w, found.count, bonds.size(), small, labels.levels);
  });
}
