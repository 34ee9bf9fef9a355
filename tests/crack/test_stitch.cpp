// Radial orders around an edge of K that a new crack joins.
#include <catch2/catch.hpp>
#include <cmath>

#include "kerf/check.h"
#include "kerf/crack.h"
#include "kerf/error.h"
#include "kerf/mesh.h"

using namespace geo;

namespace {

const Vec3 u(0.5, 0.5, 0.25), v(0.5, 0.5, 0.75);

// A cube with one crack face from the edge uv to each apex, in this order around the edge.
Complex with_faces_around(const std::vector<Vec3>& apexes) {
  Complex k = Complex::from_skin(make_block(Vec3(1, 1, 1), 1));
  const auto n = static_cast<std::uint32_t>(k.vertex_count()), f = static_cast<std::uint32_t>(k.face_count());
  ComplexEdit edit;
  edit.new_vertices = {u, v};
  ComplexEdit::RadialOrder order{VertexId(n), VertexId(n + 1), {}};
  for (std::uint32_t i = 0; i < apexes.size(); ++i) {
    edit.new_vertices.push_back(apexes[i]);
    edit.new_faces.push_back({{VertexId(n), VertexId(n + 1), VertexId(n + 2 + i)}, 1, FaceId()});
    order.faces.push_back(FaceId(f + i));
  }
  edit.radial_orders = {order};
  k.apply(edit);
  return k;
}

// A sheet of one triangle from the edge uv.
TriangleMesh sheet_to(const Vec3& apex) {
  TriangleMesh sheet;
  sheet.vertices = {u, v, apex};
  sheet.triangles = {{0, 1, 2}};
  return sheet;
}

}  // namespace

TEST_CASE("a crack that joins an edge is inserted between the faces that it lies between") {
  const std::vector<Vec3> apexes{{0.8, 0.5, 0.5}, {0.5, 0.8, 0.5}, {0.2, 0.5, 0.5}};
  for (const double angle : {0.5, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0}) {
    Complex k = with_faces_around(apexes);
    CAPTURE(angle);
    insert_sheet(k, sheet_to({0.5 + 0.2 * std::cos(angle), 0.5 + 0.2 * std::sin(angle), 0.5}), 2);
    CHECK(check_complex(k, true).good());
  }
}

TEST_CASE("a crack is not inserted where two faces of the complex lie on each other") {
  CrackOptions once;
  once.attempts = 0;
  // The first two apexes are in one direction: the faces overlap, which no guard lets a crack do.
  Complex k = with_faces_around({{0.8, 0.5, 0.5}, {0.7, 0.5, 0.5}, {0.2, 0.5, 0.5}});
  const auto faces = k.face_count();
  CHECK_THROWS_AS(insert_sheet(k, sheet_to({0.5, 0.8, 0.5}), 2, once), GeometryError);
  CHECK(k.face_count() == faces);
  // Beside the edge there is no order to decide.
  CHECK_NOTHROW(insert_sheet(k, sheet_to({0.5, 0.8, 0.5}), 2));
}
