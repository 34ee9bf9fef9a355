// Arrays are concatenated over the fractures of a shard, in order of seeds; offsets divide them.
#include "dataset/shard_file.h"

#include <array>
#include <iterator>
#include <nlohmann/json.hpp>

#include <kerf/export.h>
#include <kerf/files.h>
#include "dataset/npz.h"

namespace dataset {
namespace {

using Json = nlohmann::ordered_json;

void append(std::vector<double>& to, const geo::Vec3& v) { to.insert(to.end(), {v.x(), v.y(), v.z()}); }

// Indices as signed ones; no index, ~0u, becomes -1.
template <class Indices>
void append(std::vector<std::int32_t>& to, const Indices& indices) {
  for (const std::uint32_t i : indices) to.push_back(static_cast<std::int32_t>(i));
}

// The arrays of an archive.
struct Arrays {
  // Signed, as torch has no unsigned integers of these sizes.
  std::vector<std::int64_t> seed, fracture_pieces{0}, fracture_bonds{0}, piece_vertices{0}, piece_faces{0};
  std::vector<std::int64_t> bond_walls{0};
  std::vector<double> jagged, volume, centroid, rotation, translation, vertices, area, normal, bond_centroid;
  std::vector<std::int32_t> faces, source, bond, label, wall_faces;

  void add(const Fracture& fracture) {
    seed.push_back(static_cast<std::int64_t>(fracture.recipe.seed));
    jagged.push_back(fracture.recipe.jagged);
    for (const Piece& p : fracture.pieces) {
      for (const auto& v : p.vertices) append(vertices, v);
      for (const auto& t : p.faces) append(faces, t);
      label.insert(label.end(), p.label.begin(), p.label.end());
      append(source, p.source);
      piece_vertices.push_back(std::ssize(vertices) / 3);
      piece_faces.push_back(std::ssize(label));
      volume.push_back(p.volume);
      append(centroid, p.centroid);
      append(translation, p.translation);
      rotation.insert(rotation.end(), p.rotation.begin(), p.rotation.end());
    }
    for (std::size_t k = 0; k < fracture.bonds.size(); ++k) {
      const geo::Bond& b = fracture.bonds[k];
      append(bond, std::array{b.a, b.b});
      for (const auto& pair : fracture.walls[k]) append(wall_faces, pair);
      bond_walls.push_back(std::ssize(wall_faces) / 2);
      area.push_back(b.area);
      append(normal, b.normal);
      append(bond_centroid, b.centroid);
    }
    fracture_pieces.push_back(std::ssize(volume));
    fracture_bonds.push_back(std::ssize(area));
  }
};

Json list(const geo::Vec3& v) { return {v.x(), v.y(), v.z()}; }

void add_details(Json& entry, const Fracture& fracture, const std::string& folder) {
  for (std::size_t p = 0; p < fracture.pieces.size(); ++p) {
    const Piece& piece = fracture.pieces[p];
    entry["piece"].push_back({{"file", folder + "/piece_" + std::to_string(p) + ".ply"},
                              {"volume", piece.volume},
                              {"centroid", list(piece.centroid)},
                              {"rotation", piece.rotation},
                              {"translation", list(piece.translation)}});
  }
  entry["bond"] = Json::array();
  for (std::size_t k = 0; k < fracture.bonds.size(); ++k) {
    const auto& b = fracture.bonds[k];
    entry["bond"].push_back({{"label", k + 1},
                             {"a", b.a},
                             {"b", b.b},
                             {"area", b.area},
                             {"normal", list(b.normal)},
                             {"centroid", list(b.centroid)},
                             {"wall_faces", fracture.walls[k]}});
  }
}

// Whether points, three numbers each, are near enough to the origin for single precision.
bool fits_single(const std::vector<double>& points) {
  geo::Box3 box;
  for (std::size_t i = 0; i + 2 < points.size(); i += 3) box.add({points[i], points[i + 1], points[i + 2]});
  return geo::single_precision_offset(box).isZero(0);
}

}  // namespace

void write_archive(std::ostream& out, const std::vector<Outcome>& outcomes, bool single) {
  Arrays a;
  for (const auto& outcome : outcomes)
    if (outcome.fracture) a.add(*outcome.fracture);
  NpzWriter npz(out);
  const auto add = [&]<class T>(const char* name, const std::vector<T>& values, std::uint64_t columns = 1) {
    npz.add(name, std::span<const T>(values), columns);
  };
  add("seed", a.seed);
  add("jagged", a.jagged);
  add("fracture_pieces", a.fracture_pieces);
  add("fracture_bonds", a.fracture_bonds);
  add("piece_vertices", a.piece_vertices);
  add("piece_faces", a.piece_faces);
  add("piece_volume", a.volume);
  add("piece_centroid", a.centroid, 3);
  add("piece_rotation", a.rotation, 4);
  add("piece_translation", a.translation, 3);
  if (single && fits_single(a.vertices))
    add("vertices", std::vector<float>(a.vertices.begin(), a.vertices.end()), 3);
  else
    add("vertices", a.vertices, 3);
  add("faces", a.faces, 3);
  add("face_label", a.label);
  add("face_source", a.source);
  add("bond_pieces", a.bond, 2);
  add("bond_area", a.area);
  add("bond_normal", a.normal, 3);
  add("bond_centroid", a.bond_centroid, 3);
  add("bond_walls", a.bond_walls);
  add("wall_faces", a.wall_faces, 2);
  npz.finish();
}

void write_intact(std::ostream& out, const Model& model) { geo::write_ply(out, model.mesh, {}, "kerf-dataset"); }

void write_folder(const std::string& folder, const Fracture& fracture) {
  std::vector<std::string> paths;
  for (std::size_t p = 0; p < fracture.pieces.size(); ++p) {
    const Piece& piece = fracture.pieces[p];
    geo::TriangleMesh mesh;
    mesh.vertices = piece.vertices;
    mesh.triangles = piece.faces;
    mesh.patch = piece.label;
    mesh.source = piece.source;
    paths.push_back(folder + "/piece_" + std::to_string(p) + ".ply");
    geo::write_all(
        paths.back(), [&](std::ostream& out) { geo::write_ply(out, mesh, {}, "kerf-dataset"); }, geo::Sync::by_system);
  }
  geo::flush_to_disk(paths);
}

void write_record(std::ostream& out, const Shard& shard, const std::vector<Outcome>& outcomes, const RecordOf& of) {
  Json record{{"model", of.model}, {"set", of.set}, {"pattern", geo::pattern_names[std::size_t(shard.pattern)]}};
  if (!of.refused.empty()) record["refused"] = of.refused;
  record["fractures"] = Json::array();
  record["failed"] = Json::array();
  for (const auto& [seed, fracture, why] : outcomes) {
    if (!fracture) {
      record["failed"].push_back({{"seed", seed}, {"why", why}});
      continue;
    }
    std::size_t faces = 0;
    for (const auto& piece : fracture->pieces) faces += piece.faces.size();
    const auto& recipe = fracture->recipe;
    Json entry{{"seed", seed},
               {"pieces", fracture->pieces.size()},
               {"wanted", recipe.pieces},
               {"bonds", fracture->bonds.size()},
               {"faces", faces},
               {"jagged", recipe.jagged},
               {"command", command_of(recipe, of.file)}};
    if (of.details) add_details(entry, *fracture, shard.data.substr(shard.data.rfind('/') + 1));
    record["fractures"].push_back(std::move(entry));
  }
  out << record.dump(1, ' ', false, Json::error_handler_t::replace) << '\n';
}

}  // namespace dataset
