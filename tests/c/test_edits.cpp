// Edits of a whole complex: remeshing, roughening, decimation.
#include <catch2/catch.hpp>
#include <cmath>
#include <cstring>

#include "kerf.h"

namespace {

kerf_complex_counts counts(kerf_complex complex) {
  kerf_complex_counts of{};
  REQUIRE(kerf_complex_count(complex, &of) == KERF_OK);
  return of;
}

// The smallest angle of a complex's faces in degrees.
double smallest_angle(kerf_complex complex) {
  kerf_mesh surface = nullptr;
  kerf_mesh_arrays a{};
  REQUIRE(kerf_complex_surface(complex, &surface) == KERF_OK);
  REQUIRE(kerf_mesh_get(surface, &a) == KERF_OK);
  double least = 180;
  for (std::size_t i = 0; i < a.faces_length; ++i) {
    const double* at[3];
    for (std::size_t k = 0; k < 3; ++k) at[k] = a.vertices + 3 * a.faces[i - i % 3 + (i + k) % 3];
    double u2 = 0, v2 = 0, uv = 0;
    for (int k = 0; k < 3; ++k) {
      const double u = at[1][k] - at[0][k], v = at[2][k] - at[0][k];
      u2 += u * u;
      v2 += v * v;
      uv += u * v;
    }
    least = std::min(least, std::acos(uv / std::sqrt(u2 * v2)) * 180 / 3.14159265358979);
  }
  kerf_free(surface);
  return least;
}

double volume_of(kerf_complex complex) {
  kerf_pieces pieces = nullptr;
  std::size_t count = 0;
  double sum = 0;
  REQUIRE(kerf_complex_pieces(complex, &pieces) == KERF_OK);
  kerf_pieces_count(pieces, &count);
  for (std::size_t i = 0; i < count; ++i) {
    kerf_piece piece{};
    kerf_pieces_get(pieces, i, &piece);
    sum += piece.volume;
  }
  kerf_free(pieces);
  return sum;
}

}  // namespace

TEST_CASE("a cut block is remeshed, roughened and decimated: its pieces stay, its fronts end", "[c]") {
  const double size[3] = {1, 1, 1}, point[3] = {0.47, 0.5, 0.5}, normal[3] = {1, 0.3, 0.1};
  const double line[6] = {-0.5, 0.2, -0.1, -0.5, 0.8, -0.1};
  kerf_mesh mesh = nullptr;
  kerf_complex complex = nullptr;
  kerf_front front = nullptr;
  REQUIRE(kerf_shape_block(size, 0.2, &mesh) == KERF_OK);
  REQUIRE(kerf_complex_create(mesh, &complex) == KERF_OK);
  REQUIRE(kerf_complex_cut_plane(complex, point, normal) == KERF_OK);
  REQUIRE(kerf_front_begin(complex, line, 6, 0, &front) == KERF_OK);
  const double before = smallest_angle(complex);

  REQUIRE(kerf_complex_remesh(complex, 15, nullptr, nullptr) == KERF_OK);
  CHECK(smallest_angle(complex) > before);
  CHECK(volume_of(complex) == Approx(1).epsilon(1e-9));
  CHECK(kerf_front_advance(front, line, 6, nullptr) == KERF_INPUT);
  CHECK(std::strstr(kerf_last_message(), "begin another"));
  CHECK(kerf_complex_undo(complex) == KERF_GEOMETRY);

  const auto faces = counts(complex).faces;
  REQUIRE(kerf_complex_roughen(complex, 0.02, 4, 7, nullptr, nullptr) == KERF_OK);
  CHECK(counts(complex).faces > faces);
  CHECK(volume_of(complex) == Approx(1).epsilon(1e-9));

  const auto rough = counts(complex).faces;
  REQUIRE(kerf_complex_decimate(complex, 0.01, 0, nullptr, nullptr) == KERF_OK);
  CHECK(counts(complex).faces < rough);
  CHECK(counts(complex).pieces == 2);
  CHECK(volume_of(complex) == Approx(1).epsilon(0.02));
  kerf_report report{};
  REQUIRE(kerf_complex_check(complex, 1, &report) == KERF_OK);
  CHECK(report.good);

  // A stop leaves all as it was; a crack afterwards can be undone again.
  const auto stop = [](void*, const char*, std::size_t, std::size_t) { return 0; };
  const auto left = counts(complex).faces;
  CHECK(kerf_complex_roughen(complex, 0.02, 4, 7, stop, nullptr) == KERF_STOPPED);
  CHECK(counts(complex).faces == left);
  const double across[3] = {0.1, 1, 0.2};
  REQUIRE(kerf_complex_cut_plane(complex, point, across) == KERF_OK);
  CHECK(counts(complex).pieces == 4);
  CHECK(kerf_complex_undo(complex) == KERF_OK);
  CHECK(counts(complex).faces == left);
  kerf_free(front);
  kerf_free(complex);
  kerf_free(mesh);
}
