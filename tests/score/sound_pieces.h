// The promises of every full score about the pieces that it makes.
#pragma once

#include <catch2/catch.hpp>
#include <cmath>

#include "kerf/check.h"
#include "kerf/complex.h"
#include "kerf/pieces.h"

/// Checks that pieces are closed and cross nothing, and that their volumes are as recorded and sum
/// to `volume`. Each face of a crack above `last_crack` is a wall between two of them.
inline void check_sound_pieces(const geo::Complex& cut, const geo::Pieces& pieces, double volume,
                               std::int32_t last_crack) {
  double sum = 0;
  for (const double v : pieces.volume) sum += v;
  CHECK(std::abs(sum - volume) <= 1e-12 * volume);
  for (std::uint32_t f = 0; f < cut.face_count(); ++f)
    if (cut.alive(geo::FaceId(f)) && cut.face(geo::FaceId(f)).crack > last_crack)
      REQUIRE(pieces.of_side[2 * f] != pieces.of_side[2 * f + 1]);
  for (std::uint32_t p = 0; p < pieces.count; ++p) {
    geo::TriangleMesh mesh = geo::piece_mesh(cut, pieces, p);
    CHECK(std::abs(geo::signed_volume(mesh) - pieces.volume[p]) <= 1e-12 * volume);
    mesh.patch.clear();
    mesh.site.clear();  // as a mesh of its own
    const auto whole = geo::check_surface(mesh, geo::SelfIntersections::find);
    INFO("piece " << p << " " << whole.first_problem);
    CHECK((whole.closed && whole.manifold && whole.oriented && whole.degenerate_faces == 0 &&
           whole.self_intersections == 0));
  }
}
