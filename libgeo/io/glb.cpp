// write_glb() of kerf/export.h. Corners with equal attributes share a vertex; colours are converted
// from sRGB to linear.
#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

#include "io/glb_file.h"
#include "io/glb_physics.h"
#include "io/gltf_materials.h"
#include "io/piece_json.h"
#include "io/preview_material.h"
#include "kerf/error.h"
#include "kerf/export.h"

namespace geo {
namespace {

using Json = GlbFile::Json;

double linear(double c) {  // IEC 61966-2-1
  c = std::clamp(c, 0.0, 1.0);
  return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
}

// The triangles of one group. Corners with equal values are merged.
Json primitive(GlbFile& glb, const Chunk& chunk, const std::vector<std::array<Vec3, 3>>& normals, std::int32_t group,
               std::size_t material) {
  const TriangleMesh& mesh = chunk.mesh;
  const Attributes& a = mesh.attributes;
  struct Corner {
    std::array<float, 10> at;  // position, normal, uv, second uv
    std::array<std::uint16_t, 4> color;
    bool operator<(const Corner& o) const { return std::tie(at, color) < std::tie(o.at, o.color); }
  };
  std::map<Corner, std::uint32_t> rows;
  std::vector<float> position, normal, uv, uv2;
  std::vector<std::uint16_t> color;
  std::vector<std::uint32_t> index;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (a.group[t] != group) continue;
    for (std::size_t k = 0; k < 3; ++k) {
      Corner corner{};
      const Vec3 p = mesh.vertices[mesh.triangles[t][k]] - chunk.centroid;
      for (int i = 0; i < 3; ++i) {
        corner.at[std::size_t(i)] = float(p[i]);
        corner.at[std::size_t(3 + i)] = float(normals[t][k][i]);
      }
      corner.at[6] = float(a.uv[t][k].x());
      corner.at[7] = float(1 - a.uv[t][k].y());  // in glTF v points downwards
      if (!a.uv2.empty()) {
        corner.at[8] = float(a.uv2[t][k].x());
        corner.at[9] = float(1 - a.uv2[t][k].y());
      }
      if (!a.color.empty())
        for (int i = 0; i < 4; ++i)
          corner.color[std::size_t(i)] = static_cast<std::uint16_t>(
              std::lround(65535 * (i < 3 ? linear(a.color[t][k][i]) : std::clamp(a.color[t][k][i], 0.0, 1.0))));
      const auto [entry, fresh] = rows.try_emplace(corner, static_cast<std::uint32_t>(rows.size()));
      index.push_back(entry->second);
      if (!fresh) continue;
      position.insert(position.end(), corner.at.begin(), corner.at.begin() + 3);
      normal.insert(normal.end(), corner.at.begin() + 3, corner.at.begin() + 6);
      uv.insert(uv.end(), corner.at.begin() + 6, corner.at.begin() + 8);
      uv2.insert(uv2.end(), corner.at.begin() + 8, corner.at.end());
      color.insert(color.end(), corner.color.begin(), corner.color.end());
    }
  }
  Json attributes = {{"POSITION", glb.positions(position)},
                     {"NORMAL", glb.accessor(normal, 5126, "VEC3", rows.size())},
                     {"TEXCOORD_0", glb.accessor(uv, 5126, "VEC2", rows.size())}};
  if (!a.uv2.empty()) attributes["TEXCOORD_1"] = glb.accessor(uv2, 5126, "VEC2", rows.size());
  if (!a.color.empty()) {
    attributes["COLOR_0"] = glb.accessor(color, 5123, "VEC4", rows.size());
    glb.json["accessors"].back()["normalized"] = true;
  }
  return {{"attributes", attributes}, {"indices", glb.indices(index)}, {"material", material}};
}

Json hull_primitive(GlbFile& glb, const TriangleMesh& hull, const Vec3& origin) {
  std::vector<float> position;
  std::vector<std::uint32_t> index;
  for (const Vec3& p : hull.vertices)
    for (int i = 0; i < 3; ++i) position.push_back(float(p[i] - origin[i]));
  for (const auto& t : hull.triangles) index.insert(index.end(), t.begin(), t.end());
  const auto at = glb.positions(position);
  return {{"attributes", {{"POSITION", at}}}, {"indices", glb.indices(index)}};
}

std::string hull_name(HullNames names, const std::string& piece, const std::string& suffix) {
  switch (names) {
    case HullNames::unreal:
      return "UCX_" + piece + suffix;
    case HullNames::godot:
      return piece + "_hull" + suffix + "-convcolonly";
    case HullNames::plain:
      break;
  }
  return piece + "_hull" + suffix;
}

// Writes the nodes of pieces and clusters, from the pieces upwards.
class GlbScene {
 public:
  GlbScene(const std::vector<Chunk>& chunks, const std::vector<Bond>& bonds, const ChunkLabels& labels,
           const GlbOptions& options)
      : chunks_(chunks),
        bonds_(bonds),
        labels_(labels),
        options_(options),
        physics_(glb_, options.physics),
        offset_(single_precision_offset(bounding_box(chunks))),
        centroids_(cluster_centroids(chunks, labels.levels)),
        attachments_(chunks.size()) {}

  void write(std::ostream& out) {
    for (const Chunk& chunk : chunks_)
      if (const auto& library = chunk.mesh.attributes.library.glb; library && materials_.empty()) add_library(*library);
    if (physics_.has_joints()) add_joints();
    std::vector<std::size_t> nodes;
    for (std::size_t p = 0; p < chunks_.size(); ++p) nodes.push_back(piece_node(p));
    for (std::size_t k = 0; k < labels_.levels.size(); ++k) nodes = cluster_nodes(k, nodes);
    Json root = {{"name", "pieces"}, {"children", nodes}};
    // Quaternion (x, y, z, w) of −90° about x, which turns z upwards to y.
    const double half = std::sqrt(0.5);
    if (options_.z_up) root["rotation"] = Json::array({-half, 0.0, 0.0, half});
    // The rotation acts before the translation.
    const Vec3 moved = options_.z_up ? Vec3(offset_.x(), offset_.z(), -offset_.y()) : offset_;
    if (!offset_.isZero(0)) root["translation"] = json_row(moved);
    const std::size_t top = glb_.node(std::move(root));
    glb_.json["scenes"].push_back({{"nodes", Json::array({top})}, {"extras", pieces_json(chunks_, bonds_, labels_)}});
    glb_.write(out);
  }

 private:
  // The origin of the node above a piece (level 0) or above a cluster of a level.
  Vec3 origin_above(std::size_t level, std::size_t which) const {
    return level < labels_.levels.size() ? centroids_[level][labels_.levels[level].of[which]] : offset_;
  }

  void add_library(const std::string& library) {
    const auto names = add_materials(glb_, library);
    for (std::size_t i = 0; i < names.size(); ++i) materials_.try_emplace(names[i], i);
    next_material_ = names.size();
  }

  // Without a library: grey, or white where corners have colours, which multiply.
  std::size_t material(const std::string& name, bool colored) {
    const auto [entry, fresh] = materials_.try_emplace(name, next_material_);
    next_material_ += fresh;
    const Color base = colored ? Color(Color::Ones()) : plain_material(name).base;
    const Json color = Json::array({base[0], base[1], base[2], base[3]});
    if (fresh)
      glb_.json["materials"].push_back(
          {{"name", name},
           {"pbrMetallicRoughness", {{"baseColorFactor", color}, {"metallicFactor", 0.0}, {"roughnessFactor", 0.9}}}});
    return entry->second;
  }

  std::size_t piece_node(std::size_t p) {
    const Chunk chunk = completed(chunks_[p]);
    const Attributes& a = chunk.mesh.attributes;
    const auto normals = corner_normals(chunk.mesh);
    Json primitives = Json::array();
    for (std::int32_t g = 0; g < std::int32_t(a.group_names.size()); ++g)
      if (std::find(a.group.begin(), a.group.end(), g) != a.group.end())
        primitives.push_back(
            primitive(glb_, chunk, normals, g, material(a.group_names[std::size_t(g)], !a.color.empty())));
    Json node = {{"name", labels_.names[p]},
                 {"translation", json_row(chunk.centroid - origin_above(0, p))},
                 {"mesh", glb_.mesh(primitives, labels_.names[p])},
                 {"extras", {{"volume", chunk.volume}}}};
    if (options_.physics != GlbPhysics::none) physics_.add_body(node, rigid_body(chunk, labels_.density));
    if (options_.hull_corners > 0) add_hulls(node, p, chunk);
    for (const auto at : attachments_[p]) node["children"].push_back(at);
    return glb_.node(std::move(node));
  }

  void add_hulls(Json& node, std::size_t p, const Chunk& chunk) {
    const auto hulls = convex_decomposition(chunk.mesh, options_.hull_parts, options_.hull_corners);
    for (std::size_t h = 0; h < hulls.size(); ++h) {
      const std::string name = hull_name(options_.names, labels_.names[p], hull_suffix(h, hulls.size()));
      const std::size_t mesh = glb_.mesh(Json::array({hull_primitive(glb_, hulls[h], chunk.centroid)}), name);
      Json hull = {{"name", name}};
      // A hull of physics without an engine's name is a shape alone, which nothing draws.
      if (options_.physics == GlbPhysics::none || options_.names != HullNames::plain) hull["mesh"] = mesh;
      physics_.add_collider(hull, mesh);
      node["children"].push_back(glb_.node(std::move(hull)));
    }
  }

  // The nodes of a level of clusters, above those of the level below.
  std::vector<std::size_t> cluster_nodes(std::size_t k, const std::vector<std::size_t>& below) {
    const ClusterLevel& level = labels_.levels[k];
    std::vector<Json> children(level.volume.size(), Json::array());
    for (std::size_t i = 0; i < below.size(); ++i) children[level.of[i]].push_back(below[i]);
    std::vector<std::size_t> nodes;
    for (std::size_t c = 0; c < level.volume.size(); ++c)
      nodes.push_back(glb_.node({{"name", cluster_name(k + 1, c)},
                                 {"translation", json_row(centroids_[k][c] - origin_above(k + 1, c))},
                                 {"children", std::move(children[c])},
                                 {"extras", {{"volume", level.volume[c]}}}}));
    return nodes;
  }

  // For each bond a node below either piece, at the bond's centroid.
  void add_joints() {
    for (const Bond& bond : bonds_) {
      std::array<std::size_t, 2> ends{};
      for (std::size_t side = 0; side < 2; ++side) {
        const std::uint32_t piece = side == 0 ? bond.a : bond.b, other = side == 0 ? bond.b : bond.a;
        ends[side] = glb_.node({{"name", labels_.names[piece] + "_to_" + labels_.names[other]},
                                {"translation", json_row(bond.centroid - chunks_[piece].centroid)}});
        attachments_[piece].push_back(ends[side]);
      }
      physics_.add_joint(
          ends[0], ends[1],
          {{"breakForce", labels_.strength * bond.area}, {"breakTorque", labels_.strength * bond.section}});
    }
  }

  const std::vector<Chunk>& chunks_;
  const std::vector<Bond>& bonds_;
  const ChunkLabels& labels_;
  const GlbOptions& options_;
  GlbFile glb_;
  GlbExtensions physics_;
  std::map<std::string, std::size_t> materials_;
  std::size_t next_material_ = 0;
  Vec3 offset_;                                        // that the root adds to all coordinates
  std::vector<std::vector<Vec3>> centroids_;           // of clusters, by level
  std::vector<std::vector<std::size_t>> attachments_;  // nodes of joints, by piece
};

}  // namespace

void write_glb(std::ostream& out, const std::vector<Chunk>& chunks, const std::vector<Bond>& bonds,
               const ChunkLabels& labels, const GlbOptions& options) {
  const double unit = chunks.empty() ? 0 : chunks[0].mesh.unit;
  if (unit == 0 || unit == 1) return GlbScene(chunks, bonds, labels, options).write(out);
  const PieceSet set = in_metres(chunks, bonds, labels);
  GlbScene(set.chunks, set.bonds, set.labels, options).write(out);
}

}  // namespace geo
