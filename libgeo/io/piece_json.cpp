// write_bonds() and the names of kerf/export.h; io/piece_json.h.
#include "io/piece_json.h"

#include <cmath>
#include <cstdio>

#include <Eigen/Eigenvalues>

#include "kerf/error.h"

namespace geo {
namespace {

using Json = nlohmann::ordered_json;

Json bond_json(const Bond& bond, double strength) {
  return {{"a", bond.a},
          {"b", bond.b},
          {"area", bond.area},
          {"normal", json_row(bond.normal)},
          {"centroid", json_row(bond.centroid)},
          {"strength", strength * bond.area}};
}

Json levels_json(const std::vector<Chunk>& chunks, const ChunkLabels& labels, double unit) {
  const auto centroids = cluster_centroids(chunks, labels.levels);
  Json levels = Json::array();
  for (std::size_t k = 0; k < labels.levels.size(); ++k) {
    const ClusterLevel& level = labels.levels[k];
    Json clusters = Json::array(), bonds = Json::array();
    for (std::size_t c = 0; c < level.volume.size(); ++c) {
      clusters.push_back(
          {{"name", cluster_name(k + 1, c)}, {"volume", level.volume[c]}, {"centroid", json_row(centroids[k][c])}});
      if (k + 1 < labels.levels.size()) clusters.back()["parent"] = labels.levels[k + 1].of[c];
    }
    for (const Bond& bond : level.bonds) bonds.push_back(bond_json(bond, labels.strength * unit * unit));
    levels.push_back({{"clusters", clusters}, {"bonds", bonds}});
  }
  return levels;
}

std::string numbered_name(const char* form, std::size_t a, std::size_t b = 0) {
  char name[96];
  std::snprintf(name, sizeof name, form, a, b);
  return name;
}

}  // namespace

std::string piece_name(std::size_t piece) { return numbered_name("piece_%03zu", piece); }

std::string cluster_name(std::size_t level, std::size_t cluster) {
  return numbered_name("cluster_%zu_%03zu", level, cluster);
}

std::vector<std::string> piece_names(std::size_t count) {
  std::vector<std::string> names;
  for (std::size_t p = 0; p < count; ++p) names.push_back(piece_name(p));
  return names;
}

std::string hull_suffix(std::size_t part, std::size_t parts) {
  if (parts < 2) return {};
  return (part < 10 ? "_0" : "_") + std::to_string(part);
}

nlohmann::ordered_json pieces_json(const std::vector<Chunk>& chunks, const std::vector<Bond>& bonds,
                                   const ChunkLabels& labels) {
  Json pieces = Json::array(), held = Json::array();
  for (std::size_t p = 0; p < chunks.size(); ++p) {
    pieces.push_back({{labels.kind, labels.names[p]},
                      {"volume", chunks[p].volume},
                      {"centroid", json_row(chunks[p].centroid)},
                      {"triangles", chunks[p].mesh.triangles.size()}});
    if (!labels.levels.empty()) pieces.back()["parent"] = labels.levels[0].of[p];
  }
  const double stated = chunks.empty() ? 0 : chunks[0].mesh.unit, unit = stated > 0 ? stated : 1;
  for (const Bond& bond : bonds) {
    held.push_back(bond_json(bond, labels.strength * unit * unit));
    held.back()["torque"] = labels.strength * bond.section * unit * unit * unit;
  }
  Json all = {{"pieces", pieces}, {"bonds", held}};
  if (unit != 1) all["unit"] = unit;
  if (!labels.levels.empty()) all["levels"] = levels_json(chunks, labels, unit);
  return all;
}

void write_bonds(std::ostream& out, const std::vector<Chunk>& chunks, const std::vector<Bond>& bonds,
                 const ChunkLabels& labels) {
  out << pieces_json(chunks, bonds, labels).dump(-1, ' ', false, Json::error_handler_t::replace) << '\n';
}

std::vector<std::vector<Vec3>> cluster_centroids(const std::vector<Chunk>& chunks,
                                                 const std::vector<ClusterLevel>& levels) {
  std::vector<std::vector<Vec3>> result;
  std::vector<Vec3> moment;
  std::vector<double> volume;
  for (const Chunk& chunk : chunks) {
    volume.push_back(chunk.volume);
    moment.push_back(chunk.volume * chunk.centroid);
  }
  for (const ClusterLevel& level : levels) {
    std::vector<Vec3> sum(level.volume.size(), Vec3::Zero());
    std::vector<double> total(level.volume.size(), 0);
    for (std::size_t i = 0; i < level.of.size(); ++i) {
      sum[level.of[i]] += moment[i];
      total[level.of[i]] += volume[i];
    }
    result.emplace_back();
    for (std::size_t c = 0; c < sum.size(); ++c)
      result.back().push_back(total[c] > 0 ? Vec3(sum[c] / total[c]) : Vec3(Vec3::Zero()));
    moment = std::move(sum);
    volume = std::move(total);
  }
  return result;
}

RigidBody rigid_body(const Chunk& chunk, double density) {
  const MassProperties exact = mass_properties(chunk.mesh);
  if (!(exact.volume > 0)) return {};
  const Eigen::SelfAdjointEigenSolver<Mat3> principal(exact.inertia);
  Mat3 axes = principal.eigenvectors();
  if (axes.determinant() < 0) axes.col(2) = -axes.col(2);
  Eigen::Quaterniond turn(axes);
  turn.normalize();
  if (turn.w() < 0) turn.coeffs() = -turn.coeffs();
  return {density * exact.volume, density * principal.eigenvalues().cwiseMax(0), turn};
}

std::vector<std::array<Vec3, 3>> corner_normals(const TriangleMesh& mesh) {
  std::vector<Vec3> normal(mesh.triangles.size());
  std::vector<std::vector<std::uint32_t>> at(mesh.vertices.size());
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto& [a, b, c] = mesh.triangles[t];
    normal[t] = (mesh.vertices[b] - mesh.vertices[a]).cross(mesh.vertices[c] - mesh.vertices[a]);
    for (const auto v : mesh.triangles[t]) at[v].push_back(t);
  }
  std::vector<std::array<Vec3, 3>> result(mesh.triangles.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k) {
      if (!mesh.attributes.normal.empty() && mesh.patch[t] == 0) {
        result[t][k] = mesh.attributes.normal[t][k];
        continue;
      }
      Vec3 sum = Vec3::Zero();
      for (const auto other : at[mesh.triangles[t][k]])
        if ((mesh.patch[other] == 0) == (mesh.patch[t] == 0) &&
            normal[t].stableNormalized().dot(normal[other].stableNormalized()) > std::sqrt(0.5))
          sum += normal[other];
      result[t][k] = sum.norm() > 0 ? sum.stableNormalized() : Vec3(Vec3::UnitZ());
    }
  return result;
}

Chunk completed(Chunk chunk) {
  TriangleMesh& mesh = chunk.mesh;
  const std::size_t count = mesh.triangles.size();
  if (count == 0) throw InputError("a piece without triangles cannot be written; leave it out");
  mesh.patch.resize(count, 0);
  mesh.attributes.uv.resize(count, {Vec2::Zero(), Vec2::Zero(), Vec2::Zero()});
  if (mesh.attributes.group.empty()) {
    mesh.attributes.group.assign(count, 0);
    mesh.attributes.group_names = {"skin"};
  }
  return chunk;
}

}  // namespace geo
