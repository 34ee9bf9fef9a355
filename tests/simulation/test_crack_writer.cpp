// Crack steps that a run makes, or refuses.
#include <catch2/catch.hpp>

#include "body/cut_cube.h"
#include "kerf/error.h"
#include "simulation/crack_writer.h"

using namespace geo;

TEST_CASE("the writer makes steps of fronts and any other edit, and body indices follow") {
  Body body = cube(), other = body;
  std::vector<std::uint32_t> body_index(body.nodes.size(), 3);
  CrackWriter writer(body, body_index, {});
  FrameStats stats;
  const FrontState front = begin_front(edge(-0.3), false, 1);
  const auto written = writer.write(front, edge(1.3), stats);
  REQUIRE(written);
  CHECK(written->front.has_moved);
  CHECK_FALSE(written->faces.empty());
  CHECK(body.nodes.size() > other.nodes.size());
  CHECK(body_index == std::vector<std::uint32_t>(body.nodes.size(), 3));
  CHECK(writer.crumbs() == 0);
  // The same crack, as an edit of the complex that another complex has.
  std::vector<std::uint32_t> other_index(other.nodes.size(), 3);
  CrackWriter second(other, other_index, {});
  const auto grow = [&](Complex& complex, CrackStats*) { return complex.apply(complex.difference(body.surface)); };
  REQUIRE(second.write(grow, stats));
  CHECK(other.surface.two_sided().vertices == body.surface.two_sided().vertices);
  CHECK(other.nodes.position == body.nodes.position);
  CHECK(other_index == body_index);
  CHECK(stats.refused == 0);
}

TEST_CASE("a step that the writer refuses is counted, and one that is dropped is taken back") {
  Body body = cube();
  std::vector<std::uint32_t> body_index(body.nodes.size(), 0);
  CrackWriter writer(body, body_index, {});
  FrameStats stats;
  const auto faces = body.surface.live_face_count();
  const auto fails = [](Complex&, CrackStats*) -> CrackDelta { throw GeometryError("no"); };
  CHECK_FALSE(writer.write(fails, stats));
  CHECK(stats.refused == 1);
  {
    const auto begun = writer.begin(begin_front(edge(-0.3), false, 1), edge(0.6), stats);
    REQUIRE(begun);
    CHECK(body.surface.live_face_count() > faces);
  }
  CHECK(body.surface.live_face_count() == faces);
  CHECK(stats.refused == 1);
}
