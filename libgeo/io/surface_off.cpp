// parse_off() of io/surface_formats.h. OFF as Geomview defines it: the keyword's letters say which
// numbers a vertex has, in this order: coordinates, normal (N), colour (C), texture coordinates
// (ST).
#include <algorithm>

#include "io/line_reader.h"
#include "io/surface_formats.h"

namespace geo {
namespace {

// The numbers that a vertex has.
struct OffLayout {
  bool texture = false, colored = false, normals = false, homogeneous = false;
};

// The layout that a keyword stands for, in any letters; false for another word. A small n stands
// for coordinates of any number, which are not read.
bool read_keyword(std::string_view word, OffLayout& layout) {
  std::string text(word);
  for (char& c : text) c = static_cast<char>(c >= 'a' && c <= 'z' && c != 'n' ? c - 'a' + 'A' : c);
  std::string_view rest = text;
  const auto taken = [&](std::string_view prefix) {
    if (!rest.starts_with(prefix)) return false;
    rest.remove_prefix(prefix.size());
    return true;
  };
  const bool texture = taken("ST"), colored = taken("C"), normals = taken("N"), homogeneous = taken("4");
  if (rest != "OFF") return false;
  layout = {.texture = texture, .colored = colored, .normals = normals, .homogeneous = homogeneous};
  return true;
}

class OffReader {
 public:
  OffReader(const std::string& bytes, const std::string& name, std::vector<std::string>& notes)
      : bytes_(bytes), lines_(bytes, name), name_(name), notes_(notes) {}

  TriangleMesh read() {
    read_counts();
    for (vertex_ = 0; vertex_ < vertices_; ++vertex_) read_vertex();
    read_faces();
    if (lines_.next(words_)) notes_.push_back("lines after its last face are left out");
    add_attributes();
    return std::move(mesh_);
  }

 private:
  void read_counts() {
    if (!lines_.next(words_)) lines_.fail("is empty");
    if (read_keyword(words_[0], layout_)) words_.erase(words_.begin());  // the keyword is optional
    if (!words_.empty() && words_[0] == "BINARY")
      lines_.fail("is a binary OFF file, which is not read; save it as text");
    if (words_.empty() && !lines_.next(words_)) lines_.fail("ends before its counts");
    if (words_.size() < 2) lines_.fail("the counts of vertices and faces are missing");
    vertices_ = lines_.integer(words_[0]);
    faces_ = lines_.integer(words_[1]);
    if (vertices_ < 0 || faces_ < 0 ||
        static_cast<std::size_t>(vertices_) + static_cast<std::size_t>(faces_) > bytes_.size())
      lines_.fail("the file is too short for its counts; it is truncated");
  }

  // The next three numbers of the line; `what` they are, in a message.
  Vec3 three(const char* what) {
    if (words_.size() < used_ + 3) lines_.fail(what);
    const Vec3 p(lines_.real(words_[used_]), lines_.real(words_[used_ + 1]), lines_.real(words_[used_ + 2]));
    used_ += 3;
    return p;
  }

  void read_vertex() {
    if (!lines_.next(words_))
      lines_.fail("ends after " + std::to_string(vertex_) + " of " + std::to_string(vertices_) +
                  " vertices; the file is truncated");
    used_ = 0;
    Vec3 p = three("a vertex needs three coordinates");
    if (layout_.homogeneous) {
      if (words_.size() < 4) lines_.fail("a vertex of a 4OFF file needs a fourth coordinate");
      p /= lines_.real(words_[used_++]);
      if (!p.allFinite()) lines_.fail("the fourth coordinate of a vertex is 0; repair the file");
    }
    mesh_.vertices.push_back(p);
    if (layout_.normals) normal_.push_back(three("a vertex of a NOFF file needs a normal behind its coordinates"));
    if (layout_.colored) read_color();
    if (!layout_.texture) return;
    if (words_.size() < 2) lines_.fail("a vertex of an STOFF file needs two texture coordinates at its end");
    uv_.push_back({lines_.real(words_[words_.size() - 2]), lines_.real(words_.back())});
  }

  void read_color() {
    const std::size_t behind = layout_.texture ? 2 : 0;  // numbers after the colour
    const std::size_t count = words_.size() - std::min(words_.size(), used_ + behind);
    if (count != 3 && count != 4)
      lines_.fail("a vertex of a COFF file needs a colour, three or four numbers, behind its coordinates");
    Color c(0, 0, 0, 1);
    for (std::size_t k = 0; k < count; ++k) {
      const std::string_view word = words_[used_ + k];
      c[static_cast<int>(k)] = lines_.real(word);
      bytes_given_ = bytes_given_ && word.find_first_not_of("0123456789") == std::string_view::npos;
      largest_ = std::max(largest_, c[static_cast<int>(k)]);
    }
    opaque_.push_back(count == 3);
    color_.push_back(c);
  }

  void read_faces() {
    std::vector<std::uint32_t> polygon;
    bool colored = false;
    for (long long i = 0; i < faces_; ++i) {
      if (!lines_.next(words_))
        lines_.fail("ends after " + std::to_string(i) + " of " + std::to_string(faces_) +
                    " faces; the file is truncated");
      const auto n = lines_.integer(words_[0]);
      if (n < 0 || static_cast<std::size_t>(n) + 1 > words_.size())
        lines_.fail("a face has fewer vertices than it says");
      polygon.clear();
      for (long long k = 1; k <= n; ++k)
        polygon.push_back(row_of(static_cast<double>(lines_.integer(words_[static_cast<std::size_t>(k)]))));
      add_polygon(mesh_, polygon, name_ + ": face " + std::to_string(i) + ": ");
      colored = colored || words_.size() > static_cast<std::size_t>(n) + 1;
    }
    if (colored) add_left_out(notes_, {"colours of faces"});
  }

  void add_attributes() {
    if (layout_.colored && bytes_given_ && largest_ > 1)
      for (std::size_t v = 0; v < color_.size(); ++v) {
        color_[v] /= 255;
        if (opaque_[v]) color_[v][3] = 1;
      }
    if (layout_.texture) mesh_.attributes.uv = at_corners(mesh_, uv_);
    if (layout_.normals) mesh_.attributes.normal = at_corners(mesh_, normal_);
    if (layout_.colored) mesh_.attributes.color = at_corners(mesh_, color_);
  }

  const std::string& bytes_;
  LineReader lines_;
  const std::string& name_;
  std::vector<std::string>& notes_;
  std::vector<std::string_view> words_;
  std::size_t used_ = 0;  // words of a vertex's line that are read
  OffLayout layout_;
  long long vertices_ = 0, faces_ = 0, vertex_ = 0;
  TriangleMesh mesh_;
  std::vector<Vec3> normal_;
  std::vector<Vec2> uv_;
  std::vector<Color> color_;
  std::vector<bool> opaque_;  // per colour: without alpha
  bool bytes_given_ = true;   // integers from 0 to 255, not numbers from 0 to 1
  double largest_ = 0;
};

}  // namespace

bool looks_like_off(const std::string& bytes) {
  LineReader lines(std::string_view(bytes).substr(0, 4096), "");
  std::vector<std::string_view> words;
  if (!lines.next(words)) return false;
  const auto numbers = [&](std::string_view allowed) {
    return words.size() == 3 && std::all_of(words.begin(), words.end(), [&](std::string_view word) {
             return word.find_first_not_of(allowed) == std::string_view::npos;
           });
  };
  if (numbers("0123456789")) return lines.next(words) && numbers("0123456789+-.eE");
  OffLayout layout;
  return read_keyword(words[0], layout);
}

TriangleMesh parse_off(const std::string& bytes, const std::string& name, std::vector<std::string>& notes) {
  return OffReader(bytes, name, notes).read();
}

}  // namespace geo
