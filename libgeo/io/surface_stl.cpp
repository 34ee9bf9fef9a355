// parse_stl() of io/surface_formats.h. STL, ASCII and binary: triangles only, three vertices each.
//
// A binary file has a header of 80 bytes, the number of facets, and 50 bytes for each: normal,
// three corners, and two bytes that some programs use for colours. Its header may begin with
// "solid", as an ASCII file does. So the length decides first, then words that only an ASCII file
// has.
#include <algorithm>
#include <cctype>
#include <cstring>

#include "io/line_reader.h"
#include "io/surface_formats.h"

namespace geo {
namespace {

constexpr std::size_t stl_head = 84, stl_facet = 50;  // bytes

void add(TriangleMesh& mesh, const Vec3 (&corners)[3]) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), corners, corners + 3);
  mesh.triangles.push_back({first, first + 1, first + 2});
}

std::uint32_t count_of(const std::string& bytes) {
  std::uint32_t count = 0;
  std::memcpy(&count, bytes.data() + stl_head - sizeof count, sizeof count);
  return count;
}

// A word in small letters: some programs write keywords in capitals.
std::string small(std::string_view word) {
  std::string text(word);
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

// Whether the text begins with "solid" and has a facet or an end, in any letters.
bool looks_like_ascii_stl(const std::string& bytes) {
  LineReader lines(bytes, "", 0);
  std::vector<std::string_view> words;
  if (!lines.next(words) || small(words[0]) != "solid") return false;
  // Binary headers end within 84 bytes; 64 lines may be blank or comments.
  for (int i = 0; i < 64 && lines.next(words); ++i) {
    const std::string word = small(words[0]);
    if (word == "facet" || word == "endsolid") return true;
    if (word == "end" && words.size() > 1 && small(words[1]) == "solid") return true;
  }
  return false;
}

// The coordinates of a facet. Numbers may be invalid.
void corners_at(const std::string& bytes, std::size_t facet, Vec3 (&corners)[3]) {
  float f[12];
  std::memcpy(f, bytes.data() + stl_head + stl_facet * facet, sizeof f);
  for (int k = 0; k < 3; ++k) corners[k] = Vec3(f[3 + 3 * k], f[4 + 3 * k], f[5 + 3 * k]);
}

// Whether bytes behind a header are facets: all twelve numbers of each are zero or of a sensible
// size. Integers, as other formats have them, are denormal numbers.
bool looks_like_facets(const std::string& bytes, std::size_t count) {
  constexpr float least = 1e-30f, greatest = 1e12f;
  for (std::size_t t = 0; t < count; ++t) {
    float f[12];
    std::memcpy(f, bytes.data() + stl_head + stl_facet * t, sizeof f);
    for (const float x : f)
      if (x != 0 && !(std::abs(x) >= least && std::abs(x) <= greatest)) return false;
  }
  return count > 0;
}

// The number of facets of a binary file: that of its header, or the number that its bytes hold
// where the header has none. Zero: this is no binary file.
std::size_t binary_facets(const std::string& bytes, const std::string& name, std::vector<std::string>& notes) {
  if (bytes.size() < stl_head) return 0;
  const std::size_t count = count_of(bytes), held = (bytes.size() - stl_head) / stl_facet;
  const std::size_t rest = bytes.size() - stl_head - stl_facet * held;
  if (count == held && rest == 0) return count;
  // Programs that stream leave the count at 0 or at −1.
  if (count == 0 || count == ~0u) {
    if (rest != 0 || !looks_like_facets(bytes, held)) return 0;
    notes.push_back("its header counts no facets; all " + std::to_string(held) + " that follow are read");
    return held;
  }
  if (count <= held && looks_like_facets(bytes, count)) {
    notes.push_back(std::to_string(bytes.size() - stl_head - stl_facet * count) +
                    " bytes after its last facet are left out");
    return count;
  }
  if (count > held && looks_like_facets(bytes, held))
    throw InputError(name + ": has " + std::to_string(held) + " of the " + std::to_string(count) +
                     " facets that its header counts; the file is truncated");
  return 0;
}

TriangleMesh parse_binary_stl(const std::string& bytes, const std::string& name, std::size_t count) {
  TriangleMesh mesh;
  for (std::size_t t = 0; t < count; ++t) {
    Vec3 corners[3];
    corners_at(bytes, t, corners);
    for (const auto& p : corners)
      if (!p.allFinite())
        throw InputError(name + ": triangle " + std::to_string(t) +
                         " has a coordinate that is not a finite number; repair the file");
    add(mesh, corners);
  }
  return mesh;
}

TriangleMesh parse_ascii_stl(const std::string& bytes, const std::string& name) {
  TriangleMesh mesh;
  LineReader lines(bytes, name, 0);
  std::vector<std::string_view> words;
  std::vector<Vec3> corners;
  bool ended = false;
  while (lines.next(words)) {
    const std::string word = small(words[0]);
    if (word == "vertex") {
      if (words.size() != 4) lines.fail("a vertex needs three coordinates");
      corners.push_back({lines.real(words[1]), lines.real(words[2]), lines.real(words[3])});
    } else if (word == "facet") {
      ended = false;
      if (!corners.empty()) lines.fail("a facet begins before the one before it has ended; the file is damaged");
    } else if (word == "endfacet" || (word == "end" && words.size() > 1 && small(words[1]) == "facet")) {
      if (corners.size() != 3) lines.fail("a facet needs three vertices");
      add(mesh, {corners[0], corners[1], corners[2]});
      corners.clear();
    } else if (word == "endsolid" || (word == "end" && words.size() > 1 && small(words[1]) == "solid")) {
      ended = true;
    }
  }
  if (!ended || !corners.empty()) lines.fail("ends without 'endsolid'; the file is truncated");
  return mesh;
}

}  // namespace

bool is_exact_binary_stl(const std::string& bytes) {
  return bytes.size() > stl_head && bytes.size() == stl_head + stl_facet * std::size_t(count_of(bytes));
}

TriangleMesh parse_stl(const std::string& bytes, const std::string& name, std::vector<std::string>& notes) {
  if (!is_exact_binary_stl(bytes) && looks_like_ascii_stl(bytes)) return parse_ascii_stl(bytes, name);
  const std::size_t count = binary_facets(bytes, name, notes);
  if (count == 0) throw InputError(name + ": is no surface file that is known here, or an STL file that is truncated");
  return parse_binary_stl(bytes, name, count);
}

}  // namespace geo
