// parse_off() of io/surface_formats.h. OFF, with normals (NOFF) and colours (COFF) of vertices.
#include <algorithm>

#include "io/line_reader.h"
#include "io/surface_formats.h"

namespace geo {

TriangleMesh parse_off(const std::string& bytes, const std::string& name) {
  LineReader lines(bytes, name);
  std::vector<std::string_view> words;
  if (!lines.next(words)) lines.fail("is empty");
  const bool normals = words[0].find('N') != std::string_view::npos, colored = words[0][0] == 'C';
  if (words[0].find('F') != std::string_view::npos) words.erase(words.begin());  // the keyword is optional
  if (words.empty() && !lines.next(words)) lines.fail("ends before its counts");
  if (words.size() < 2) lines.fail("the counts of vertices and faces are missing");
  const auto nv = lines.integer(words[0]), nf = lines.integer(words[1]);
  if (nv < 0 || nf < 0 || static_cast<std::size_t>(nv) + static_cast<std::size_t>(nf) > bytes.size())
    lines.fail("the file is too short for its counts; it is truncated");
  TriangleMesh mesh;
  std::vector<Vec3> normal;
  std::vector<Color> color;
  std::vector<bool> opaque;  // per colour: without alpha
  bool bytes_given = true;   // integers from 0 to 255, not numbers from 0 to 1
  double largest = 0;
  for (long long i = 0; i < nv; ++i) {
    if (!lines.next(words))
      lines.fail("ends after " + std::to_string(i) + " of " + std::to_string(nv) + " vertices; the file is truncated");
    if (words.size() < 3) lines.fail("a vertex needs three coordinates");
    mesh.vertices.push_back({lines.real(words[0]), lines.real(words[1]), lines.real(words[2])});
    words.erase(words.begin(), words.begin() + 3);
    if (normals) {
      if (words.size() < 3) lines.fail("a vertex of a NOFF file needs a normal behind its coordinates");
      normal.push_back({lines.real(words[0]), lines.real(words[1]), lines.real(words[2])});
      words.erase(words.begin(), words.begin() + 3);
    }
    if (colored) {
      if (words.size() != 3 && words.size() != 4)
        lines.fail("a vertex of a COFF file needs a colour, three or four numbers, behind its coordinates");
      Color c(0, 0, 0, 1);
      for (std::size_t k = 0; k < words.size(); ++k) {
        c[static_cast<int>(k)] = lines.real(words[k]);
        bytes_given = bytes_given && words[k].find_first_not_of("0123456789") == std::string_view::npos;
        largest = std::max(largest, c[static_cast<int>(k)]);
      }
      opaque.push_back(words.size() == 3);
      color.push_back(c);
    }
  }
  std::vector<std::uint32_t> polygon;
  for (long long i = 0; i < nf; ++i) {
    if (!lines.next(words))
      lines.fail("ends after " + std::to_string(i) + " of " + std::to_string(nf) + " faces; the file is truncated");
    const auto n = lines.integer(words[0]);
    if (n < 0 || static_cast<std::size_t>(n) + 1 > words.size()) lines.fail("a face has fewer vertices than it says");
    polygon.clear();
    for (long long k = 1; k <= n; ++k)
      polygon.push_back(row_of(static_cast<double>(lines.integer(words[static_cast<std::size_t>(k)]))));
    add_polygon(mesh, polygon, name + ": face " + std::to_string(i) + ": ");
  }
  if (lines.next(words)) lines.fail("has lines after its last face; the file is damaged");
  if (colored && bytes_given && largest > 1)
    for (std::size_t v = 0; v < color.size(); ++v) {
      color[v] /= 255;
      if (opaque[v]) color[v][3] = 1;
    }
  if (normals) mesh.attributes.normal = at_corners(mesh, normal);
  if (colored) mesh.attributes.color = at_corners(mesh, color);
  return mesh;
}

}  // namespace geo
