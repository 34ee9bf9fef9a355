// STL, PLY, OFF and OBJ of all kinds that programs write: each is read as the same tetrahedron, or
// refused with a reason.
#include <catch2/catch.hpp>
#include <cstring>
#include <filesystem>
#include <functional>

#include "io/samples.h"
#include "kerf/check.h"
#include "kerf/error.h"

using namespace geo;

namespace {

const std::vector<Vec3> corners = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
const std::vector<Triangle> faces = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};

SurfaceFile read(const std::string& bytes) { return parse_surface(bytes, "a"); }

std::string refusal(const std::string& bytes) {
  try {
    read(bytes);
  } catch (const InputError& e) {
    return e.what();
  }
  return "read";
}

void check_tetrahedron(const TriangleMesh& mesh) {
  CHECK(mesh.vertices.size() == 4);
  CHECK(mesh.triangles.size() == 4);
  CHECK(signed_volume(mesh) == Approx(1.0 / 6));
  CHECK(check_surface(mesh, SelfIntersections::find).good());
}

// The words of an ASCII STL file; `word` may change each keyword.
std::string ascii_stl(const std::function<std::string(std::string)>& word, const std::string& number = "") {
  std::string text;
  for (const auto& t : faces) {
    text += word("facet") + " " + word("normal") + " 0 0 0\n" + word("outer loop") + "\n";
    for (const auto v : t) {
      text += word("vertex");
      for (int k = 0; k < 3; ++k) text += " " + (corners[v][k] == 0 ? "0" : number.empty() ? "1" : number);
      text += "\n";
    }
    text += word("endloop") + "\n" + word("endfacet") + "\n";
  }
  return text;
}
std::string as_is(std::string word) { return word; }
std::string upper(std::string word) {
  for (char& c : word) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return word;
}

std::string binary_stl(const std::string& header, std::uint32_t count) {
  std::string bytes = header;
  bytes.resize(80, ' ');
  const auto put = [&](auto x) { bytes.append(reinterpret_cast<const char*>(&x), sizeof x); };
  put(count);
  for (const auto& t : faces) {
    const Vec3 n = 0.3 * face_normal(corners[t[0]], corners[t[1]], corners[t[2]]);  // of any length
    for (int k = 0; k < 3; ++k) put(float(n[k]));
    for (const auto v : t)
      for (int k = 0; k < 3; ++k) put(float(corners[v][k]));
    put(std::uint16_t(0));
  }
  return bytes;
}

std::string with_returns(const std::string& text, const std::string& end) {
  std::string out;
  for (const char c : text) out += c == '\n' ? end : std::string(1, c);
  return out;
}

}  // namespace

TEST_CASE("ASCII STL: keywords in any letters, blanks before them, two words at the end", "[kinds]") {
  for (const auto& entry : std::filesystem::directory_iterator(KERF_IO_CASES "/stl")) {
    INFO(entry.path().filename());
    const TriangleMesh mesh = read_surface(entry.path().string()).mesh;
    CHECK(signed_volume(mesh) == Approx(1));
    CHECK(check_surface(mesh, SelfIntersections::find).good());
  }
  const std::string body = ascii_stl(as_is);
  for (const std::string& text :
       {"solid\n" + body + "endsolid\n", "\n\n \t solid a b\n" + body + "endsolid a b",
        "SOLID A\n" + ascii_stl(upper) + "ENDSOLID A\n", "Solid\n" + body + "end solid\n",
        "solid x\n" + body + "EndSolid\n\n\n", "\xef\xbb\xbfsolid x\n" + body + "endsolid x\n",
        "solid x\n" + ascii_stl(as_is, "1.0E+00") + "endsolid x\n",
        "solid x\n" + ascii_stl(as_is, "+1.e0") + "endsolid x\n"}) {
    INFO(text.substr(0, 40));
    check_tetrahedron(read(text).mesh);
    check_tetrahedron(read(with_returns(text, "\r\n")).mesh);
    check_tetrahedron(read(with_returns(text, "\r")).mesh);
  }
  // Several solids in one file are one surface.
  const std::size_t half = body.find("endfacet\n", body.find("endfacet") + 1) + 9;
  check_tetrahedron(
      read("solid a\n" + body.substr(0, half) + "endsolid a\nsolid b\n" + body.substr(half) + "endsolid b\n").mesh);
  CHECK_THAT(refusal("solid a\n" + body), Catch::Contains("truncated"));
  CHECK_THAT(refusal("solid a\n" + body + "endsolid a\nsolid b\n" + body), Catch::Contains("truncated"));
  CHECK_THAT(refusal("solid a\n" + body.substr(0, body.size() - 40)), Catch::Contains("truncated"));
}

TEST_CASE("binary STL: the header says nothing, bytes behind the last facet and counts of zero are told", "[kinds]") {
  for (const std::string header : {"", "solid", "solid facet normal", "ply", "glTF", "v 1 2 3", "OFF 3", "FORM"}) {
    INFO(header);
    const SurfaceFile file = read(binary_stl(header, 4));
    check_tetrahedron(file.mesh);
    CHECK(file.notes.empty());
  }
  for (const std::string header : {"", "solid made by a program"})
    for (const std::string& rest : {std::string(1, '\0'), std::string("\r\n"), std::string(512, 'x')}) {
      const SurfaceFile file = read(binary_stl(header, 4) + rest);
      check_tetrahedron(file.mesh);
      CHECK(file.notes ==
            std::vector<std::string>{std::to_string(rest.size()) + " bytes after its last facet are left out"});
    }
  for (const std::uint32_t count : {0u, ~0u}) {
    const SurfaceFile file = read(binary_stl("", count));
    check_tetrahedron(file.mesh);
    CHECK(file.notes == std::vector<std::string>{"its header counts no facets; all 4 that follow are read"});
  }
  CHECK_THAT(refusal(binary_stl("", 5)),
             Catch::Contains("has 4 of the 5 facets that its header counts; the file is truncated"));
  CHECK_THAT(refusal(std::string(1000, '\x7f')), Catch::Contains("no surface file that is known here"));
}

TEST_CASE("PLY: headers and elements of other programs", "[kinds]") {
  const std::string rows = "0 0 0\n1 0 0\n0 1 0\n0 0 1\n", triangles = "3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n";
  const std::string xyz = "property float x\nproperty float y\nproperty float z\n";
  const std::string begin = "ply\nformat ascii 1.0\n", end = "end_header\n";
  const std::string vertex = "element vertex 4\n" + xyz, face = "element face 4\n";
  for (const std::string list :
       {"property list uchar int vertex_indices\n", "property list uint8 int32 vertex_index\n",
        "property list int uint vertex_indices\n", "property list ushort short vertex_index\n",
        "property list char uchar vertex_indices\n", "property list uchar float vertex_indices\n",
        "property list int64 uint64 vertex_indices\n"}) {
    INFO(list);
    check_tetrahedron(read(begin + vertex + face + list + end + rows + triangles).mesh);
  }
  const std::string list = "property list uchar int vertex_indices\n",
                    whole = begin + vertex + face + list + end + rows + triangles;
  check_tetrahedron(read("ply\ncomment a\nformat ascii 1.0\nobj_info num_cols 5\ncomment\n" + vertex + "comment b\n" +
                         face + list + "obj_info c\n" + end + "comment between\n" + rows + triangles)
                        .mesh);
  check_tetrahedron(read(with_returns(whole, "\r\n")).mesh);
  check_tetrahedron(read(with_returns(whole, "\r")).mesh);
  CHECK(read(whole + "\n\n  \n").notes.empty());
  const SurfaceFile more = read(whole + "and more\n");
  check_tetrahedron(more.mesh);
  CHECK(more.notes == std::vector<std::string>{"what follows its last element is left out"});
  // Elements and properties before, between and after.
  const SurfaceFile extra = read(
      begin + "element camera 1\nproperty float view\n" + "element vertex 4\nproperty uchar flag\n" + xyz +
      "property list uchar float weights\n" + face + "property int part\n" + list +
      "property float quality\nelement edge 1\nproperty int vertex1\nproperty int vertex2\n" + end +
      "7\n1 0 0 0 0\n1 1 0 0 2 5 6\n1 0 1 0 0\n1 0 0 1 1 9\n8 3 0 2 1 0\n8 3 0 1 3 0\n8 3 0 3 2 0\n8 3 1 2 3 0\n0 1\n");
  check_tetrahedron(extra.mesh);
  CHECK(extra.notes == std::vector<std::string>{
                           "left out: element 'camera', element 'edge', 'flag' of vertices, 'weights' of vertices, "
                           "'part' of faces, 'quality' of faces"});
}

TEST_CASE("PLY: triangle strips, alone and beside faces", "[kinds]") {
  const std::string head =
      "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n";
  const std::string rows = "0 0 0\n1 0 0\n0 1 0\n0 0 1\n";
  const std::string strips = "element tristrips 1\nproperty list int int vertex_indices\nend_header\n";
  check_tetrahedron(read(head + strips + rows + "6 0 2 1 3 0 2\n").mesh);
  check_tetrahedron(read(head + strips + rows + "15 0 2 1 -1 0 1 3 -1 0 3 2 -1 1 2 3\n").mesh);
  // Triangles with two equal corners join strips.
  CHECK(read(head + strips + rows + "9 0 2 1 1 1 3 0 2 2\n").mesh.triangles ==
        std::vector<Triangle>{{0, 2, 1}, {1, 3, 0}, {0, 3, 2}});
  check_tetrahedron(read(head + "element face 2\nproperty list uchar int vertex_index\n" + strips + rows +
                         "3 0 2 1\n3 1 2 3\n7 0 1 3 -1 0 3 2\n")
                        .mesh);
  CHECK_THAT(refusal(head + strips + rows + "3 0 2 4\n"), Catch::Contains("names vertex 4"));
}

TEST_CASE("PLY: binary rows behind a header whose lines end with carriage returns, in both orders", "[kinds]") {
  TriangleMesh mesh;
  mesh.vertices = corners;
  mesh.triangles = faces;
  for (const auto format : {PlyText::little, PlyText::big})
    for (const std::string end : {"\n", "\r\n", "\r"}) {
      const std::string bytes = PlyText::of(format, mesh);
      const std::size_t rows = bytes.find("end_header\n") + 11;
      const std::string other = with_returns(bytes.substr(0, rows), end) + bytes.substr(rows);
      check_tetrahedron(read(other).mesh);
      CHECK(read(other).notes.empty());
      CHECK(read(other + "\r\n").notes.empty());
      check_tetrahedron(read(other + "tail").mesh);
      CHECK(read(other + "tail").notes.size() == 1);
    }
}

TEST_CASE("OFF: keywords of all layouts, counts on their line, what follows the faces", "[kinds]") {
  const std::string rest = "3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n", plain = "0 0 0\n1 0 0\n0 1 0\n0 0 1\n";
  for (const std::string& text :
       {"OFF\n4 4 6\n" + plain + rest, "OFF 4 4 6\n" + plain + rest, "off\n4 4\n" + plain + rest,
        "# made by\n\nOFF # keyword\n\n4 4 6 # counts\n\n" + plain + "# faces\n" + rest, "4 4 6\n" + plain + rest,
        "4OFF\n4 4 0\n0 0 0 1\n2 0 0 2\n0 3 0 3\n0 0 1 1\n" + rest,
        "STOFF\n4 4 0\n0 0 0 0 0\n1 0 0 1 0\n0 1 0 0 1\n0 0 1 1 1\n" + rest,
        "STCNOFF\n4 4 0\n0 0 0 0 0 1 1 0 0 1 0 0\n1 0 0 0 0 1 1 0 0 1 1 0\n0 1 0 0 0 1 1 0 0 1 0 1\n0 0 1 0 0 1 1 0 0 "
        "1 1 1\n" +
            rest}) {
    INFO(text.substr(0, 30));
    const SurfaceFile file = read(text);
    check_tetrahedron(file.mesh);
    CHECK(file.notes.empty());
    check_tetrahedron(read(with_returns(text, "\r\n")).mesh);
    CHECK(read(text + "one more line\n").notes == std::vector<std::string>{"lines after its last face are left out"});
  }
  const TriangleMesh placed =
      read("STCNOFF\n3 1 0\n0 0 0 0 0 1 1 0 0 1 0 0\n1 0 0 0 0 1 1 0 0 1 0.5 0\n0 1 0 0 0 1 1 0 0 1 0 1\n3 0 1 2\n")
          .mesh;
  CHECK(placed.attributes.uv[0][1] == Vec2(0.5, 0));
  CHECK(placed.attributes.normal[0][1] == Vec3(0, 0, 1));
  CHECK(placed.attributes.color[0][1] == Color(1, 0, 0, 1));
  CHECK(read("OFF\n4 4 6\n" + plain + "3 0 2 1 255 0 0\n3 0 1 3\n3 0 3 2\n3 1 2 3\n").notes ==
        std::vector<std::string>{"left out: colours of faces"});
  CHECK_THAT(refusal("OFF BINARY\n4 4 6\n" + plain + rest), Catch::Contains("binary OFF file, which is not read"));
  CHECK_THAT(refusal("4OFF\n4 4 0\n0 0 0 0\n2 0 0 2\n0 3 0 3\n0 0 1 1\n" + rest), Catch::Contains("fourth coordinate"));
}

TEST_CASE("OBJ: fourth coordinates, colours, old keywords, lines and points, a long list before the vertices",
          "[kinds]") {
  const std::string f = "f 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
  for (const std::string& text : std::vector<std::string>{
           "v 0 0 0 1\nv 1 0 0 1.0\nv 0 1 0 1\nv 0 0 1 1\n" + f,
           "v 0 0 0 1 0 0\nv 1 0 0 1 0 0\nv 0 1 0 1 0 0\nv 0 0 1 1 0 0\n" + f,
           "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nfo 1 3 2\nfo 1 2 4\nf -4 -1 -2\nf 2 \\\n 3 4\n", [&] {
             std::string text;
             for (int i = 0; i < 500; ++i) text += "vt 0 0\n";
             return text + "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n" + f;
           }()}) {
    INFO(text.substr(0, 30));
    const SurfaceFile file = read(text);
    check_tetrahedron(file.mesh);
    CHECK(file.notes.empty());
  }
  const auto color =
      read("v 0 0 0 0 0 0\nv 1 0 0 255 51 0\nv 0 1 0 0 0 255\nv 0 0 1 0 0 0\n" + f).mesh.attributes.color;
  CHECK(color[0][2] == Color(1, 0.2, 0, 1));  // of vertex 2
  const std::string v = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n";
  CHECK(read(v + f + "l 1 2 3\nl 2 3\np 4\n").notes ==
        std::vector<std::string>{"left out: 1 line of points, 2 polylines"});
  CHECK(read(v + f + "v 0 0 5 0.5\n").notes ==
        std::vector<std::string>{"the fourth coordinates of its vertices are weights of curves and have no effect"});
}
