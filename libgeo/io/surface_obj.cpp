// parse_obj() of io/surface_formats.h, write_obj() of kerf/files.h. Wavefront OBJ: texture
// coordinates, normals, colours of vertices, materials or groups.
#include <limits>
#include <map>

#include "base/bit_cast.h"
#include "io/line_reader.h"
#include "io/mtl.h"
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

class ObjReader {
 public:
  ObjReader(const std::string& bytes, const std::string& name, std::vector<std::string>& notes)
      : lines_(bytes, name, '#', '\\'), name_(name), notes_(notes) {}

  TriangleMesh read() {
    while (lines_.next(words_)) read_line();
    for (const Face& face : faces_) add_triangles(face);
    add_attributes();
    add_notes();
    if (any_material_) add_mtl_library(mesh_, material_files_, name_, notes_);
    return std::move(mesh_);
  }

 private:
  // Rows of a corner's vertex, texture coordinate and normal; ~0u: none.
  struct Corner {
    std::uint32_t vertex, uv, normal;
  };
  // A face has the corners from the end of the face before it up to `end`.
  struct Face {
    std::size_t end, line;
    std::int32_t material, part;
  };

  void read_line() {
    if (words_[0] == "v") {
      read_vertex();
    } else if (words_[0] == "vt") {
      if (words_.size() < 2) lines_.fail("a texture coordinate needs a number");
      uv_.push_back({lines_.any_real(words_[1]), words_.size() > 2 ? lines_.any_real(words_[2]) : 0.0});
    } else if (words_[0] == "vn") {
      if (words_.size() < 4) lines_.fail("a normal needs three numbers");
      normal_.push_back({lines_.any_real(words_[1]), lines_.any_real(words_[2]), lines_.any_real(words_[3])});
    } else if (words_[0] == "usemtl") {
      material_ = rest_of(words_);
      any_material_ = true;
    } else if (words_[0] == "g" || words_[0] == "o") {
      part_ = rest_of(words_);
      any_part_ = true;
    } else if (words_[0] == "mtllib") {
      material_files_.push_back(rest_of(words_));
      mesh_.attributes.materials = material_files_.back();
    } else if (words_[0] == "f" || words_[0] == "fo") {  // fo: of old versions
      read_face();
    } else if (words_[0] == "l") {
      ++polylines_;
    } else if (words_[0] == "p") {
      ++points_;
    } else if (words_[0] == "curv" || words_[0] == "curv2" || words_[0] == "surf") {
      ++curved_;
    }
  }

  void add_notes() {
    std::vector<std::string> things;
    if (points_ > 0) things.push_back(counted(points_, "line") + " of points");
    if (polylines_ > 0) things.push_back(counted(polylines_, "polyline"));
    if (curved_ > 0) things.push_back(counted(curved_, "curve or curved surface", "curves and curved surfaces"));
    add_left_out(notes_, things);
    // The specification gives the fourth coordinate a meaning for curves alone.
    if (weighted_) notes_.push_back("the fourth coordinates of its vertices are weights of curves and have no effect");
  }

  // Stands for a colour that is missing or not finite, and becomes white.
  static Color no_color() { return Color::Constant(std::numeric_limits<double>::quiet_NaN()); }

  void read_vertex() {
    if (words_.size() < 4) lines_.fail("a vertex needs three coordinates");
    mesh_.vertices.push_back({lines_.real(words_[1]), lines_.real(words_[2]), lines_.real(words_[3])});
    color_.push_back(no_color());
    weighted_ = weighted_ || (words_.size() == 5 && lines_.any_real(words_[4]) != 1);
    if (words_.size() != 7) return;
    colored_ = true;
    for (int k = 0; k < 3; ++k) color_.back()[k] = lines_.any_real(words_[4 + static_cast<std::size_t>(k)]);
    color_.back()[3] = 1;
    if (!color_.back().allFinite()) color_.back() = no_color();
    if (!color_.back().allFinite()) return;
    brightest_ = std::max(brightest_, color_.back().head<3>().maxCoeff());
    whole_colors_ = whole_colors_ && color_.back() == Color(color_.back().array().floor());
  }

  // Row from 0 of an index that counts from 1, or backwards from the last row so far.
  std::uint32_t row_at(std::string_view word, std::size_t count, const char* what) const {
    const auto i = lines_.integer(word);
    const auto size = static_cast<long long>(count);
    if (i < -size || i == 0 || i > 0xffffffffll)
      lines_.fail("a face names " + std::string(what) + " " + std::to_string(i) + ", but there are " +
                  std::to_string(count) + " so far");
    return static_cast<std::uint32_t>(i > 0 ? i - 1 : size + i);
  }

  void read_face() {
    if (words_.size() < 4) lines_.fail("a face has fewer than three vertices");
    for (std::size_t k = 1; k < words_.size(); ++k) {
      const std::string_view word = words_[k];
      const auto first = std::min(word.find('/'), word.size()),
                 second = std::min(word.find('/', first + 1), word.size());
      const auto vt = first == word.size() ? std::string_view() : word.substr(first + 1, second - first - 1);
      const auto vn = second == word.size() ? std::string_view() : word.substr(second + 1);
      corners_.push_back({row_at(word.substr(0, first), mesh_.vertices.size(), "vertex"),
                          vt.empty() ? ~0u : row_at(vt, uv_.size(), "texture coordinate"),
                          vn.empty() ? ~0u : row_at(vn, normal_.size(), "normal")});
      any_uv_ = any_uv_ || !vt.empty();
      any_normal_ = any_normal_ || !vn.empty();
    }
    faces_.push_back({.end = corners_.size(),
                      .line = lines_.number(),
                      .material = materials_.row(material_),
                      .part = parts_.row(part_)});
  }

  void require(const Face& face, std::uint32_t row, std::size_t count, const char* what) const {
    if (row != ~0u && row >= count)
      throw InputError(name_ + ":" + std::to_string(face.line) + ": a face names " + what + " " +
                       std::to_string(row + 1ull) + ", but there are " + std::to_string(count));
  }

  // Faces are divided when all rows are known, as they may name those of later lines.
  void add_triangles(const Face& face) {
    polygon_.clear();
    const std::size_t first = next_;
    for (; next_ < face.end; ++next_) {
      const Corner& corner = corners_[next_];
      require(face, corner.vertex, mesh_.vertices.size(), "vertex");
      require(face, corner.uv, uv_.size(), "texture coordinate");
      require(face, corner.normal, normal_.size(), "normal");
      polygon_.push_back(corner.vertex);
    }
    for (const auto& [p, q, r] : add_polygon(mesh_, polygon_, name_ + ":" + std::to_string(face.line) + ": ")) {
      rows_.push_back({first + p, first + q, first + r});
      material_of_.push_back(face.material);
      part_of_.push_back(face.part);
    }
  }

  void add_attributes() {
    Attributes& a = mesh_.attributes;
    if (any_uv_) a.uv.resize(rows_.size());
    if (any_normal_) a.normal.resize(rows_.size());
    for (std::size_t t = 0; t < rows_.size(); ++t)
      for (int k = 0; k < 3; ++k) {
        const Corner& corner = corners_[rows_[t][k]];
        const auto& [p, q, r] = mesh_.triangles[t];
        const bool has_uv = corner.uv != ~0u;
        const bool has_normal = corner.normal != ~0u && normal_[corner.normal].allFinite();
        if (any_uv_) a.uv[t][k] = has_uv ? uv_[corner.uv] : Vec2(Vec2::Zero());
        if (any_normal_)
          a.normal[t][k] = has_normal ? normal_[corner.normal]
                                      : face_normal(mesh_.vertices[p], mesh_.vertices[q], mesh_.vertices[r]);
      }
    const bool bytes = whole_colors_ && brightest_ > 1 && brightest_ <= 255;  // not numbers from 0 to 1
    for (Color& c : color_) {
      if (bytes) c.head<3>() /= 255;
      if (!c.allFinite()) c = Color::Ones();
    }
    if (colored_) a.color = at_corners(mesh_, color_);
    if (any_material_) {
      a.group = std::move(material_of_);
      a.group_names = std::move(materials_.all);
    } else if (any_part_) {
      a.group = std::move(part_of_);
      a.group_names = std::move(parts_.all);
    }
  }

  LineReader lines_;
  const std::string& name_;
  std::vector<std::string>& notes_;
  std::size_t polylines_ = 0, points_ = 0, curved_ = 0;  // lines that are left out
  double brightest_ = 0;                                 // the greatest number of a colour
  bool whole_colors_ = true;                             // whether all numbers of colours are integers
  bool weighted_ = false;                                // whether a fourth coordinate is not 1
  std::vector<std::string_view> words_;
  TriangleMesh mesh_;
  std::vector<Vec2> uv_;
  std::vector<Vec3> normal_;
  std::vector<Color> color_;
  bool colored_ = false, any_uv_ = false, any_normal_ = false, any_material_ = false, any_part_ = false;
  Names materials_, parts_;
  std::string material_, part_;  // of the faces that follow
  std::vector<std::string> material_files_;
  std::vector<Corner> corners_;
  std::vector<Face> faces_;
  std::size_t next_ = 0;  // first corner of the next face to be divided
  std::vector<std::uint32_t> polygon_;
  std::vector<std::int32_t> material_of_, part_of_;  // per triangle
  std::vector<std::array<std::size_t, 3>> rows_;     // per triangle: its corners
};

}  // namespace

TriangleMesh parse_obj(const std::string& bytes, const std::string& name, std::vector<std::string>& notes) {
  return ObjReader(bytes, name, notes).read();
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
    for (int i = 0; i < value.size(); ++i) result[static_cast<std::size_t>(i)] = bit_cast<std::uint64_t>(value[i]);
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
      if (!a.group.empty() && a.group[t] != group) {
        group = a.group[t];
        out << "usemtl " << a.group_names[static_cast<std::size_t>(group)] << '\n';
      }
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
