// kerf-pieces: a closed mesh for each piece, and the bonds between them.
#include <unistd.h>

#include <cstdio>
#include <filesystem>
#include <map>

#include "io/stream.h"
#include "model.h"
#include "surface/pieces.h"
#include "tool.h"

int main(int argc, char** argv) {
  tool::Tool t("kerf-pieces", "Writes each piece of a cut surface as a closed mesh, with volumes and bonds in pieces.json.",
               "  kerf-pieces cut.ply -o pieces/\n  kerf-pieces cut.ply --obj -o pieces/");
  std::string model;
  bool obj = false;
  t.argument("SURFACE", model, "A cut surface from kerf-crack");
  t.flag("--obj", obj, "OBJ instead of PLY");
  t.output("Folder; made when it is not there");
  return t.run(argc, argv, [&] {
    namespace fs = std::filesystem;
    if (t.output_path.empty() || t.output_path == "-") throw tool::UsageError("give a folder with -o");
    fs::path folder = t.output_path;
    if (folder.filename().empty()) folder = folder.parent_path();
    std::error_code error;
    const bool there = fs::exists(folder, error);
    if (there && !fs::is_directory(folder, error)) throw geo::OutputError(folder.string() + ": is not a folder; give another name");
    if (there && !fs::is_empty(folder, error)) throw geo::OutputError(folder.string() + ": is not empty; remove it or give another name");
    const auto file = tool::read_solid(model);
    const geo::Complex complex = tool::complex_of(file, model);
    const geo::Pieces pieces = geo::find_pieces(complex);
    struct Bond {
      double area = 0;
      geo::Vec3 normal = geo::Vec3::Zero(), center = geo::Vec3::Zero();
    };
    std::map<std::pair<int, int>, Bond> bonds;
    for (std::uint32_t f = 0; f < complex.face_count(); ++f) {
      if (!complex.alive(geo::FaceId(f)) || complex.face(geo::FaceId(f)).crack == 0) continue;
      const int behind = pieces.of_side[f * 2], before = pieces.of_side[f * 2 + 1];
      if (behind == before) continue;
      const auto c = complex.corners(geo::FaceId(f));
      const geo::Vec3 n = 0.5 * (c[1] - c[0]).cross(c[2] - c[0]);
      Bond& bond = bonds[{std::min(behind, before), std::max(behind, before)}];
      bond.area += n.norm();
      bond.normal += behind < before ? n : geo::Vec3(-n);
      bond.center += n.norm() * (c[0] + c[1] + c[2]) / 3;
    }
    // Written aside as a whole folder, then renamed.
    const fs::path aside = folder.string() + "." + std::to_string(::getpid()) + ".tmp";
    geo::Unfinished unfinished(aside.string());
    if (!fs::create_directories(aside, error)) throw geo::OutputError(folder.string() + ": cannot be made (" + error.message() + ")");
    {
      std::string json = "{\"pieces\":[";
      for (std::uint32_t p = 0; p < pieces.count; ++p) {
        char name[64];
        std::snprintf(name, sizeof name, "piece_%03u.%s", p, obj ? "obj" : "ply");
        geo::TriangleMesh mesh = geo::piece_mesh(complex, pieces, p);
        geo::carry(file.mesh, mesh);
        mesh.site.clear();  // a piece is a model of its own; patch still tells skin from crack
        geo::write_all((aside / name).string(), [&](std::ostream& out) { obj ? geo::write_obj(out, mesh) : geo::write_ply(out, mesh); });
        json += std::string(p ? "," : "") + "{\"file\":\"" + name + "\",\"volume\":" + tool::number(pieces.volume[p]) + ",\"triangles\":" + std::to_string(mesh.triangles.size()) + "}";
      }
      json += "],\"bonds\":[";
      bool first = true;
      const auto vector = [](const geo::Vec3& v) { return "[" + tool::number(v.x()) + "," + tool::number(v.y()) + "," + tool::number(v.z()) + "]"; };
      for (const auto& [pair, bond] : bonds) {
        json += std::string(first ? "" : ",") + "{\"a\":" + std::to_string(pair.first) + ",\"b\":" + std::to_string(pair.second) + ",\"area\":" + tool::number(bond.area) +
                ",\"normal\":" + vector(bond.normal.normalized()) + ",\"centroid\":" + vector(bond.center / bond.area) + "}";
        first = false;
      }
      geo::write_all((aside / "pieces.json").string(), [&](std::ostream& out) { out << json << "]}\n"; });
      unfinished.commit(folder.string());  // over the empty folder, if there is one
    }
    if (t.json) std::printf("{\"pieces\":%u,\"bonds\":%zu}\n", pieces.count, bonds.size());
    if (t.verbose) t.say("kerf-pieces: " + std::to_string(pieces.count) + " pieces, " + std::to_string(bonds.size()) + " bonds");
  });
}
