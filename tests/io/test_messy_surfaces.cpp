// Surfaces as other programs write them: separate seams, polygons that are not convex, other
// formats.
#include <catch2/catch.hpp>
#include <sstream>

#include "kerf/check.h"
#include "kerf/error.h"
#include "kerf/files.h"
#include "kerf/mesh.h"

using namespace geo;

TEST_CASE("vertices that a file has apart at seams are one, and keep their texture coordinates") {
  // Each triangle has vertices of its own.
  std::ostringstream ply;
  const TriangleMesh ball = make_sphere(4);
  ply << "ply\nformat ascii 1.0\nelement vertex " << 3 * ball.triangles.size()
      << "\nproperty double x\nproperty double y\nproperty double z\nproperty float u\nproperty float v\nelement face "
      << ball.triangles.size() << "\nproperty list uchar int vertex_indices\nend_header\n";
  ply.precision(17);
  for (std::size_t t = 0; t < ball.triangles.size(); ++t)
    for (int k = 0; k < 3; ++k) ply << ball.vertices[ball.triangles[t][k]].transpose() << ' ' << t << ' ' << k << '\n';
  for (std::size_t t = 0; t < ball.triangles.size(); ++t)
    ply << "3 " << 3 * t << ' ' << 3 * t + 1 << ' ' << 3 * t + 2 << '\n';
  const TriangleMesh mesh = parse_surface(ply.str(), "soup.ply").mesh;
  CHECK(mesh.vertices.size() == ball.vertices.size());
  CHECK(check_surface(mesh, SelfIntersections::find).first_problem.empty());
  for (std::size_t t = 0; t < ball.triangles.size(); ++t)
    for (int k = 0; k < 3; ++k) {
      CHECK(mesh.vertices[mesh.triangles[t][k]] == ball.vertices[ball.triangles[t][k]]);
      CHECK(mesh.attributes.uv[t][k] == Vec2(double(t), k));
    }
}

TEST_CASE("what is closed and touches stays apart") {
  const std::string box = "f 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n", other = "f 5 6 7\nf 5 8 6\nf 6 8 7\nf 5 7 8\n";
  const TriangleMesh mesh =
      parse_surface("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nv 0 0 0\nv -1 0 0\nv 0 1 0\nv 0 0 1\n" + box + other,
                    "two.obj")
          .mesh;
  CHECK(mesh.vertices.size() == 8);
}

TEST_CASE("a polygon that is not convex becomes triangles that do not fold over") {
  // Prisms over an L whose first corner is next to the concave one, over a comb, and over a square
  // with a vertex inside a side.
  const std::vector<std::vector<std::array<double, 2>>> outlines{
      {{1, 2}, {0, 2}, {0, 0}, {2, 0}, {2, 1}, {1, 1}},
      {{0, 0}, {5, 0}, {5, 3}, {4, 1}, {3, 3}, {2.5, 1}, {2, 3}, {1, 1}, {0, 3}},
      {{0, 0}, {1, 0}, {2, 0}, {2, 2}, {0, 2}}};
  for (const auto& outline : outlines) {
    const std::size_t n = outline.size();
    std::ostringstream obj;
    double twice = 0;
    for (const double z : {0.0, 1.0})
      for (const auto& [x, y] : outline) obj << "v " << x << ' ' << y << ' ' << z << '\n';
    for (std::size_t i = 0; i < n; ++i)
      twice += outline[i][0] * outline[(i + 1) % n][1] - outline[i][1] * outline[(i + 1) % n][0];
    obj << "f";
    for (std::size_t i = n; i > 0; --i) obj << ' ' << i;
    obj << "\nf";
    for (std::size_t i = 1; i <= n; ++i) obj << ' ' << n + i;
    for (std::size_t i = 1; i <= n; ++i) obj << "\nf " << i << ' ' << i % n + 1 << ' ' << n + i % n + 1 << ' ' << n + i;
    const TriangleMesh mesh = parse_surface(obj.str() + "\n", "prism.obj").mesh;
    CHECK(mesh.triangles.size() == 4 * n - 4);
    const SurfaceReport report = check_surface(mesh, SelfIntersections::find);
    CHECK(report.first_problem == "");
    CHECK(signed_volume(mesh) == Approx(twice / 2));
  }
}

TEST_CASE("texture coordinates follow the triangles of a polygon that is not convex") {
  const TriangleMesh mesh = parse_surface(
                                "v 1 2 0\nv 0 2 0\nv 0 0 0\nv 2 0 0\nv 2 1 0\nv 1 1 0\nvt 1 2\nvt 0 2\nvt 0 0\nvt 2 "
                                "0\nvt 2 1\nvt 1 1\nf 1/1 2/2 3/3 4/4 5/5 6/6\n",
                                "l.obj")
                                .mesh;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (int k = 0; k < 3; ++k) CHECK(mesh.attributes.uv[t][k] == Vec2(mesh.vertices[mesh.triangles[t][k]].head<2>()));
  CHECK(area(mesh) == Approx(3));
}

TEST_CASE("OBJ faces may name rows of later lines, and lines may be continued") {
  const TriangleMesh mesh = parse_surface(
                                "f 1/1/1 2/2/1 \\\n3/3/1\nv 0 0 0\nv 1 0 \\\r\n  0\nv 0 1 0\n"
                                "vt 0 0\nvt .5 0\nvt 0 .25\nvn 0 0 1\nf -3/-3/-1 -2/-2/-1 -1/-1/-1 \\",
                                "a.obj")
                                .mesh;
  REQUIRE(mesh.vertices.size() == 3);
  REQUIRE(mesh.triangles == std::vector<Triangle>{{0, 1, 2}, {0, 1, 2}});
  for (int t = 0; t < 2; ++t) {
    CHECK(mesh.attributes.uv[t][1] == Vec2(.5, 0));
    CHECK(mesh.attributes.uv[t][2] == Vec2(0, .25));
    CHECK(mesh.attributes.normal[t][0] == Vec3(0, 0, 1));
  }
  CHECK_THROWS_WITH(parse_surface("v 0 0 0\nv 1 0 0\nv 0 1 0\n\nf 1 2 4\n", "a.obj"),
                    "a.obj:5: a face names vertex 4, but there are 3");
  CHECK_THROWS_WITH(parse_surface("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1/1 2/1 3/1\n", "a.obj"),
                    "a.obj:4: a face names texture coordinate 1, but there are 0");
  CHECK_THROWS_WITH(parse_surface("v 0 0 0\nv 1 0 0\nf -1 -2 -3\nv 0 1 0\n", "a.obj"),
                    Catch::StartsWith("a.obj:3: a face names vertex -3"));
}

TEST_CASE("numbers that are not finite are refused in coordinates alone") {
  const std::string header = "property float x\nproperty float y\nproperty float z\n";
  const std::string faces = "element face 1\nproperty list uchar int vertex_indices\nend_header\n";
  const auto ply = [&](const std::string& more, const std::string& rows) {
    return "ply\nformat ascii 1.0\nelement vertex 3\n" + header + more + faces + rows + "3 0 1 2\n";
  };
  const std::string heat = "property float heat\n",
                    normal = "property float nx\nproperty float ny\nproperty float nz\n";
  CHECK(parse_surface(ply(heat, "0 0 0 nan\n1 0 0 -inf\n0 1 0 1\n"), "a.ply").mesh.triangles.size() == 1);
  const TriangleMesh mesh = parse_surface(ply(normal, "0 0 0 nan 0 0\n1 0 0 0 -1 0\n0 1 0 0 inf 0\n"), "a.ply").mesh;
  CHECK(mesh.attributes.normal[0][0] == Vec3(0, 0, 1));  // the face's
  CHECK(mesh.attributes.normal[0][1] == Vec3(0, -1, 0));
  CHECK(mesh.attributes.normal[0][2] == Vec3(0, 0, 1));
  CHECK_THROWS_WITH(parse_surface(ply("", "0 0 0\n1 nan 0\n0 1 0\n"), "a.ply"),
                    Catch::StartsWith("a.ply: vertex 1 has a coordinate that is not a finite number"));
  const TriangleMesh obj =
      parse_surface("v 0 0 0 nan 1 1\nv 1 0 0 0 1 0\nv 0 1 0 1 1 1\nvt nan 0\nf 1/1 2/1 3/1\n", "a.obj").mesh;
  CHECK(obj.attributes.color[0][0] == Color::Ones());
  CHECK(obj.attributes.color[0][1] == Color(0, 1, 0, 1));
  CHECK(obj.attributes.uv[0][2] == Vec2::Zero());
}

TEST_CASE("text is read with more numbers than named, other ends of lines, a byte order mark, and no keyword") {
  const std::string ply =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
      "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0 7\n1 0 0 8 9\n0 1 0\n3 0 1 2 5\n";
  const std::string rows = "3 1 0\n0 0 0\n1 0 0\n\n 0 1 0\n\n3 0 1 2\n", obj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
  const auto old = [](std::string text) {
    std::replace(text.begin(), text.end(), '\n', '\r');
    return text;
  };
  for (const std::string& bytes : {ply, rows, "\n\n OFF\n" + rows, old("OFF\n" + rows), "\xef\xbb\xbfOFF\n" + rows, obj,
                                   old(obj), "\xef\xbb\xbf" + obj}) {
    const TriangleMesh mesh = parse_surface(bytes, "a").mesh;
    CHECK(mesh.vertices == std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
    CHECK(mesh.triangles == std::vector<Triangle>{{0, 1, 2}});
  }
}

TEST_CASE("text may be UTF-16 of either byte order, with characters of any plane in names") {
  const std::string text =
      "# \xc3\xa9 \xe2\x82\xac \xf0\x9f\x8e\x83\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nusemtl "
      "\xc3\xa9\xf0\x9f\x8e\x83\nf 1 3 2\nf 1 2 4\n"
      "f 2 3 4\nf 1 4 3\n";
  const std::u16string units =
      u"\ufeff# \u00e9 \u20ac \U0001f383\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nusemtl \u00e9\U0001f383\nf 1 3 2\nf 1 2 "
      u"4\n"
      u"f 2 3 4\nf 1 4 3\n";
  const TriangleMesh plain = parse_surface(text, "a.obj").mesh;
  for (const bool big : {false, true}) {
    std::string bytes;
    for (const char16_t unit : units)
      for (const int k : {0, 1}) bytes += static_cast<char>(unit >> ((k == 0) == big ? 8 : 0));
    const TriangleMesh mesh = parse_surface(bytes, "b.obj").mesh;
    CHECK(mesh.vertices == plain.vertices);
    CHECK(mesh.triangles == plain.triangles);
    CHECK(mesh.attributes.group_names == plain.attributes.group_names);
    CHECK_THROWS_AS(parse_surface(bytes.substr(0, 2), "c.obj"), InputError);
    CHECK_THROWS_AS(parse_surface(bytes.substr(0, 41), "d.obj"), InputError);
  }
}

TEST_CASE("a PLY header may have a comment without its keyword before the first element") {
  const std::string rows =
      "property float x\nproperty float y\nproperty float z\nelement face 4\nproperty list uchar int vertex_index\n";
  const std::string data = "end_header\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 0 3 2\n";
  const std::string created = "Created by Blender3D 247 - www.blender.org\n";
  const auto parse = [&](const std::string& first, const std::string& second) {
    return parse_surface("ply\nformat ascii 1.0\n" + first + "element vertex 4\n" + second + rows + data, "a.ply").mesh;
  };
  CHECK(parse(created, "").vertices == parse("", "").vertices);
  CHECK_THROWS_WITH(parse("", created), Catch::Contains("'Created' is not expected in a PLY header"));
}
