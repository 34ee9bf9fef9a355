// Units of length from reading to writing, and offsets of models that are far from the origin.
#include <catch2/catch.hpp>
#include <cstring>
#include <nlohmann/json.hpp>
#include <sstream>

#include "io/samples.h"
#include "kerf/check.h"
#include "kerf/error.h"
#include "kerf/export.h"
#include "kerf/pieces.h"

using namespace geo;

namespace {

nlohmann::json json_of(const std::string& glb) {
  std::uint32_t length = 0;
  REQUIRE(glb.size() > 20);
  std::memcpy(&length, glb.data() + 12, 4);
  return nlohmann::json::parse(glb.substr(20, length));
}

// Two halves of a block of edges 40, 20 and 20, its lowest corner at `at`, with the bond between
// them.
PieceSet halves(const Vec3& at, double unit) {
  TriangleMesh block = make_block({40, 20, 20}, 50);
  for (Vec3& p : block.vertices) p += at;
  block.unit = unit;
  Complex complex = Complex::from_skin(block);
  TriangleMesh sheet;
  sheet.vertices = {at + Vec3(20, -50, -50), at + Vec3(20, 90, -50), at + Vec3(20, -50, 90)};
  sheet.triangles = {{0, 1, 2}};
  insert_sheet(complex, sheet, 1, {});
  const Pieces found = find_pieces(complex);
  PieceSet set{
      make_chunks(complex, found, block, 0.25), find_bonds(complex, found), {"node", piece_names(found.count), 2e6}};
  set.labels.density = 2500;
  return set;
}

std::string glb_of(const PieceSet& set, GlbPhysics physics = GlbPhysics::khr, bool z_up = false) {
  return bytes_of([&](auto& out) {
    write_glb(out, set.chunks, set.bonds, set.labels,
              {.hull_corners = 32, .z_up = z_up, .physics = physics, .names = HullNames::plain});
  });
}

std::string usd_of(const PieceSet& set) {
  return bytes_of([&](auto& out) { write_usd_pieces(out, set.chunks, set.bonds, set.labels); });
}

double number_after(const std::string& text, const std::string& key) {
  const auto at = text.find(key);
  REQUIRE(at != text.npos);
  return std::stod(text.substr(at + key.size()));
}

const nlohmann::json& piece_in(const nlohmann::json& json) {
  for (const auto& node : json["nodes"])
    if (node["name"] == "piece_000") return node;
  FAIL("no piece_000");
  return json;
}

}  // namespace

TEST_CASE("names of units of length", "[units]") {
  CHECK(length_unit("m") == 1.0);
  CHECK(length_unit("cm") == 0.01);
  CHECK(length_unit("mm") == 0.001);
  CHECK(length_unit("millimeter") == 0.001);
  CHECK(length_unit("in") == 0.0254);
  CHECK(length_unit("feet") == 0.3048);
  CHECK_FALSE(length_unit(""));
  CHECK_FALSE(length_unit("parsec"));
  std::istringstream names(length_unit_names());
  for (std::string name; std::getline(names, name, ',');) CHECK(length_unit(name.substr(name.find_first_not_of(' '))));
}

TEST_CASE("a .ply keeps the unit, and a .glb is in metres", "[units]") {
  TriangleMesh ball = make_sphere(2);
  CHECK(parse_surface(bytes_of([&](auto& out) { write_ply(out, ball); }), "a.ply").mesh.unit == 0);
  ball.unit = 0.0254;
  const SurfaceFile file = parse_surface(bytes_of([&](auto& out) { write_ply(out, ball); }), "a.ply");
  CHECK(file.mesh.unit == 0.0254);
  CHECK(file.notes.empty());
  CHECK_THROWS_WITH(parse_surface("ply\nformat ascii 1.0\ncomment kerf_unit -1\nelement vertex 0\nproperty float x\n"
                                  "property float y\nproperty float z\nelement face 0\nproperty list uchar int "
                                  "vertex_indices\nend_header\n",
                                  "a.ply"),
                    Catch::Contains("kerf_unit"));
  const TriangleMesh metres = parse_surface(glb_of(halves({0, 0, 0}, 0.001)), "a.glb").mesh;
  CHECK(metres.unit == 1);
  CHECK(bounding_box(metres).hi.isApprox(Vec3(0.04, 0.02, 0.02), 1e-6));
  CHECK(bounding_box(parse_surface(glb_of(halves({0, 0, 0}, 0)), "a.glb").mesh).hi.isApprox(Vec3(40, 20, 20), 1e-6));
}

TEST_CASE("bodies of a part in millimetres have the mass of the part, in a .glb and as USD", "[units]") {
  for (const double unit : {0.0, 1.0, 0.001, 0.0254}) {
    INFO(unit);
    const double u = unit > 0 ? unit : 1;
    const PieceSet set = halves({0, 0, 0}, unit);
    REQUIRE(set.chunks.size() == 2);
    const double mass = 2500 * 8000 * u * u * u;  // half of 40 · 20 · 20
    // The section modulus of a square of edge a about its diagonal is a³ / (6 √2).
    const double force = 2e6 * 400 * u * u, torque = 2e6 * 8000 / (6 * std::sqrt(2.0)) * u * u * u;
    const auto json = json_of(glb_of(set));
    const auto& motion = piece_in(json)["extensions"]["KHR_physics_rigid_bodies"]["motion"];
    CHECK(motion["mass"].get<double>() == Approx(mass));
    CHECK(motion["inertiaDiagonal"][0].get<double>() == Approx(mass * 2 * 400 * u * u / 12));
    const auto& bond = json["scenes"][0]["extras"]["bonds"][0];
    CHECK(bond["area"].get<double>() == Approx(400 * u * u));
    CHECK(bond["strength"].get<double>() == Approx(force));
    CHECK(bond["torque"].get<double>() == Approx(torque));
    CHECK(json["scenes"][0]["extras"]["pieces"][0]["volume"].get<double>() == Approx(8000 * u * u * u));
    // A folder's JSON keeps lengths of the model, and says the unit.
    const auto plain =
        nlohmann::json::parse(bytes_of([&](auto& out) { write_bonds(out, set.chunks, set.bonds, set.labels); }));
    CHECK(plain["bonds"][0]["area"].get<double>() == Approx(400));
    CHECK(plain["bonds"][0]["strength"].get<double>() == Approx(force));
    CHECK(plain["bonds"][0]["torque"].get<double>() == Approx(torque));
    CHECK(plain.value("unit", 1.0) == u);
    // USD measures force in kg · unit / s², and moments of inertia in kg · unit².
    const std::string usd = usd_of(set);
    CHECK(number_after(usd, "metersPerUnit = ") == u);
    CHECK(number_after(usd, "physics:mass = ") == Approx(mass).epsilon(1e-6));
    CHECK(number_after(usd, "physics:diagonalInertia = (") == Approx(mass * 2 * 400 / 12).epsilon(1e-6));
    CHECK(number_after(usd, "physics:breakForce = ") == Approx(force / u).epsilon(1e-6));
    CHECK(number_after(usd, "physics:breakTorque = ") == Approx(torque / (u * u)).epsilon(1e-6));
  }
}

TEST_CASE("an offset is given where single precision would part pieces, and only there", "[units]") {
  CHECK(single_precision_offset({{0, 0, 0}, {1, 1, 1}}).isZero(0));
  CHECK(single_precision_offset({{50, 0, 0}, {51, 1, 1}}).isZero(0));
  CHECK(single_precision_offset({}).isZero(0));
  const Box3 far{{691000.3, 5.4e6 + 0.7, 500.2}, {691002.3, 5.4e6 + 2.7, 502.2}};
  const Vec3 offset = single_precision_offset(far);
  CHECK((offset - far.center()).cwiseAbs().maxCoeff() <= 0.25);  // half an ulp of 5.4e6 in single precision
  for (int k = 0; k < 3; ++k) CHECK(double(float(offset[k])) == offset[k]);
}

TEST_CASE("pieces in UTM coordinates stay together in single precision", "[units]") {
  const Vec3 at(691234.56789, 5401234.56789, 512.3456789);
  for (const bool z_up : {false, true}) {
    const PieceSet near = halves({0, 0, 0}, 1), set = halves(at, 1);
    const auto json = json_of(glb_of(set, GlbPhysics::none, z_up)),
               without = json_of(glb_of(near, GlbPhysics::none, z_up));
    const auto& root = json["nodes"].back();
    CHECK(root["name"] == "pieces");
    REQUIRE(root.contains("translation"));
    CHECK_FALSE(without["nodes"].back().contains("translation"));
    // Places of the pieces below the root are small: as floats they lose less than a micrometre.
    for (const auto& node : json["nodes"]) {
      if (node["name"] == "pieces" || !node.contains("translation")) continue;
      for (const auto& x : node["translation"]) {
        CHECK(std::abs(x.get<double>()) < 60);
        CHECK(std::abs(x.get<double>() - double(float(x.get<double>()))) < 4e-6);
      }
    }
    // Read back in double precision, all is where it was.
    const Box3 box = bounding_box(parse_surface(glb_of(set, GlbPhysics::none, z_up), "a.glb").mesh);
    const Vec3 lo = z_up ? Vec3(at.x(), at.z(), -at.y() - 20) : at;
    CHECK((box.lo - lo).cwiseAbs().maxCoeff() < 1e-5);
  }
  const std::string usd = usd_of(halves(at, 1));
  const auto first = usd.find("xformOp:translate = ("), second = usd.find("xformOp:translate = (", first + 1);
  CHECK(number_after(usd.substr(first), "(") == Approx(at.x() + 20).margin(0.1));
  CHECK(std::abs(number_after(usd.substr(second), "(")) < 20);
  CHECK(usd_of(halves({0, 0, 0}, 1)).find("def Xform \"pieces\"\n{\n    def Mesh") != usd.npos);
}

TEST_CASE("nodes of a frame in UTM coordinates keep their places", "[units]") {
  for (const bool far : {false, true}) {
    const Vec3 at = far ? Vec3(691234.56789, 5401234.56789, 512.3) : Vec3(0.1, 0.2, 0.3);
    FrameNodes frame;
    for (int i = 0; i < 3; ++i) {
      frame.nodes.position.push_back(at + Vec3(0.01 * i, 0, 0));
      frame.nodes.radius.push_back(1);
      frame.nodes.spacing.push_back(0.5);
      frame.nodes.volume.push_back(0.125);
      frame.stress.push_back(i);
    }
    const std::string bytes = bytes_of([&](auto& out) { write_frame_nodes(out, frame); });
    const FrameNodes again = parse_frame_nodes(bytes, "nodes.ply");
    REQUIRE(again.nodes.size() == 3);
    for (std::size_t i = 0; i < 3; ++i) CHECK((again.nodes.position[i] - frame.nodes.position[i]).norm() < 1e-7);
    CHECK(again.stress == frame.stress);
    CHECK((bytes.find("property double x") != bytes.npos) == far);
  }
}

TEST_CASE("frames of a run in UTM coordinates keep their shape in a .usda", "[units]") {
  const Vec3 at(691234.5, 5401234.5, 512.25);
  for (const bool far : {false, true}) {
    UsdRun run;
    run.frames = 2;
    run.surface = [&](std::size_t i) {
      TriangleMesh ball = make_sphere(2);
      for (Vec3& p : ball.vertices) p += (far ? at : Vec3(0, 0, 0)) + Vec3(0, 0, double(i));
      return ball;
    };
    const std::string usd = bytes_of([&](auto& out) { write_usda(out, run); });
    CHECK((usd.find("xformOp:translate") != usd.npos) == far);
    const auto points = usd.find("point3f[] points.timeSamples");
    const auto row = usd.find("[(", points);
    CHECK(std::abs(number_after(usd.substr(row), "[(")) <= 1.5);
  }
}

TEST_CASE("COLLADA and AMF keep the coordinates of the file, and its unit", "[units]") {
  const std::string points = "0 0 0 1 0 0 0 2 0 0 0 3", corners = "0 2 1 0 1 3 0 3 2 1 2 3";
  for (const std::string up : {"X_UP", "Y_UP", "Z_UP"})
    for (const auto& [text, unit] : {std::pair<std::string, double>{"<unit name=\"inch\" meter=\"0.0254\"/>", 0.0254},
                                     {"<unit meter='0.01' name='centimeter'/>", 0.01},
                                     {"", 1}}) {
      INFO(up << text);
      const std::string dae =
          "<?xml version=\"1.0\"?><COLLADA xmlns=\"http://www.collada.org/2005/11/COLLADASchema\" "
          "version=\"1.4.1\"><asset>" +
          text + "<up_axis>" + up +
          "</up_axis></asset><library_geometries><geometry id=\"g\"><mesh><source id=\"p\"><float_array id=\"pa\" "
          "count=\"12\">" +
          points +
          "</float_array><technique_common><accessor source=\"#pa\" count=\"4\" stride=\"3\"><param name=\"X\" "
          "type=\"float\"/><param name=\"Y\" type=\"float\"/><param name=\"Z\" type=\"float\"/></accessor>"
          "</technique_common></source><vertices id=\"v\"><input semantic=\"POSITION\" source=\"#p\"/></vertices>"
          "<triangles count=\"4\"><input semantic=\"VERTEX\" source=\"#v\" offset=\"0\"/><p>" +
          corners +
          "</p></triangles></mesh></geometry></library_geometries><library_visual_scenes><visual_scene id=\"s\"><node "
          "id=\"n\"><translate>10 0 0</translate><instance_geometry url=\"#g\"/></node></visual_scene>"
          "</library_visual_scenes><scene><instance_visual_scene url=\"#s\"/></scene></COLLADA>";
      const SurfaceFile file = parse_surface(dae, "a.dae");
      CHECK(bounding_box(file.mesh).lo == Vec3(10, 0, 0));
      CHECK(bounding_box(file.mesh).hi == Vec3(11, 2, 3));
      CHECK(file.mesh.unit == unit);
      CHECK(file.notes.empty());
    }
  for (const auto& [text, unit] : {std::pair<std::string, double>{" unit=\"inch\"", 0.0254},
                                   {" version=\"1.1\" unit='millimeter'", 0.001},
                                   {"", 0.001}}) {
    std::string amf = "<?xml version=\"1.0\"?><amf" + text + "><object id=\"0\"><mesh><vertices>";
    for (const char* p : {"<x>0</x><y>0</y><z>0</z>", "<x>1</x><y>0</y><z>0</z>", "<x>0</x><y>2</y><z>0</z>",
                          "<x>0</x><y>0</y><z>3</z>"})
      amf += "<vertex><coordinates>" + std::string(p) + "</coordinates></vertex>";
    amf += "</vertices><volume>";
    for (const char* t : {"<v1>0</v1><v2>2</v2><v3>1</v3>", "<v1>0</v1><v2>1</v2><v3>3</v3>",
                          "<v1>0</v1><v2>3</v2><v3>2</v3>", "<v1>1</v1><v2>2</v2><v3>3</v3>"})
      amf += "<triangle>" + std::string(t) + "</triangle>";
    const SurfaceFile file = parse_surface(amf + "</volume></mesh></object></amf>", "a.amf");
    CHECK(bounding_box(file.mesh).hi == Vec3(1, 2, 3));
    CHECK(file.mesh.unit == unit);
  }
}

TEST_CASE("FBX and 3MF keep the coordinates of the file, and its unit", "[units]") {
  const auto read = [](const std::string& name) { return read_surface(KERF_IO_CASES "/other/" + name).mesh; };
  // A box of 1 by 2 by 3 m at x = 10 m, with z up, in centimetres or in metres.
  const TriangleMesh centimetres = read("zup.fbx"), metres = read("unit.fbx");
  CHECK((bounding_box(centimetres).lo - Vec3(1000, 0, 0)).norm() < 1e-3);
  CHECK((bounding_box(centimetres).hi - Vec3(1100, 200, 300)).norm() < 1e-3);
  CHECK(centimetres.unit == Approx(0.01));
  CHECK((bounding_box(metres).hi - bounding_box(metres).lo - Vec3(1, 3, 2)).norm() < 1e-5);  // y is up
  CHECK(metres.unit == Approx(1));
  // A cube of 1 m whose bone has been moved up by 5 m since the bind pose.
  CHECK(bounding_box(read("skin.fbx")).lo.y() == Approx(500));
  CHECK(signed_volume(read("skin.fbx")) == Approx(1e6));
  // Items of the build, and components of objects, each with a transform. Without a unit:
  // millimetres.
  const TriangleMesh inches = read("in.3mf"), parts = read("comp.3mf");
  CHECK(inches.unit == 0.0254);
  CHECK(bounding_box(inches).hi == Vec3(11, 2, 3));
  CHECK(signed_volume(inches) == Approx(2));
  CHECK(parts.unit == 0.001);
  CHECK(bounding_box(parts).hi == Vec3(11, 22, 3));
  CHECK(signed_volume(parts) == Approx(4));
}
