// parse_obj() of io/surface_formats.h, write_obj() of kerf/files.h. Wavefront OBJ: texture
// coordinates, normals, colours of vertices, materials or groups.
#include <bit>
#include <map>

#include "io/line_reader.h"
#include "io/surface_formats.h"

namespace geo {
namespace {

// Names in the order in which faces first use them.
class Names {
 public:
  std::vector<std::string> all;
  std::int32_t row(const std::string& name) {
    const auto [it, fresh] = rows_.try_emplace(name.empty() ? "default" : name, static_cast<std::int32_t>(all.size()));
    if (fresh) all.push_back(it->first);
    return it->second;
  }

 private:
  std::map<std::string, std::int32_t> rows_;
};

std::string rest_of(const std::vector<std::string_view>& words) {
  std::string text;
  for (std::size_t i = 1; i < words.size(); ++i) text += (i > 1 ? " " : "") + std::string(words[i]);
  return text;
}

// Index from 0 of a face's index: that counts from 1, or backwards from the last entry so far.
std::uint32_t row_at(const LineReader& lines, std::string_view word, std::size_t count, const char* what) {
  const auto i = lines.integer(word);
  const auto size = static_cast<long long>(count);
  if (i > size || i < -size || i == 0)
    lines.fail("a face names " + std::string(what) + " " + std::to_string(i) + ", but there are " +
               std::to_string(count) + " so far");
  return static_cast<std::uint32_t>(i > 0 ? i - 1 : size + i);
}

// Indices of texture coordinate and normal at each corner of a triangle; ~0u: none.
struct CornerRows {
  std::array<std::uint32_t, 3> uv, normal;
};

}  // namespace

TriangleMesh parse_obj(const std::string& bytes, const std::string& name) {
  LineReader lines(bytes, name);
  std::vector<std::string_view> words;
  TriangleMesh mesh;
  std::vector<Vec2> uv;
  std::vector<Vec3> normal;
  std::vector<Color> color;
  bool colored = false, any_uv = false, any_normal = false, any_material = false, any_part = false;
  Names materials, parts;
  std::string material, part;
  std::vector<std::int32_t> material_of, part_of;
  std::vector<CornerRows> rows;
  std::vector<std::uint32_t> polygon, polygon_uv, polygon_normal;
  while (lines.next(words)) {
    if (words[0] == "v") {
      if (words.size() < 4) lines.fail("a vertex needs three coordinates");
      mesh.vertices.push_back({lines.real(words[1]), lines.real(words[2]), lines.real(words[3])});
      color.push_back(Color::Ones());
      if (words.size() != 7) continue;
      colored = true;
      for (int k = 0; k < 3; ++k) color.back()[k] = lines.real(words[4 + static_cast<std::size_t>(k)]);
    } else if (words[0] == "vt") {
      if (words.size() < 2) lines.fail("a texture coordinate needs a number");
      uv.push_back({lines.real(words[1]), words.size() > 2 ? lines.real(words[2]) : 0.0});
    } else if (words[0] == "vn") {
      if (words.size() < 4) lines.fail("a normal needs three numbers");
      normal.push_back({lines.real(words[1]), lines.real(words[2]), lines.real(words[3])});
    } else if (words[0] == "usemtl") {
      material = rest_of(words), any_material = true;
    } else if (words[0] == "g" || words[0] == "o") {
      part = rest_of(words), any_part = true;
    } else if (words[0] == "mtllib") {
      mesh.attributes.materials = rest_of(words);
    } else if (words[0] == "f") {
      polygon.clear(), polygon_uv.clear(), polygon_normal.clear();
      for (std::size_t k = 1; k < words.size(); ++k) {
        const auto first = std::min(words[k].find('/'), words[k].size()),
                   second = std::min(words[k].find('/', first + 1), words[k].size());
        const auto vt = first == words[k].size() ? std::string_view() : words[k].substr(first + 1, second - first - 1);
        const auto vn = second == words[k].size() ? std::string_view() : words[k].substr(second + 1);
        polygon.push_back(row_at(lines, words[k].substr(0, first), mesh.vertices.size(), "vertex"));
        polygon_uv.push_back(vt.empty() ? ~0u : row_at(lines, vt, uv.size(), "texture coordinate"));
        polygon_normal.push_back(vn.empty() ? ~0u : row_at(lines, vn, normal.size(), "normal"));
        any_uv = any_uv || !vt.empty(), any_normal = any_normal || !vn.empty();
      }
      if (polygon.size() < 3) lines.fail("a face has fewer than three vertices");
      for (const auto& [p, q, r] : add_polygon(mesh, polygon, name + ": ")) {
        rows.push_back(
            {{polygon_uv[p], polygon_uv[q], polygon_uv[r]}, {polygon_normal[p], polygon_normal[q], polygon_normal[r]}});
        material_of.push_back(materials.row(material));
        part_of.push_back(parts.row(part));
      }
    }
  }
  Attributes& a = mesh.attributes;
  if (any_uv) a.uv.resize(rows.size());
  if (any_normal) a.normal.resize(rows.size());
  for (std::size_t t = 0; t < rows.size(); ++t)
    for (int k = 0; k < 3; ++k) {
      const auto vt = rows[t].uv[k], vn = rows[t].normal[k];
      const auto& [p, q, r] = mesh.triangles[t];
      if (any_uv) a.uv[t][k] = vt == ~0u ? Vec2(Vec2::Zero()) : uv[vt];
      if (any_normal)
        a.normal[t][k] = vn == ~0u ? face_normal(mesh.vertices[p], mesh.vertices[q], mesh.vertices[r]) : normal[vn];
    }
  if (colored) a.color = at_corners(mesh, color);
  if (any_material)
    a.group = std::move(material_of), a.group_names = std::move(materials.all);
  else if (any_part)
    a.group = std::move(part_of), a.group_names = std::move(parts.all);
  return mesh;
}

namespace {

// Writes each different value once and numbers it. Values are compared bit by bit.
template <class V>
class Once {
 public:
  Once(std::ostream& out, const char* word) : out_(out), word_(word) {}
  void add(const V& value) {
    if (!numbers_.try_emplace(bits(value), numbers_.size() + 1).second) return;
    out_ << word_;
    for (int i = 0; i < value.size(); ++i) out_ << ' ' << value[i];
    out_ << '\n';
  }
  std::size_t number(const V& value) const { return numbers_.at(bits(value)); }

 private:
  using Bits = std::array<std::uint64_t, V::SizeAtCompileTime>;
  static Bits bits(const V& value) {
    Bits result;
    for (int i = 0; i < value.size(); ++i) result[static_cast<std::size_t>(i)] = std::bit_cast<std::uint64_t>(value[i]);
    return result;
  }
  std::ostream& out_;
  const char* word_;
  std::map<Bits, std::size_t> numbers_;
};

}  // namespace

void write_obj(std::ostream& out, const TriangleMesh& mesh) {
  const Attributes& a = mesh.attributes;
  out.precision(17);
  if (!a.group.empty() && !a.materials.empty()) out << "mtllib " << a.materials << '\n';
  AtVertices<Color> color;
  if (!a.color.empty()) color = at_vertices(mesh, a.color);
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    out << "v " << mesh.vertices[v].x() << ' ' << mesh.vertices[v].y() << ' ' << mesh.vertices[v].z();
    if (!a.color.empty()) out << ' ' << color.value[v][0] << ' ' << color.value[v][1] << ' ' << color.value[v][2];
    out << '\n';
  }
  Once<Vec2> uv(out, "vt");
  for (const auto& row : a.uv)
    for (const Vec2& value : row) uv.add(value);
  Once<Vec3> normal(out, "vn");
  for (const auto& row : a.normal)
    for (const Vec3& value : row) normal.add(value);
  std::map<std::int32_t, std::vector<std::size_t>> patches;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) patches[mesh.patch.empty() ? 0 : mesh.patch[t]].push_back(t);
  std::int32_t group = -1;
  for (const auto& [patch, triangles] : patches) {
    if (!mesh.patch.empty()) out << "g patch_" << patch << '\n';
    for (const auto t : triangles) {
      if (!a.group.empty() && a.group[t] != group)
        group = a.group[t], out << "usemtl " << a.group_names[static_cast<std::size_t>(group)] << '\n';
      out << 'f';
      for (int k = 0; k < 3; ++k) {
        out << ' ' << mesh.triangles[t][k] + 1;
        if (!a.uv.empty() || !a.normal.empty()) out << '/';
        if (!a.uv.empty()) out << uv.number(a.uv[t][k]);
        if (!a.normal.empty()) out << '/' << normal.number(a.normal[t][k]);
      }
      out << '\n';
    }
  }
}

}  // namespace geo
