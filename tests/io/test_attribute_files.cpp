// Attributes of surfaces in files of every format, written and read back.
#include <catch2/catch.hpp>
#include <sstream>

#include "base/random.h"
#include "cases.h"
#include "kerf/crack.h"
#include "kerf/error.h"
#include "kerf/files.h"
#include "kerf/mesh.h"
#include "kerf/pieces.h"

using namespace geo;

namespace {

std::string ply_of(const TriangleMesh& mesh) {
  std::ostringstream out;
  write_ply(out, mesh);
  return out.str();
}
std::string obj_of(const TriangleMesh& mesh) {
  std::ostringstream out;
  write_obj(out, mesh);
  return out.str();
}

// Every attribute; `smooth`: one normal and one colour at each vertex, `coarse`: what floats and
// bytes can hold.
TriangleMesh dressed(TriangleMesh mesh, bool smooth, bool coarse) {
  Random random(11);
  const auto number = [&] {
    return coarse ? static_cast<double>(static_cast<float>(random.uniform(-1, 2))) : random.uniform(-1, 2);
  };
  const auto shade = [&] { return coarse ? random.below(256) / 255.0 : random.uniform(); };
  Attributes& a = mesh.attributes;
  std::vector<Vec3> normal;
  std::vector<Color> color;
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    normal.push_back({number(), number(), number()});
    color.push_back({shade(), shade(), shade(), 1});
  }
  a.group_names = {"skin of the lid", "base", "stalk"};
  a.materials = "apple.mtl";
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    a.group.push_back(static_cast<std::int32_t>(t < 3 ? t : random.below(3)));
    a.uv.push_back({Vec2(number(), number()), Vec2(number(), number()), Vec2(number(), number())});
    a.normal.emplace_back();
    a.color.emplace_back();
    for (int k = 0; k < 3; ++k) {
      a.normal[t][k] = smooth ? normal[mesh.triangles[t][k]] : Vec3(number(), number(), number());
      a.color[t][k] = smooth ? color[mesh.triangles[t][k]] : Color(shade(), shade(), shade(), shade());
    }
  }
  return mesh;
}

bool has(const std::string& bytes, const std::string& line) {
  return bytes.substr(0, bytes.find("end_header")).find("property " + line + "\n") != std::string::npos;
}

const std::string tetrahedron = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nvt 0 0\nvt 1 0.5\nvt 0.25 1\nvn 0 0 1\nvn 1 0 0\n";

}  // namespace

TEST_CASE("every attribute is read back from PLY to the bit, in the smallest type that holds it") {
  for (const bool smooth : {false, true})
    for (const bool coarse : {false, true}) {
      CAPTURE(smooth, coarse);
      TriangleMesh mesh = dressed(make_sphere(3), smooth, coarse);
      for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
        mesh.source.push_back(t % 5 == 0 ? ~0u : static_cast<std::uint32_t>(7 * t));
      const std::string bytes = ply_of(mesh);
      const TriangleMesh again = parse_surface(bytes, "a.ply").mesh;
      CHECK(again.attributes == mesh.attributes);
      CHECK(again.source == mesh.source);
      CHECK(ply_of(again) == bytes);
      const std::string number = coarse ? "float" : "double";
      CHECK(has(bytes, "list uchar " + number + " texcoord"));
      CHECK(has(bytes, number + " nx") == smooth);
      CHECK(has(bytes, (coarse ? "uchar red" : "double red")) == smooth);
      CHECK(has(bytes, "list uchar " + number + " normal") != smooth);
      CHECK(has(bytes, "list uchar " + std::string(coarse ? "uchar" : "double") + " color") != smooth);
    }
}

TEST_CASE("every attribute is read back from OBJ to the bit") {
  TriangleMesh mesh = dressed(make_sphere(3), true, false);
  for (auto& row : mesh.attributes.color)
    for (auto& c : row) c[3] = 1;  // there is no alpha in OBJ
  const std::string text = obj_of(mesh);
  const TriangleMesh again = parse_surface(text, "a.obj").mesh;
  CHECK(again.attributes == mesh.attributes);
  CHECK(again.triangles == mesh.triangles);
  CHECK(obj_of(again) == text);
  CHECK(text.find("usemtl skin of the lid") != std::string::npos);
  // One line for each different value.
  std::size_t normals = 0;
  for (std::size_t at = text.find("vn "); at != std::string::npos; at = text.find("\nvn ", at + 1)) ++normals;
  CHECK(normals == mesh.vertices.size());
}

TEST_CASE("a cut surface's attributes are read back, and vertices tell them where they can") {
  for (const bool smooth : {false, true}) {
    CAPTURE(smooth);
    const TriangleMesh model = dressed(make_block({4, 4, 4}, 1), smooth, false);
    Complex complex = Complex::from_skin(model);
    FrontState front = begin_front(std::vector<Vec3>{{-1, -1, 1.3}, {-1, 5, 1.3}}, false, 1);
    advance(complex, front, std::vector<Vec3>{{2.2, -1, 1.3}, {2.2, 5, 1.35}});
    TriangleMesh once = complex.two_sided();
    transfer_attributes(model, once);
    const std::string bytes = ply_of(once);
    CHECK(has(bytes, "double nx") == smooth);
    CHECK(bytes.find("double normal\n") == (smooth ? std::string::npos : bytes.find("double normal\n")));
    const TriangleMesh file = parse_surface(bytes, "once.ply").mesh;
    CHECK(file.attributes == once.attributes);
    CHECK(file.source == once.source);
    // Cut again: sources are those of the first model.
    Complex again = Complex::from_two_sided(file);
    FrontState second = begin_front(std::vector<Vec3>{{1.7, -1, 5}, {1.7, 5, 5}}, false, 2);
    advance(again, second, std::vector<Vec3>{{1.7, -1, -1}, {1.72, 5, -1}});
    TriangleMesh twice = again.two_sided();
    transfer_attributes(file, twice);
    const TriangleMesh last = parse_surface(ply_of(twice), "twice.ply").mesh;
    CHECK(last.attributes == twice.attributes);
    REQUIRE(last.source == twice.source);
    for (std::size_t t = 0; t < last.triangles.size(); ++t) {
      REQUIRE((last.source[t] == ~0u) == (last.patch[t] != 0));
      if (last.source[t] != ~0u) REQUIRE(last.attributes.group[t] == model.attributes.group[last.source[t]]);
    }
    CHECK(last.attributes.group_names.back() == "crack");
    // As OBJ, patches are groups and groups are materials.
    const TriangleMesh obj = parse_surface(obj_of(twice), "twice.obj").mesh;
    CHECK(obj.attributes.group_names.size() == 4);
    CHECK(obj.attributes.uv.size() == obj.triangles.size());
    // A piece is read back too.
    TriangleMesh piece = piece_mesh(again, find_pieces(again), 0);
    transfer_attributes(file, piece);
    piece.site.clear();
    const TriangleMesh piece_file = parse_surface(ply_of(piece), "piece.ply").mesh;
    CHECK(piece_file.attributes == piece.attributes);
    CHECK(piece_file.source == piece.source);
  }
}

TEST_CASE("OBJ: every form of a face") {
  const auto mesh =
      parse_surface(tetrahedron + "f 1/1/1 3/2/1 2/3/2\nf 1//1 2//2 4//1\nf -3/-1 -2/-2 -1/-3\nf 1 4 3\n", "a.obj")
          .mesh;
  const Attributes& a = mesh.attributes;
  CHECK(a.names() == std::vector<std::string>{"uv", "normal"});
  CHECK(a.uv[0] == std::array<Vec2, 3>{Vec2(0, 0), Vec2(1, 0.5), Vec2(0.25, 1)});
  CHECK(a.uv[1][2] == Vec2(0, 0));
  CHECK(a.uv[2] == std::array<Vec2, 3>{Vec2(0.25, 1), Vec2(1, 0.5), Vec2(0, 0)});
  CHECK(a.normal[1] == std::array<Vec3, 3>{Vec3(0, 0, 1), Vec3(1, 0, 0), Vec3(0, 0, 1)});
  CHECK(a.normal[3][0] == Vec3(-1, 0, 0));  // none given: the triangle's own
  CHECK(mesh.triangles[2] == Triangle{1, 2, 3});
  // A polygon's corners keep their values in its fan.
  const auto quad =
      parse_surface("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nf 1/1 2/2 3/3 4/4\n", "q.obj")
          .mesh;
  CHECK(quad.attributes.uv[1] == std::array<Vec2, 3>{Vec2(0, 0), Vec2(1, 1), Vec2(0, 1)});
  const auto colored = parse_surface("v 0 0 0 1 0 0\nv 1 0 0 0 1 0\nv 0 1 0 0 0 0.5\nf 1 2 3\n", "c.obj").mesh;
  CHECK(colored.attributes.color[0][2] == Color(0, 0, 0.5, 1));
}

TEST_CASE("OBJ: materials are groups, and without any objects and groups are") {
  const auto parts =
      parse_surface(tetrahedron + "o a\nf 1 3 2\ng b c\nf 1 2 4\no a\nf 2 3 4\n", "a.obj").mesh.attributes;
  CHECK(parts.group == std::vector<std::int32_t>{0, 1, 0});
  CHECK(parts.group_names == std::vector<std::string>{"a", "b c"});
  const auto materials =
      parse_surface("mtllib m.mtl\n" + tetrahedron +
                        "f 1 3 2\no a\nusemtl red\nf 1 2 4\nusemtl unused\nusemtl blue\nf 2 3 4\nusemtl red\nf 1 4 3\n",
                    "a.obj")
          .mesh.attributes;
  CHECK(materials.group == std::vector<std::int32_t>{0, 1, 2, 1});
  CHECK(materials.group_names == std::vector<std::string>{"default", "red", "blue"});
  CHECK(materials.materials == "m.mtl");
}

TEST_CASE("OBJ: indices out of range are refused with their line") {
  const auto refused = [](const std::string& face) { parse_surface(tetrahedron + face + "\n", "a.obj"); };
  CHECK_THROWS_WITH(refused("f 1/4 2/1 3/1"),
                    Catch::Contains("a.obj:10: a face names texture coordinate 4, but there are 3"));
  CHECK_THROWS_WITH(refused("f 1//1 2//-3 3//1"), Catch::Contains("a face names normal -3, but there are 2"));
  CHECK_THROWS_WITH(refused("f 1/1/0 2/1/1 3/1/1"), Catch::Contains("a face names normal 0"));
  CHECK_THROWS_WITH(refused("f 1 2 9"), Catch::Contains("a face names vertex 9"));
  CHECK_THROWS_WITH(refused("f 1/x 2/1 3/1"), Catch::Contains("'x' is not an integer"));
  CHECK_THROWS_WITH(refused("f 1/1/1/1 2/1/1 3/1/1"), Catch::Contains("is not an integer"));
  CHECK_THROWS_WITH(refused("v 0 nan 0"), Catch::Contains("finite"));
}

TEST_CASE("PLY: properties of vertices that other programs write") {
  const auto read = [](const std::string& vertex, const std::string& face, const std::string& extra,
                       const std::string& rows, const std::string& faces) {
    return parse_surface("ply\nformat ascii 1.0\n" + extra +
                             "element vertex 4\nproperty float x\nproperty float y\nproperty float z\n" + vertex +
                             "element face 1\nproperty list uchar int vertex_indices\n" + face + "end_header\n" + rows +
                             faces,
                         "a.ply")
        .mesh.attributes;
  };
  const std::string rows = "0 0 0 0 255\n1 0 0 51 0\n1 1 0 0 0\n0 1 0 0 102\n", quad = "4 0 1 2 3";
  for (const std::string& names : {std::string("s t"), std::string("u v"), std::string("texture_u texture_v")}) {
    const auto space = names.find(' ');
    const auto a =
        read("property float " + names.substr(0, space) + "\nproperty float " + names.substr(space + 1) + "\n", "", "",
             rows, quad + "\n");
    CHECK(a.uv[0] == std::array<Vec2, 3>{Vec2(0, 255), Vec2(51, 0), Vec2(0, 0)});
    CHECK(a.uv[1] == std::array<Vec2, 3>{Vec2(0, 255), Vec2(0, 0), Vec2(0, 102)});
  }
  const std::string colors = "0 0 0 255 0 51\n1 0 0 0 0 0\n1 1 0 0 0 0\n0 1 0 0 0 0\n",
                    rgb = "property uchar red\nproperty uchar green\nproperty uchar blue\n";
  CHECK(read(rgb, "", "", colors, quad + "\n").color[0][0] == Color(1, 0, 0.2, 1));
  const std::string plain = "0 0 0\n1 0 0\n1 1 0\n0 1 0\n";
  CHECK(read("", rgb, "", plain, quad + " 0 255 51\n").color[1][2] == Color(0, 1, 0.2, 1));
  CHECK(read("", "property list uchar float texcoord\n", "", plain, quad + " 8 0 0 1 0 1 1 0 1\n").uv[1][2] ==
        Vec2(0, 1));
  CHECK(read("", "property int group\n", "comment kerf_group one\ncomment kerf_group two\n", plain, quad + " 1\n")
            .group == std::vector<std::int32_t>{1, 1});
  CHECK(read("", "property int group\n", "", plain, quad + " 17\n").group_names ==
        std::vector<std::string>{"group_17"});
  CHECK_THROWS_WITH(read("", "property list uchar float texcoord\n", "", plain, quad + " 6 0 0 1 0 1 1\n"),
                    Catch::Contains("face 0: its list 'texcoord' has 6 numbers, but its 4 corners need 8"));
  CHECK_THROWS_WITH(read("", "property list uchar float normal\n", "", plain, quad + " 0\n"),
                    Catch::Contains("'normal' has 0 numbers"));
  CHECK_THROWS_WITH(read("", "property int group\n", "comment kerf_group one\n", plain, quad + " 1\n"),
                    Catch::Contains("is of group 1, but 1 groups are named"));
}

TEST_CASE("OFF: normals and colours of vertices") {
  const auto read = [](const std::string& head, const std::string& more) {
    return parse_surface(head + "\n3 1 0\n0 0 0 " + more + "\n1 0 0 " + more + "\n0 1 0 " + more + "\n3 0 1 2\n",
                         "a.off")
        .mesh.attributes;
  };
  CHECK(read("NOFF", "0 0 1").normal[0][1] == Vec3(0, 0, 1));
  CHECK(read("COFF", "255 0 51 102").color[0][1] == Color(1, 0, 0.2, 0.4));
  CHECK(read("COFF", "255 0 51").color[0][1] == Color(1, 0, 0.2, 1));
  CHECK(read("COFF", "0.5 0 1.0 1").color[0][2] == Color(0.5, 0, 1, 1));
  const auto both = read("CNOFF", "0 0 1 0.5 0.25 1 1");
  CHECK(both.normal[0][2] == Vec3(0, 0, 1));
  CHECK(both.color[0][2] == Color(0.5, 0.25, 1, 1));
  CHECK_THROWS_WITH(read("COFF", "1 2"), Catch::Contains("a.off:3: a vertex of a COFF file needs a colour"));
  CHECK_THROWS_WITH(read("NOFF", "1 2"), Catch::Contains("needs a normal"));
}

TEST_CASE("any change to a file with attributes gives an error or a result") {
  const TriangleMesh mesh = dressed(make_block({1, 1, 1}, 1), false, true),
                     smooth = dressed(make_block({1, 1, 1}, 1), true, true);
  Random random(99);
  for (const std::string& good : {ply_of(mesh), ply_of(smooth), obj_of(mesh)})
    for (int i = 0; i < cases(1500); ++i) {
      CAPTURE(i);
      std::string bytes = good;
      for (std::uint32_t c = 0; c <= random.below(3); ++c)
        bytes[random.below(
            static_cast<std::uint32_t>(random.below(2) ? std::min<std::size_t>(bytes.size(), 700) : bytes.size()))] =
            static_cast<char>(random.bits());
      try {
        parse_surface(bytes, "m");
      } catch (const InputError& e) {
        REQUIRE(std::string(e.what()).find('\n') == std::string::npos);
      }
    }
}
