// write_glb() and write_bonds() of kerf/export.h. Binary glTF 2.0: a header, a JSON chunk and a
// binary chunk. Corners with equal attributes share a vertex; colours are converted from sRGB to
// linear.
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

#include "kerf/error.h"
#include "kerf/export.h"
#include "kerf/pieces.h"

namespace geo {
namespace {

using Json = nlohmann::ordered_json;

Json row(const Vec3& v) { return Json::array({v.x(), v.y(), v.z()}); }

Json bonds_json(const std::vector<Chunk>& chunks, const std::vector<Bond>& bonds, const ChunkLabels& labels) {
  Json pieces = Json::array(), held = Json::array();
  for (std::size_t p = 0; p < chunks.size(); ++p)
    pieces.push_back({{labels.kind, labels.names[p]},
                      {"volume", chunks[p].volume},
                      {"centroid", row(chunks[p].centroid)},
                      {"triangles", chunks[p].mesh.triangles.size()}});
  for (const Bond& b : bonds)
    held.push_back({{"a", b.a},
                    {"b", b.b},
                    {"area", b.area},
                    {"normal", row(b.normal)},
                    {"centroid", row(b.centroid)},
                    {"strength", labels.strength * b.area}});
  return {{"pieces", pieces}, {"bonds", held}};
}

// Unit normals at the corners: the mean, weighted by area, of the triangles around the vertex that
// are of the same kind and differ by less than 45°.
std::vector<std::array<Vec3, 3>> smooth_normals(const TriangleMesh& mesh) {
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
      Vec3 sum = Vec3::Zero();
      for (const auto other : at[mesh.triangles[t][k]])
        if ((mesh.patch[other] == 0) == (mesh.patch[t] == 0) &&
            normal[t].stableNormalized().dot(normal[other].stableNormalized()) > std::sqrt(0.5))
          sum += normal[other];
      result[t][k] = sum.norm() > 0 ? sum.stableNormalized() : Vec3(Vec3::UnitZ());
    }
  return result;
}

double linear(double c) {  // IEC 61966-2-1
  c = std::clamp(c, 0.0, 1.0);
  return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
}

// The buffer of a .glb and the JSON that describes it. Numbers of the glTF 2.0 specification:
// targets 34962 (vertices) and 34963 (indices); types 5123 (16 bits), 5125 (32 bits), 5126
// (floats).
class Glb {
 public:
  Json json;

  template <class T>
  std::size_t view(const std::vector<T>& values, int target) {
    const std::size_t offset = bytes_.size();
    bytes_.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));
    bytes_.resize((bytes_.size() + 3) / 4 * 4);
    json["bufferViews"].push_back(
        {{"buffer", 0}, {"byteOffset", offset}, {"byteLength", values.size() * sizeof(T)}, {"target", target}});
    return json["bufferViews"].size() - 1;
  }
  template <class T>
  std::size_t accessor(const std::vector<T>& values, int component, const char* type, std::size_t count) {
    json["accessors"].push_back(
        {{"bufferView", view(values, 34962)}, {"componentType", component}, {"count", count}, {"type", type}});
    return json["accessors"].size() - 1;
  }
  std::size_t positions(const std::vector<float>& values) {
    const std::size_t at = accessor(values, 5126, "VEC3", values.size() / 3);
    std::array<float, 3> lo{values[0], values[1], values[2]}, hi = lo;
    for (std::size_t i = 0; i < values.size(); ++i)
      lo[i % 3] = std::min(lo[i % 3], values[i]), hi[i % 3] = std::max(hi[i % 3], values[i]);
    json["accessors"][at]["min"] = lo, json["accessors"][at]["max"] = hi;
    return at;
  }
  std::size_t indices(const std::vector<std::uint32_t>& values) {
    json["accessors"].push_back(
        {{"bufferView", view(values, 34963)}, {"componentType", 5125}, {"count", values.size()}, {"type", "SCALAR"}});
    return json["accessors"].size() - 1;
  }
  std::size_t node(Json description) {
    json["nodes"].push_back(std::move(description));
    return json["nodes"].size() - 1;
  }
  std::size_t mesh(Json primitives, const std::string& name) {
    json["meshes"].push_back({{"name", name}, {"primitives", std::move(primitives)}});
    return json["meshes"].size() - 1;
  }

  void write(std::ostream& out) {
    json["buffers"] = Json::array({Json{{"byteLength", bytes_.size()}}});
    std::string text = json.dump(-1, ' ', false, Json::error_handler_t::replace);
    text.resize((text.size() + 3) / 4 * 4, ' ');
    const std::uint64_t total = 12 + 8 + text.size() + 8 + bytes_.size();
    if (total > 0xffffffffu) throw OutputError("pieces of more than 4 GB do not fit into a .glb; write a folder");
    const auto put = [&](std::uint64_t x) {
      const auto word = static_cast<std::uint32_t>(x);
      out.write(reinterpret_cast<const char*>(&word), 4);
    };
    // Magic words in ASCII: "glTF", "JSON" and "BIN".
    put(0x46546c67), put(2), put(total);
    put(text.size()), put(0x4e4f534a);
    out << text;
    put(bytes_.size()), put(0x004e4942);
    out << bytes_;
  }

 private:
  std::string bytes_;
};

// The triangles of one group. Corners with equal values are merged.
Json primitive(Glb& glb, const Chunk& chunk, const std::vector<std::array<Vec3, 3>>& normals, std::int32_t group,
               std::size_t material) {
  const TriangleMesh& mesh = chunk.mesh;
  const Attributes& a = mesh.attributes;
  struct Corner {
    std::array<float, 8> at;  // position, normal, uv
    std::array<std::uint16_t, 4> color;
    auto operator<=>(const Corner&) const = default;
  };
  std::map<Corner, std::uint32_t> rows;
  std::vector<float> position, normal, uv;
  std::vector<std::uint16_t> color;
  std::vector<std::uint32_t> index;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (a.group[t] != group) continue;
    for (std::size_t k = 0; k < 3; ++k) {
      Corner corner{};
      const Vec3 p = mesh.vertices[mesh.triangles[t][k]] - chunk.centroid;
      for (int i = 0; i < 3; ++i)
        corner.at[std::size_t(i)] = float(p[i]), corner.at[std::size_t(3 + i)] = float(normals[t][k][i]);
      corner.at[6] = float(a.uv[t][k].x()), corner.at[7] = float(1 - a.uv[t][k].y());  // in glTF v points downwards
      if (!a.color.empty())
        for (int i = 0; i < 4; ++i)
          corner.color[std::size_t(i)] = static_cast<std::uint16_t>(
              std::lround(65535 * (i < 3 ? linear(a.color[t][k][i]) : std::clamp(a.color[t][k][i], 0.0, 1.0))));
      const auto [entry, fresh] = rows.try_emplace(corner, static_cast<std::uint32_t>(rows.size()));
      index.push_back(entry->second);
      if (!fresh) continue;
      position.insert(position.end(), corner.at.begin(), corner.at.begin() + 3);
      normal.insert(normal.end(), corner.at.begin() + 3, corner.at.begin() + 6);
      uv.insert(uv.end(), corner.at.begin() + 6, corner.at.end());
      color.insert(color.end(), corner.color.begin(), corner.color.end());
    }
  }
  Json attributes = {{"POSITION", glb.positions(position)},
                     {"NORMAL", glb.accessor(normal, 5126, "VEC3", rows.size())},
                     {"TEXCOORD_0", glb.accessor(uv, 5126, "VEC2", rows.size())}};
  if (!a.color.empty()) {
    attributes["COLOR_0"] = glb.accessor(color, 5123, "VEC4", rows.size());
    glb.json["accessors"].back()["normalized"] = true;
  }
  return {{"attributes", attributes}, {"indices", glb.indices(index)}, {"material", material}};
}

Json hull_primitive(Glb& glb, const TriangleMesh& hull, const Vec3& origin) {
  std::vector<float> position;
  std::vector<std::uint32_t> index;
  for (const Vec3& p : hull.vertices)
    for (int i = 0; i < 3; ++i) position.push_back(float(p[i] - origin[i]));
  for (const auto& t : hull.triangles) index.insert(index.end(), t.begin(), t.end());
  const auto at = glb.positions(position);
  return {{"attributes", {{"POSITION", at}}}, {"indices", glb.indices(index)}};
}

// The chunk with every array that a primitive reads. Throws InputError where it has no triangle.
Chunk completed(Chunk chunk) {
  TriangleMesh& mesh = chunk.mesh;
  const std::size_t count = mesh.triangles.size();
  if (count == 0) throw InputError("a piece without triangles does not fit into a .glb");
  mesh.patch.resize(count, 0);
  mesh.attributes.uv.resize(count, {Vec2::Zero(), Vec2::Zero(), Vec2::Zero()});
  if (mesh.attributes.group.empty()) {
    mesh.attributes.group.assign(count, 0);
    mesh.attributes.group_names = {"skin"};
  }
  return chunk;
}

}  // namespace

void write_bonds(std::ostream& out, const std::vector<Chunk>& chunks, const std::vector<Bond>& bonds,
                 const ChunkLabels& labels) {
  out << bonds_json(chunks, bonds, labels).dump(-1, ' ', false, Json::error_handler_t::replace) << '\n';
}

std::string hull_suffix(std::size_t part, std::size_t parts) {
  if (parts < 2) return {};
  return (part < 10 ? "_0" : "_") + std::to_string(part);
}

void write_glb(std::ostream& out, const std::vector<Chunk>& chunks, const std::vector<Bond>& bonds,
               const ChunkLabels& labels, const GlbOptions& options) {
  Glb glb;
  glb.json = {{"asset", {{"version", "2.0"}, {"generator", "kerf-pieces"}}},
              {"scene", 0},
              {"scenes", Json::array()},
              {"nodes", Json::array()},
              {"meshes", Json::array()},
              {"materials", Json::array()},
              {"accessors", Json::array()},
              {"bufferViews", Json::array()}};
  std::map<std::string, std::size_t> materials;
  const auto material = [&](const std::string& name) {
    const auto [entry, fresh] = materials.try_emplace(name, materials.size());
    const Json color = name == crack_group ? Json::array({0.42, 0.36, 0.31, 1.0}) : Json::array({0.8, 0.8, 0.8, 1.0});
    if (fresh)
      glb.json["materials"].push_back(
          {{"name", name},
           {"pbrMetallicRoughness", {{"baseColorFactor", color}, {"metallicFactor", 0.0}, {"roughnessFactor", 0.9}}}});
    return entry->second;
  };
  Json children = Json::array();
  for (std::size_t p = 0; p < chunks.size(); ++p) {
    const Chunk chunk = completed(chunks[p]);
    const Attributes& a = chunk.mesh.attributes;
    auto normals = smooth_normals(chunk.mesh);
    for (std::size_t t = 0; t < normals.size() && !a.normal.empty(); ++t)
      if (chunk.mesh.patch[t] == 0) normals[t] = a.normal[t];
    Json primitives = Json::array();
    for (std::int32_t g = 0; g < std::int32_t(a.group_names.size()); ++g)
      if (std::find(a.group.begin(), a.group.end(), g) != a.group.end())
        primitives.push_back(primitive(glb, chunk, normals, g, material(a.group_names[std::size_t(g)])));
    Json node = {{"name", labels.names[p]},
                 {"translation", row(chunk.centroid)},
                 {"mesh", glb.mesh(primitives, labels.names[p])},
                 {"extras", {{"volume", chunk.volume}}}};
    if (options.hull_corners > 0) {
      const auto hulls = convex_decomposition(chunk.mesh, options.hull_parts, options.hull_corners);
      for (std::size_t h = 0; h < hulls.size(); ++h) {
        const std::string name = "UCX_" + labels.names[p] + hull_suffix(h, hulls.size());
        const Json shape = Json::array({hull_primitive(glb, hulls[h], chunk.centroid)});
        node["children"].push_back(glb.node({{"name", name}, {"mesh", glb.mesh(shape, name)}}));
      }
    }
    children.push_back(glb.node(std::move(node)));
  }
  Json root = {{"name", "pieces"}, {"children", children}};
  // Quaternion (x, y, z, w) of −90° about x, which turns z upwards to y.
  const double half = std::sqrt(0.5);
  if (options.z_up) root["rotation"] = Json::array({-half, 0.0, 0.0, half});
  const std::size_t top = glb.node(std::move(root));
  glb.json["scenes"].push_back({{"nodes", Json::array({top})}, {"extras", bonds_json(chunks, bonds, labels)}});
  glb.write(out);
}

}  // namespace geo
