// Options of scores in C: a density by vertices, chips, detail at edges, and what is refused.
#include <catch2/catch.hpp>
#include <string>
#include <vector>

#include "kerf.h"

namespace {

kerf_mesh block() {
  const double size[3] = {1, 1, 1};
  kerf_mesh mesh = nullptr;
  REQUIRE(kerf_shape_block(size, 0.1, &mesh) == KERF_OK);
  return mesh;
}

// A value for each vertex: one above the middle, another below.
std::vector<double> halves(kerf_mesh mesh, double above, double below) {
  kerf_mesh_arrays arrays;
  REQUIRE(kerf_mesh_get(mesh, &arrays) == KERF_OK);
  std::vector<double> values;
  for (std::size_t i = 2; i < arrays.vertices_length; i += 3)
    values.push_back(arrays.vertices[i] > 0.5 ? above : below);
  return values;
}

std::size_t count_of(kerf_pieces pieces) {
  std::size_t count = 0;
  REQUIRE(kerf_pieces_count(pieces, &count) == KERF_OK);
  return count;
}

// How many of 24 pieces reach above the middle. Where cells are few below, those above reach down.
int above_middle(kerf_mesh mesh, const std::vector<double>& density) {
  kerf_score_options options;
  REQUIRE(kerf_score_defaults(&options) == KERF_OK);
  options.pieces = 24;
  options.seed = 3;
  options.density = density.data();
  options.density_length = density.size();
  kerf_pieces pieces = nullptr;
  REQUIRE(kerf_fracture(mesh, &options, nullptr, nullptr, &pieces) == KERF_OK);
  REQUIRE(count_of(pieces) == 24);
  int above = 0;
  for (std::size_t i = 0; i < 24; ++i) {
    kerf_mesh piece = nullptr;
    kerf_measures measures;
    REQUIRE(kerf_pieces_mesh(pieces, i, &piece) == KERF_OK);
    REQUIRE(kerf_mesh_measures(piece, &measures) == KERF_OK);
    above += measures.high[2] > 0.6;
    kerf_free(piece);
  }
  kerf_free(pieces);
  return above;
}

}  // namespace

TEST_CASE("cells are many where the density of vertices is high", "[c]") {
  kerf_mesh mesh = block();
  CHECK(above_middle(mesh, halves(mesh, 1, 0.05)) > 0.8 * 24);
  CHECK(above_middle(mesh, halves(mesh, 0.05, 1)) < 0.7 * 24);
  kerf_free(mesh);
}

TEST_CASE("chips are pieces beside those wanted, and edges have finer walls", "[c]") {
  kerf_mesh mesh = block();
  kerf_score_options options;
  REQUIRE(kerf_score_defaults(&options) == KERF_OK);
  CHECK(options.chips == 0);
  CHECK(options.edge_detail == 0);
  options.pieces = 5;
  options.seed = 3;
  options.chips = 6;
  options.chip_size = 0.2;
  options.edge_detail = 0.004;
  kerf_pieces pieces = nullptr;
  REQUIRE(kerf_fracture(mesh, &options, nullptr, nullptr, &pieces) == KERF_OK);
  CHECK(count_of(pieces) == 11);
  kerf_free(pieces);

  pieces = nullptr;
  const double few[2] = {1, 1};
  options.density = few;
  options.density_length = 2;
  CHECK(kerf_fracture(mesh, &options, nullptr, nullptr, &pieces) == KERF_INPUT);
  options.pattern = KERF_PLANES;
  CHECK(kerf_fracture(mesh, &options, nullptr, nullptr, &pieces) == KERF_ARGUMENT);
  options.density = nullptr;
  options.chip_size = 0;
  CHECK(kerf_fracture(mesh, &options, nullptr, nullptr, &pieces) == KERF_ARGUMENT);
  CHECK(pieces == nullptr);
  kerf_free(mesh);
}

TEST_CASE("the black areas of an image are cut out", "[c]") {
  kerf_mesh mesh = block();
  constexpr int n = 32;
  std::vector<std::uint8_t> pixels(n * n, 255);  // white, with a black square of half the width
  for (int y = 8; y < 24; ++y)
    for (int x = 8; x < 24; ++x) pixels[std::size_t(n * y + x)] = 0;
  kerf_score_options options;
  REQUIRE(kerf_score_defaults(&options) == KERF_OK);
  CHECK(options.image == nullptr);
  options.pattern = KERF_CURVES;
  kerf_pieces pieces = nullptr;
  CHECK(kerf_fracture(mesh, &options, nullptr, nullptr, &pieces) == KERF_ARGUMENT);  // without an image
  options.image = pixels.data();
  options.image_width = options.image_height = n;
  options.has_axis = 1;
  options.axis[0] = options.axis[1] = 0;
  options.axis[2] = 1;
  options.pieces = 2;
  REQUIRE(kerf_fracture(mesh, &options, nullptr, nullptr, &pieces) == KERF_OK);
  REQUIRE(count_of(pieces) == 2);
  kerf_mesh piece = nullptr;
  kerf_measures measures;
  REQUIRE(kerf_pieces_mesh(pieces, 1, &piece) == KERF_OK);
  REQUIRE(kerf_mesh_measures(piece, &measures) == KERF_OK);
  CHECK(measures.volume > 15.0 * 15 / (n * n));  // outlines are within half a pixel
  CHECK(measures.volume < 17.0 * 17 / (n * n));
  kerf_free(piece);
  kerf_free(pieces);
  options.pattern = KERF_VORONOI;
  CHECK(kerf_fracture(mesh, &options, nullptr, nullptr, &pieces) == KERF_ARGUMENT);
  kerf_free(mesh);
}
