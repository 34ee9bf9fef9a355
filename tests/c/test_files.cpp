// Files of meshes in C: an .stl of a solid is a solid as it is written.
#include <catch2/catch.hpp>
#include <string>
#include <vector>

#include "kerf.h"

namespace {

// Balls that overlap far from the origin, united: triangles cross once they are rounded to floats.
kerf_mesh balls() {
  constexpr double places[5][3] = {
      {0, 0.6, -0.5}, {0.6, -0.3, -0.1}, {0.5, -0.1, 0.1}, {-0.7, 0.4, 0.1}, {-0.2, 0.4, -0.3}};
  constexpr double far = 200;
  kerf_mesh ball = nullptr, many = nullptr, solid = nullptr;
  REQUIRE(kerf_shape_sphere(8, &ball) == KERF_OK);
  kerf_mesh_arrays one{}, all{};
  REQUIRE(kerf_mesh_get(ball, &one) == KERF_OK);
  std::vector<double> vertices;
  std::vector<std::uint32_t> faces;
  for (const auto& place : places) {
    const auto first = static_cast<std::uint32_t>(vertices.size() / 3);
    for (std::size_t i = 0; i < one.vertices_length; ++i)
      vertices.push_back(one.vertices[i] + place[i % 3] + (i % 3 == 0 ? far : 0));
    for (std::size_t i = 0; i < one.faces_length; ++i) faces.push_back(first + one.faces[i]);
  }
  all.vertices = vertices.data();
  all.vertices_length = vertices.size();
  all.faces = faces.data();
  all.faces_length = faces.size();
  REQUIRE(kerf_mesh_create(&all, &many) == KERF_OK);
  REQUIRE(kerf_mesh_repaired(many, 0, 0, &solid) == KERF_OK);
  kerf_free(ball);
  kerf_free(many);
  return solid;
}

std::size_t crossings(kerf_mesh mesh) {
  kerf_report report;
  REQUIRE(kerf_mesh_check(mesh, 1, &report) == KERF_OK);
  return report.self_intersections;
}

}  // namespace

TEST_CASE("a solid is one in its .stl, too", "[c]") {
  kerf_mesh solid = balls(), rounded = nullptr, read = nullptr;
  CHECK(crossings(solid) == 0);
  // As floats are, without the writer.
  kerf_mesh_arrays arrays{};
  REQUIRE(kerf_mesh_get(solid, &arrays) == KERF_OK);
  std::vector<float> floats(arrays.vertices, arrays.vertices + arrays.vertices_length);
  const std::vector<double> vertices(floats.begin(), floats.end());
  kerf_mesh_arrays bare{};
  bare.vertices = vertices.data();
  bare.vertices_length = arrays.vertices_length;
  bare.faces = arrays.faces;
  bare.faces_length = arrays.faces_length;
  REQUIRE(kerf_mesh_create(&bare, &rounded) == KERF_OK);
  CHECK(crossings(rounded) > 0);
  kerf_bytes bytes = nullptr;
  REQUIRE(kerf_mesh_write(solid, "stl", &bytes) == KERF_OK);
  const std::uint8_t* data = nullptr;
  std::size_t length = 0;
  REQUIRE(kerf_bytes_data(bytes, &data, &length) == KERF_OK);
  REQUIRE(kerf_mesh_parse(data, length, "balls.stl", &read) == KERF_OK);
  CHECK(crossings(read) == 0);
  kerf_free(solid);
  kerf_free(rounded);
  kerf_free(read);
  kerf_free(bytes);
}

TEST_CASE("a mesh that is no solid is refused with what mends it", "[c]") {
  const double size[3] = {1, 1, 1};
  kerf_mesh block = nullptr, open = nullptr, mended = nullptr;
  REQUIRE(kerf_shape_block(size, 0.5, &block) == KERF_OK);
  kerf_mesh_arrays arrays{};
  REQUIRE(kerf_mesh_get(block, &arrays) == KERF_OK);
  arrays.faces_length -= 3;
  REQUIRE(kerf_mesh_create(&arrays, &open) == KERF_OK);
  kerf_solid solid = nullptr;
  kerf_complex complex = nullptr;
  const std::string remedy = "or try kerf_mesh_repaired()";
  CHECK(kerf_solid_create(open, &solid) == KERF_INPUT);
  CHECK(std::string(kerf_last_message()).find(remedy) != std::string::npos);
  CHECK(kerf_complex_create(open, &complex) == KERF_INPUT);
  CHECK(std::string(kerf_last_message()).find(remedy) != std::string::npos);
  REQUIRE(kerf_mesh_repaired(open, 0, 0, &mended) == KERF_OK);
  CHECK(kerf_solid_create(mended, &solid) == KERF_OK);
  for (void* handle :
       {static_cast<void*>(block), static_cast<void*>(open), static_cast<void*>(mended), static_cast<void*>(solid)})
    CHECK(kerf_free(handle) == KERF_OK);
}
