// write_ply() of kerf/files.h. Writes a surface as binary little-endian PLY, with all that
// reading it back bit by bit needs.
#include <cfloat>
#include <cmath>
#include <span>

#include "base/number_text.h"
#include "io/surface_formats.h"

namespace geo {
namespace {

// A number in the shortest form that is read back exactly.
std::string shortest(double x) {
  char digits[32];
  return {digits, write_number(digits, x)};
}

template <class T>
void put(std::string& row, T value) {
  row.append(reinterpret_cast<const char*>(&value), sizeof value);
}

// An attribute with a fixed number of values in a row, in the smallest type that holds all of them
// exactly.
struct Block {
  std::span<const double> values;
  std::size_t each = 0;
  char type = 'd';
  const char* type_name() const { return type == 'C' ? "uchar" : type == 'f' ? "float" : "double"; }
  void put_row(std::string& row, std::size_t i) const {
    for (const double x : values.subspan(i * each, each))
      if (type == 'C')
        put(row, static_cast<std::uint8_t>(std::lround(x * 255)));
      else if (type == 'f')
        put(row, static_cast<float>(x));
      else
        put(row, x);
  }
};

template <class Row>
Block block_of(const std::vector<Row>& rows, bool color = false) {
  static_assert(sizeof(Row) % sizeof(double) == 0);
  Block block;
  block.each = sizeof(Row) / sizeof(double);
  block.values = {reinterpret_cast<const double*>(rows.data()), rows.size() * block.each};
  bool bytes = color, floats = true;
  for (const double x : block.values) {
    bytes = bytes && x >= 0 && x <= 1 && static_cast<double>(std::lround(x * 255)) / 255 == x;
    floats = floats && std::abs(x) <= FLT_MAX && static_cast<double>(static_cast<float>(x)) == x;
  }
  block.type = bytes ? 'C' : floats ? 'f' : 'd';
  return block;
}

// Corner values that the reader derives from the vertices alone. A list is written where they
// differ.
template <class V, class OnCrack>
bool told_by_vertices(const TriangleMesh& mesh, const std::vector<std::array<V, 3>>& at_corner,
                      const AtVertices<V>& at_vertex, const OnCrack& on_crack) {
  if (!at_vertex.agree) return false;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (mesh.patch.empty() || mesh.patch[t] == 0) continue;
    const V expected = on_crack(t);
    for (const V& value : at_corner[t])
      if (value != expected) return false;
  }
  return true;
}

// The comments of the header: all that is text.
void write_comments(std::ostream& out, const TriangleMesh& mesh, const std::vector<FrontState>& fronts,
                    const std::string& comment) {
  const Attributes& a = mesh.attributes;
  if (!comment.empty()) out << "comment " << comment << '\n';
  for (const auto& f : fronts) out << "comment kerf_front " << f.name << '\n';
  for (const auto& name : a.group_names) out << "comment kerf_group " << name << '\n';
  if (!a.materials.empty()) out << "comment kerf_materials " << a.materials << '\n';
  if (mesh.unit > 0) out << "comment kerf_unit " << shortest(mesh.unit) << '\n';
}

// The rows of fronts and of their contacts.
void put_fronts(std::string& row, const std::vector<FrontState>& fronts) {
  for (const auto& f : fronts) {
    put(row, f.crack);
    put(row, f.step);
    put<std::uint8_t>(row, f.closed);
  }
  for (std::uint32_t i = 0; i < fronts.size(); ++i)
    for (std::uint32_t s = 0; s < fronts[i].segments.size(); ++s)
      for (const auto& p : fronts[i].segments[s]) {
        put(row, i);
        put(row, s);
        put<std::int32_t>(row, p.id.valid() ? static_cast<std::int32_t>(p.id.value) : -1);
        for (int c = 0; c < 3; ++c) put(row, p.position[c]);
      }
}

}  // namespace

void write_ply(std::ostream& out, const TriangleMesh& mesh, const std::vector<FrontState>& fronts,
               const std::string& comment) {
  const Attributes& a = mesh.attributes;
  AtVertices<Vec3> normal;
  AtVertices<Color> color;
  std::vector<std::pair<const char*, Block>> lists;
  std::vector<std::pair<std::vector<const char*>, Block>> vertex_blocks;
  if (!a.normal.empty()) {
    normal = at_vertices(mesh, a.normal);
    if (normal.agree) vertex_blocks.push_back({{"nx", "ny", "nz"}, block_of(normal.value)});
    const auto on_crack = [&](std::size_t t) {
      const auto& [i, j, k] = mesh.triangles[t];
      return face_normal(mesh.vertices[i], mesh.vertices[j], mesh.vertices[k]);
    };
    if (!told_by_vertices(mesh, a.normal, normal, on_crack)) lists.push_back({"normal", block_of(a.normal)});
  }
  if (!a.color.empty()) {
    color = at_vertices(mesh, a.color);
    if (color.agree) vertex_blocks.push_back({{"red", "green", "blue", "alpha"}, block_of(color.value, true)});
    if (!told_by_vertices(mesh, a.color, color, [](std::size_t) { return crack_color; }))
      lists.push_back({"color", block_of(a.color, true)});
  }
  if (!a.uv.empty()) lists.push_back({"texcoord", block_of(a.uv)});
  if (!a.uv2.empty()) lists.push_back({"texcoord2", block_of(a.uv2)});

  std::size_t contacts = 0;
  for (const auto& f : fronts)
    for (const auto& s : f.segments) contacts += s.size();
  out << "ply\nformat binary_little_endian 1.0\n";
  write_comments(out, mesh, fronts, comment);
  out << "element vertex " << mesh.vertices.size() << "\nproperty double x\nproperty double y\nproperty double z\n";
  if (mesh.two_sided()) out << "property uint site\n";
  for (const auto& [names, block] : vertex_blocks)
    for (const char* name : names) out << "property " << block.type_name() << ' ' << name << '\n';
  out << "element face " << mesh.triangles.size() << "\nproperty list uchar uint vertex_indices\n";
  if (!mesh.patch.empty()) out << "property int patch\n";
  if (!mesh.source.empty()) out << "property uint source\n";
  if (!a.group.empty()) out << "property int group\n";
  for (const auto& [name, block] : lists) out << "property list uchar " << block.type_name() << ' ' << name << '\n';
  if (!fronts.empty())
    out << "element kerf_front " << fronts.size()
        << "\nproperty int crack\nproperty uint step\nproperty uchar closed\nelement kerf_contact " << contacts
        << "\nproperty uint front\nproperty uint segment\nproperty int site\nproperty double x\nproperty double "
           "y\nproperty double z\n";
  const std::string* library = a.group.empty() ? nullptr : a.library.glb.get();
  if (library) out << "element kerf_library 1\nproperty list uint uchar glb\n";
  out << "end_header\n";
  std::string row;
  const auto flush = [&](bool last) {
    if (row.size() < (1 << 16) && !last) return;
    out.write(row.data(), static_cast<std::streamsize>(row.size()));
    row.clear();
  };
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    for (int c = 0; c < 3; ++c) put(row, mesh.vertices[v][c]);
    if (mesh.two_sided()) put(row, mesh.site[v]);
    for (const auto& [names, block] : vertex_blocks) block.put_row(row, v);
    flush(false);
  }
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    put<std::uint8_t>(row, 3);
    for (const auto v : mesh.triangles[t]) put(row, v);
    if (!mesh.patch.empty()) put(row, mesh.patch[t]);
    if (!mesh.source.empty()) put(row, mesh.source[t]);
    if (!a.group.empty()) put(row, a.group[t]);
    for (const auto& [name, block] : lists) {
      put(row, static_cast<std::uint8_t>(block.each));
      block.put_row(row, t);
    }
    flush(false);
  }
  put_fronts(row, fronts);
  if (library) {
    put(row, static_cast<std::uint32_t>(library->size()));
    row += *library;
  }
  flush(true);
}

}  // namespace geo
