// Pieces as .glb files, without the arrays that make_chunks() provides.
#include <catch2/catch.hpp>
#include <cstring>
#include <nlohmann/json.hpp>
#include <sstream>

#include "kerf/error.h"
#include "kerf/export.h"

using namespace geo;

namespace {

std::string glb_of(const Chunk& chunk) {
  std::ostringstream out;
  write_glb(out, {chunk}, {}, {"node", {"only"}, 1});
  return out.str();
}

// The JSON of a .glb file: after its header of 12 bytes and a chunk header of 8.
nlohmann::json json_of(const std::string& glb) {
  std::uint32_t length = 0;
  REQUIRE(glb.size() > 20);
  std::memcpy(&length, glb.data() + 12, 4);
  return nlohmann::json::parse(glb.substr(20, length));
}

}  // namespace

TEST_CASE("a chunk of bare triangles is one primitive of the group skin", "[glb]") {
  const TriangleMesh ball = make_sphere(2);
  const auto json = json_of(glb_of({ball, signed_volume(ball), Vec3::Zero()}));
  REQUIRE(json["meshes"][0]["primitives"].size() == 1);
  const auto& primitive = json["meshes"][0]["primitives"][0];
  CHECK(json["accessors"][primitive["indices"].get<std::size_t>()]["count"] == 3 * ball.triangles.size());
  CHECK(json["materials"][primitive["material"].get<std::size_t>()]["name"] == "skin");
  CHECK(primitive["attributes"].contains("TEXCOORD_0"));
}

TEST_CASE("a chunk without triangles is refused", "[glb]") { CHECK_THROWS_AS(glb_of({}), InputError); }

TEST_CASE("a block is a rigid body with exact mass and inertia, in every format", "[glb]") {
  TriangleMesh block = make_block({1, 2, 3}, 5);
  const Chunk chunk{block, signed_volume(block), Vec3(0.5, 1, 1.5)};
  ChunkLabels labels{.kind = "node", .names = piece_names(1)};
  labels.density = 2;
  for (const auto physics : {GlbPhysics::omi, GlbPhysics::khr}) {
    std::ostringstream out;
    write_glb(out, {chunk}, {}, labels, {.hull_corners = 64, .physics = physics, .names = HullNames::plain});
    const auto json = json_of(out.str());
    const std::string name = physics == GlbPhysics::omi ? "OMI_physics_body" : "KHR_physics_rigid_bodies";
    CHECK(json["extensionsUsed"][0] == name);
    const auto& hull = json["nodes"][0];
    const auto& node = json["nodes"][1];
    CHECK(node["name"] == "piece_000");
    CHECK_FALSE(hull.contains("mesh"));  // a shape that nothing draws
    CHECK(hull["extensions"][name].contains("collider"));
    const auto& motion = node["extensions"][name]["motion"];
    CHECK(motion["mass"].get<double>() == Approx(12));
    const auto inertia = motion["inertiaDiagonal"].get<std::vector<double>>();  // m (b² + c²) / 12, ascending
    CHECK(inertia[0] == Approx(5));
    CHECK(inertia[1] == Approx(10));
    CHECK(inertia[2] == Approx(13));
  }
  std::ostringstream out;
  write_usd_pieces(out, {chunk}, {}, labels);
  CHECK(out.str().find("float physics:mass = 12\n") != std::string::npos);
}

TEST_CASE("names of hulls are those of the engine", "[glb]") {
  const TriangleMesh ball = make_sphere(2);
  for (const auto& [names, name] :
       {std::pair(HullNames::plain, "piece_000_hull"), std::pair(HullNames::unreal, "UCX_piece_000"),
        std::pair(HullNames::godot, "piece_000_hull-convcolonly")}) {
    std::ostringstream out;
    write_glb(out, {{ball, signed_volume(ball), Vec3::Zero()}}, {}, {.kind = "node", .names = piece_names(1)},
              {.hull_corners = 16, .names = names});
    CHECK(json_of(out.str())["nodes"][0]["name"] == name);
  }
}
