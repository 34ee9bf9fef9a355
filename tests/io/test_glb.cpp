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
