// kerf-pieces: writes pieces as closed meshes, and the bonds between them, as a folder or one .glb.
#include <unistd.h>

#include <cstdio>
#include <filesystem>

#include <kerf/export.h>
#include <kerf/files.h>
#include <kerf/pieces.h>
#include "pieces/subject.h"
#include "tool.h"

namespace {

namespace fs = std::filesystem;

struct Command {
  std::string model, bonds, up = "y";
  bool obj = false, hulls = false;
  int hull_corners = 64, hull_parts = 1;
  double tile = 0.25, strength = 1;
};

void check(const Command& w, const std::string& output) {
  if (output.empty() || output == "-") throw tool::UsageError("give a folder or a .glb with -o");
  if (w.hull_corners < 4 || w.hull_corners > 100000)
    throw tool::UsageError("--hull-corners must be between 4 and 100000");
  if (w.hull_parts < 1 || w.hull_parts > 100) throw tool::UsageError("--hull-parts must be between 1 and 100");
  if (!(w.tile > 0 && w.tile <= 1e6)) throw tool::UsageError("--tile must be positive and at most 1000000");
  if (!(w.strength >= 0 && w.strength <= 1e100)) throw tool::UsageError("--strength must not be negative");
}

std::string name_of(std::size_t piece, const char* end) {
  char name[64];
  std::snprintf(name, sizeof name, "piece_%03zu%s", piece, end);
  return name;
}

// Writes a temporary folder, then renames it.
void write_folder(fs::path folder, const Command& w, const std::vector<geo::Chunk>& chunks,
                  const std::vector<geo::Bond>& bonds, geo::ChunkLabels labels) {
  if (folder.filename().empty()) folder = folder.parent_path();
  std::error_code error;
  const fs::path aside = folder.string() + "." + std::to_string(::getpid()) + ".tmp";
  geo::TemporaryOutput unfinished(aside.string());
  if (!fs::create_directories(aside, error))
    throw geo::OutputError(folder.string() + ": cannot be made (" + error.message() + ")");
  const char* end = w.obj ? ".obj" : ".ply";
  const auto write = [&](const std::string& name, const geo::TriangleMesh& mesh) {
    geo::write_all((aside / name).string(),
                   [&](std::ostream& out) { w.obj ? geo::write_obj(out, mesh) : geo::write_ply(out, mesh); });
  };
  for (std::size_t p = 0; p < chunks.size(); ++p) {
    labels.names.push_back(name_of(p, end));
    write(labels.names.back(), chunks[p].mesh);
    if (!w.hulls) continue;
    const auto hulls = geo::convex_decomposition(chunks[p].mesh, static_cast<std::size_t>(w.hull_parts),
                                                 static_cast<std::size_t>(w.hull_corners));
    for (std::size_t h = 0; h < hulls.size(); ++h)
      write("hull_" + name_of(p, "").substr(6) + geo::hull_suffix(h, hulls.size()) + end, hulls[h]);
  }
  geo::write_all((aside / "pieces.json").string(),
                 [&](std::ostream& out) { geo::write_bonds(out, chunks, bonds, labels); });
  unfinished.commit(folder.string());  // replaces an empty folder
}

}  // namespace

int main(int argc, char** argv) {
  tool::Tool t(
      "kerf-pieces",
      "Writes each piece of a cut surface as a closed mesh, with bonds between them: all in one .glb, or as a folder.",
      "  kerf-pieces cut.ply -o pieces.glb\n  kerf-pieces cut.ply --hulls --hull-parts 4 --bonds bonds.json -o "
      "pieces.glb\n  kerf-pieces cut.ply -o pieces/\n  kerf-pieces cut.ply --obj --hulls -o objects/\n  kerf-pieces "
      "out/halve -o halves.glb\n  kerf-pieces out/halve/frames/frame_0020.ply -o frame20.glb");
  Command w;
  t.argument("SURFACE", w.model, "A cut surface (kerf-crack), a body (.kerf), a run's folder, or a frame in it");
  t.flag("--obj", w.obj, "In a folder: OBJ instead of PLY");
  t.flag("--hulls", w.hulls,
         "Also the convex hull of each piece, for a physics engine: nodes UCX_piece_... or files hull_...");
  t.option("--hull-corners", w.hull_corners, "How many corners a hull has at most");
  t.option("--hull-parts", w.hull_parts, "Into how many convex parts, each with a hull, a piece is divided at most");
  t.option("--tile", w.tile, "Size of one texture tile on inner faces, as a fraction of the model's diagonal");
  t.option("--strength", w.strength, "Force that an area of 1 withstands; a bond's strength is this times its area");
  t.choice("--up", w.up, {"y", "z"}, "Of a .glb: which axis of the model is up");
  t.option("--bonds", w.bonds,
           "Of a .glb: also write what its scene's extras say of pieces and bonds to this JSON file");
  t.output("pieces.glb, or a folder; made when it is not there", {"a folder", ".glb"});
  return t.run(argc, argv, [&] {
    check(w, t.output_path);
    const bool glb = t.output_path.ends_with(".glb");
    if (!glb && !w.bonds.empty()) throw tool::UsageError("--bonds belongs to a .glb; a folder has pieces.json");
    glb ? void(t.target(true)) : t.require_ending();
    std::error_code error;
    if (!glb && fs::exists(t.output_path, error)) {
      if (!fs::is_directory(t.output_path, error))
        throw geo::OutputError(t.output_path + ": is not a folder; give another name");
      if (!fs::is_empty(t.output_path, error))
        throw geo::OutputError(t.output_path + ": is not empty; remove it or give another name");
    }
    const pieces::Subject subject = pieces::read_subject(w.model);
    const geo::Complex& complex = subject.complex;
    const geo::Pieces found = geo::find_pieces(complex);
    const auto bonds = geo::find_bonds(complex, found, subject.moved);
    const auto chunks =
        geo::make_chunks(complex, found, subject.mesh, w.tile * complex.extent().diagonal(), subject.moved);
    geo::ChunkLabels labels{glb ? "node" : "file", {}, w.strength};
    if (!glb) {
      write_folder(t.output_path, w, chunks, bonds, labels);
    } else {
      for (std::size_t p = 0; p < chunks.size(); ++p) labels.names.push_back(name_of(p, ""));
      geo::write_all(t.output_path, [&](std::ostream& out) {
        geo::write_glb(out, chunks, bonds, labels,
                       {w.hulls ? static_cast<std::size_t>(w.hull_corners) : 0, static_cast<std::size_t>(w.hull_parts),
                        w.up == "z"});
      });
      if (!w.bonds.empty())
        geo::write_all(w.bonds, [&](std::ostream& out) { geo::write_bonds(out, chunks, bonds, labels); });
    }
    if (t.json) std::printf("{\"pieces\":%u,\"bonds\":%zu}\n", found.count, bonds.size());
    if (t.verbose)
      t.say("kerf-pieces: " + tool::counted(found.count, "piece") + ", " + tool::counted(bonds.size(), "bond"));
  });
}
