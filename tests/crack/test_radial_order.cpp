// The guard's test of radial orders against the order of all faces after the edit.
#include "crack/radial_order.h"

#include <catch2/catch.hpp>

#include "base/random.h"
#include "cases.h"
#include "crack/block_cuts.h"
#include "crack/local_edit.h"
#include "kerf/check.h"
#include "kerf/mesh.h"

using namespace geo;

namespace {

// True when the faces around each edge of three or more are in the order that K stores.
bool all_in_order(const Complex& k) {
  for (std::uint32_t f = 0; f < k.face_count(); ++f) {
    if (!k.alive(FaceId(f))) continue;
    for (std::size_t e = 0; e < 3; ++e) {
      const auto [a, b] = std::minmax(k.face(FaceId(f)).v[e], k.face(FaceId(f)).v[(e + 1) % 3]);
      const auto around = k.faces_around(a, b);
      if (around.size() < 3) continue;
      std::vector<Vec3> apex;
      for (const FaceId g : around)
        for (const VertexId v : k.face(g).v)
          if (v != a && v != b) apex.push_back(k.point(v));
      if (!in_radial_order(k.point(a), k.point(b), apex)) return false;
    }
  }
  return true;
}

}  // namespace

TEST_CASE("a move of a vertex has a radial fault if and only if faces are out of order after it") {
  const auto [first, count] = seeds(15);
  std::size_t faults = 0, sound = 0;
  for (std::uint64_t seed = first; seed < first + static_cast<std::uint64_t>(count); ++seed) {
    INFO("KERF_CASE=" << seed);
    Random random(seed);
    Complex k = Complex::from_skin(make_block({1, 1, 1}, 0.5));
    for (std::int32_t c = 1; c <= 2; ++c) {
      const auto rows = block_cut(random);
      FrontState front = begin_front(rows[0], false, c);
      for (std::size_t s = 1; s < rows.size(); ++s) advance(k, front, rows[s]);
    }
    REQUIRE(all_in_order(k));
    const std::uint32_t before = k.vertex_count(), faces = k.face_count();
    for (int move = 0; move < 60; ++move) {
      const VertexId v(random.below(before));
      if (k.faces_at(v).empty()) continue;
      const double size = std::pow(10.0, random.uniform(-3, 0));
      const auto local = crack::relocate(k, v, k.point(v) + size * random.direction());
      const Fault fault = find_radial_fault(k, local.edit, {});
      CHECK_FALSE(find_radial_fault(k, local.edit, std::vector<std::uint8_t>(local.edit.new_vertices.size(), 0)));
      for (const auto i : fault.faces) CHECK(i < local.edit.new_faces.size());
      k.apply(local.edit);
      CHECK(static_cast<bool>(fault) == !all_in_order(k));
      k.undo();
      REQUIRE(k.vertex_count() == before);
      REQUIRE(k.face_count() == faces);
      (fault ? faults : sound) += 1;
    }
  }
  CHECK(faults > 20);
  CHECK(sound > 100);
}
