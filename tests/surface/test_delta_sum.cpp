// Summed deltas.
#include <catch2/catch.hpp>

#include "surface/delta_sum.h"

using namespace geo;

TEST_CASE("a sum of deltas leaves out what was made and removed again") {
  const auto face = [](std::uint32_t f) { return FaceId(f); };
  const auto vertex = [](std::uint32_t v) { return SurfaceVertexId(v); };
  CrackDelta first, second;
  first.removed_faces = {face(3)};
  first.new_faces = {face(10), face(11)};
  first.new_surface_vertices = {vertex(20)};
  first.copied_from = {vertex(5)};
  second.removed_faces = {face(10)};
  second.new_faces = {face(12)};
  second.new_surface_vertices = {vertex(21)};
  second.copied_from = {vertex(20)};
  DeltaSum sum;
  sum.add(first);
  sum.add(second);
  const CrackDelta total = sum.sum();
  CHECK(total.removed_faces == std::vector{face(3)});
  CHECK(total.new_faces == std::vector{face(11), face(12)});
  CHECK(total.new_surface_vertices == std::vector{vertex(20), vertex(21)});
  CHECK(total.copied_from == std::vector{vertex(5), vertex(5)});
}
