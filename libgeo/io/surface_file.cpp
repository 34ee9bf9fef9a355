// read_surface() of kerf/files.h. Formats are recognised by their first bytes or lines;
// anything unknown is read as STL. Seams, i.e. vertices at one position, are welded unless the mesh
// is two-sided.
#include "kerf/files.h"

#include <algorithm>
#include <filesystem>

#include "io/line_reader.h"
#include "io/mtl.h"
#include "io/surface_formats.h"
#include "io/surface_other.h"
#include "kerf/body_file.h"
#include "surface/polygon.h"
#include "surface/weld.h"

namespace geo {
namespace {

// Whether some of the first lines begin with a keyword that OBJ alone has, and a number or name.
bool looks_like_obj(const std::string& bytes) {
  static constexpr std::string_view keywords[] = {"v", "vn", "vt", "f", "usemtl", "mtllib"};
  LineReader lines(bytes, "", '#', '\\');
  std::vector<std::string_view> words;
  for (int i = 0; i < 200 && lines.next(words); ++i)
    if (words.size() > 1 && std::find(std::begin(keywords), std::end(keywords), words[0]) != std::end(keywords))
      return true;
  return false;
}

// Materials of a .mtl that a PLY names, where it is there: a folder of pieces has one.
void add_named_materials(SurfaceFile& file, const std::string& name) {
  const std::string& materials = file.mesh.attributes.materials;
  std::error_code failed;
  if (materials.empty() || !std::filesystem::exists(std::filesystem::path(name).parent_path() / materials, failed))
    return;
  add_mtl_library(file.mesh, {materials}, name, file.notes);
}

// Whether a file holds a scan, and not nodes. The ending of its name tells text with points from an
// OFF file without a keyword; all other content decides by itself.
bool is_scan(const std::string& bytes, const std::string& name) {
  constexpr std::size_t header = 4096;
  const std::string head = bytes.substr(0, header);
  if (!holds_points(bytes, name) || head.find("radius") != std::string::npos) return false;
  const bool is_off = looks_like_off(bytes) && head.find("OFF") != std::string::npos;
  return !is_off && !is_exact_binary_stl(bytes) && !looks_like_obj(bytes) && !looks_like_kerf(bytes) &&
         other_format(bytes, name).what.empty();
}

// Texture coordinates that name no place in an image become 0: those that are not finite, and those
// so large that single precision, which glTF has, tells no two places of an image apart.
void replace_wild_places(SurfaceFile& file) {
  constexpr double largest = 0x1p24;
  std::size_t wild = 0;
  for (auto* places : {&file.mesh.attributes.uv, &file.mesh.attributes.uv2})
    for (auto& corners : *places)
      for (Vec2& uv : corners) {
        if ((uv.array().abs() <= largest).all()) continue;
        uv.setZero();
        ++wild;
      }
  if (wild > 0)
    file.notes.push_back("has " + counted(wild, "corner") +
                         " with texture coordinates that are not finite or above 2^24; they are put at 0, 0");
}

// UTF-16 that begins with its byte order mark, as UTF-8 without it; empty for other bytes. Units
// that are invalid become U+FFFD.
std::string from_utf16(const std::string& bytes) {
  const bool big = bytes.rfind("\xfe\xff", 0) == 0;
  if (!big && bytes.rfind("\xff\xfe", 0) != 0) return {};
  const auto unit = [&](std::size_t i) {
    const auto first = static_cast<unsigned char>(bytes[i]), second = static_cast<unsigned char>(bytes[i + 1]);
    return std::uint32_t(big ? first << 8 | second : second << 8 | first);
  };
  std::string text;
  for (std::size_t i = 2; i + 1 < bytes.size(); i += 2) {
    std::uint32_t c = unit(i);
    if (c >= 0xd800 && c < 0xe000) {
      const std::uint32_t low = c < 0xdc00 && i + 3 < bytes.size() ? unit(i + 2) : 0;
      const bool pair = low >= 0xdc00 && low < 0xe000;
      c = pair ? 0x10000 + ((c - 0xd800) << 10 | (low - 0xdc00)) : 0xfffd;
      i += pair ? 2 : 0;
    }
    const auto tail = [&](int shift) { text += static_cast<char>(0x80 | (c >> shift & 0x3f)); };
    if (c < 0x80)
      text += static_cast<char>(c);
    else if (c < 0x800) {
      text += static_cast<char>(0xc0 | c >> 6);
      tail(0);
    } else if (c < 0x10000) {
      text += static_cast<char>(0xe0 | c >> 12);
      tail(6);
      tail(0);
    } else {
      text += static_cast<char>(0xf0 | c >> 18);
      tail(12);
      tail(6);
      tail(0);
    }
  }
  return text;
}

}  // namespace

std::vector<std::array<std::uint32_t, 3>> add_polygon(TriangleMesh& mesh, const std::vector<std::uint32_t>& polygon,
                                                      const std::string& where) {
  if (polygon.size() < 3) throw InputError(where + "a face has fewer than three vertices");
  for (const auto v : polygon)
    if (v >= mesh.vertices.size())
      throw InputError(where + "a face names vertex " + std::to_string(v) + ", but there are " +
                       std::to_string(mesh.vertices.size()));
  auto triangles = triangles_of(mesh.vertices, polygon);
  for (const auto& [a, b, c] : triangles) mesh.triangles.push_back({polygon[a], polygon[b], polygon[c]});
  return triangles;
}

void add_left_out(std::vector<std::string>& notes, const std::vector<std::string>& things) {
  if (things.empty()) return;
  std::string note = "left out: ";
  for (std::size_t i = 0; i < things.size(); ++i) note += (i > 0 ? ", " : "") + things[i];
  notes.push_back(note);
}

SurfaceFile read_surface(const std::string& path) { return parse_surface(read_all(path), path); }

SurfaceFile parse_surface(const std::string& bytes, const std::string& name) {
  // Text that begins with the byte order mark of UTF-8 is read without it.
  if (bytes.rfind("\xef\xbb\xbf", 0) == 0) return parse_surface(bytes.substr(3), name);
  if (const std::string text = from_utf16(bytes);
      looks_like_obj(text) || looks_like_off(text) || text.rfind("ply", 0) == 0)
    return parse_surface(text, name);
  SurfaceFile file;
  if (is_scan(bytes, name))
    throw InputError(name + ": has points without faces; make a solid of it: kerf-repair " + name +
                     " -o solid.ply, in Python kerf.reconstruct(*kerf.read_points(path))");
  if (is_exact_binary_stl(bytes))  // whatever its header begins with
    file.mesh = parse_stl(bytes, name, file.notes);
  else if (bytes.rfind("ply", 0) == 0) {
    file = parse_surface_ply(bytes, name);
    add_named_materials(file, name);
  } else if (looks_like_kerf(bytes))
    throw InputError(name + ": is a body (.kerf); give the surface that it was made of, or that it was cut by");
  else if (const OtherFormat other = other_format(bytes, name); !other.what.empty())
    file = parse_other(bytes, name, other);
  else if (looks_like_off(bytes))
    file.mesh = parse_off(bytes, name, file.notes);
  else if (looks_like_obj(bytes))
    file.mesh = parse_obj(bytes, name, file.notes);
  else
    file.mesh = parse_stl(bytes, name, file.notes);
  for (std::size_t v = 0; v < file.mesh.vertices.size(); ++v)
    if (!in_range(file.mesh.vertices[v]))
      throw InputError(name + ": vertex " + std::to_string(v) +
                       " has a coordinate that is not a finite number of sensible size; repair the file");
  replace_wild_places(file);
  if (!file.mesh.two_sided()) weld_seams(file.mesh);
  if (file.mesh.triangles.empty()) throw InputError(name + ": has no triangles; give a closed triangle mesh");
  return file;
}

}  // namespace geo
