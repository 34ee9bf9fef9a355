// A crack step is made as a whole, or the body is as before it.
#include <catch2/catch.hpp>
#include <optional>
#include <utility>

#include "body/crack_transaction.h"
#include "body/cut_cube.h"
#include "kerf/error.h"

using namespace geo;

namespace {

bool are_equal(const Body& a, const Body& b) {
  const TriangleMesh s = a.surface.two_sided(), t = b.surface.two_sided();
  return s.vertices == t.vertices && s.triangles == t.triangles && a.nodes.position == b.nodes.position &&
         a.binding == b.binding && a.crack_steps == b.crack_steps;
}

}  // namespace

TEST_CASE("a crack transaction that is not committed leaves the body as it was") {
  Body body = cube();
  const Body before = body;
  FrontState front = begin_front(edge(-0.3), false, 1);
  const std::vector<Vec3> next = edge(0.6);
  const CrackEdit step_of_front = advance_of(front, next, {});
  SECTION("it ends") {
    const CrackTransaction step(body, step_of_front, nullptr);
    CHECK(body.surface.live_face_count() > before.surface.live_face_count());
  }
  SECTION("it is prepared, moved and ends") {
    CrackTransaction step(body, step_of_front, nullptr);
    step.prepare();
    std::optional<CrackTransaction> other(std::move(step));
    CHECK(body.surface.live_face_count() > before.surface.live_face_count());
  }
  SECTION("another one takes its place") {
    CrackTransaction step(body, step_of_front, nullptr);
    step = CrackTransaction(std::move(step));
    CHECK(body.surface.live_face_count() > before.surface.live_face_count());
  }
  SECTION("it is vetoed") {
    CrackTransaction step(body, step_of_front, nullptr);
    const auto veto = [](const Complex&, const CrackDelta&) { throw GeometryError("no"); };
    CHECK_THROWS_AS(step.commit(veto), GeometryError);
  }
  CHECK(are_equal(body, before));
}

TEST_CASE("a committed transaction is a step of split()") {
  Body body = cube(), other = body;
  FrontState front = begin_front(edge(-0.3), false, 1), other_front = front;
  for (const double x : {0.4, 0.7, 1.3}) {
    const std::vector<Vec3> next = edge(x);
    CrackTransaction step(body, advance_of(front, next, {}), nullptr);
    step.prepare();
    const BodyDelta delta = step.commit();
    const BodyDelta wanted = split(other, other_front, edge(x));
    CHECK(delta.crack.new_faces == wanted.crack.new_faces);
    CHECK(delta.donors == wanted.donors);
    CHECK(are_equal(body, other));
  }
  CHECK(front.step == 3);
}
