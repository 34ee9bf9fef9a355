// The events of § 5.1 and Fig. 3, each by name. None of them has code of its own in the library.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <numeric>

#include "kerf/check.h"
#include "kerf/crack.h"
#include "kerf/error.h"
#include "kerf/mesh.h"
#include "kerf/pieces.h"

using namespace geo;

namespace {

using Row = std::vector<Vec3>;

Row line(const Vec3& from, const Vec3& to, int segments = 4) {
  Row points;
  for (int i = 0; i <= segments; ++i) points.push_back(from + (to - from) * (double(i) / segments));
  return points;
}

// Sweeps a front through the rows, checking everything after each step; returns how many front
// edges remain in K.
std::size_t sweep(Complex& k, const std::vector<Row>& rows, std::int32_t crack, bool closed = false) {
  FrontState front = begin_front(rows[0], closed, crack);
  double volume = 0;
  for (const double v : find_pieces(k).volume) volume += v;
  for (std::size_t s = 1; s < rows.size(); ++s) {
    CAPTURE(s, crack);
    advance(k, front, rows[s]);
    const auto report = check_complex(k, SelfIntersections::find);
    INFO(report.first_problem);
    REQUIRE(report.good());
    const Pieces pieces = find_pieces(k);
    REQUIRE(std::accumulate(pieces.volume.begin(), pieces.volume.end(), 0.0) == Approx(volume).epsilon(1e-12));
  }
  std::size_t tips = 0;
  for (std::uint32_t f = 0; f < k.face_count(); ++f)
    for (int e = 0; e < 3 && k.alive(FaceId(f)); ++e)
      if (k.face(FaceId(f)).crack > 0)
        tips += k.faces_around(k.face(FaceId(f)).v[e], k.face(FaceId(f)).v[(e + 1) % 3]).size() == 1;
  return tips;
}

Complex cube() { return Complex::from_skin(make_block({4, 4, 4}, 1)); }
Row across(double x, double z) { return line({x, -1, z}, {x, 5, z}); }
std::size_t pieces(const Complex& k) { return find_pieces(k).count; }

}  // namespace

TEST_CASE("event: initiation at the skin and termination inside") {
  Complex k = cube();
  CHECK(sweep(k, {across(-1, 1.3), across(0.7, 1.4), across(1.9, 1.5)}, 1) > 0);
  CHECK(pieces(k) == 1);
}

TEST_CASE("event: initiation inside, never reaching the skin") {
  Complex k = cube();
  const auto row = [](double x) { return line({x, 1.2, 2.1}, {x, 2.9, 2.3}, 3); };
  CHECK(sweep(k, {row(1.1), row(1.8), row(2.6)}, 1) > 0);
  CHECK(pieces(k) == 1);
  CHECK(find_pieces(k).volume[0] == Approx(64).epsilon(1e-13));
}

TEST_CASE("event: branching off an older crack") {
  Complex k = cube();
  sweep(k, {across(-1, 2.2), across(5, 2.2)}, 1);
  // Begins on the crack's own sheet and leaves it upwards.
  sweep(k, {line({2, -1, 2.2}, {2, 5, 2.2}), line({2.5, -1, 3}, {2.5, 5, 3}), line({3, -1, 5}, {3, 5, 5})}, 2);
  CHECK(pieces(k) == 3);
}

TEST_CASE("event: merging of two fronts, front to front") {
  Complex k = cube();
  // From both sides to one shared line, which the second front takes to the bit.
  CHECK(sweep(k, {across(-1, 1.5), across(1, 1.6), across(2.3, 1.7)}, 1) > 0);
  CHECK(pieces(k) == 1);
  CHECK(sweep(k, {across(5, 1.9), across(3, 1.8), across(2.3, 1.7)}, 2) == 0);
  CHECK(pieces(k) == 2);
}

TEST_CASE("event: merging of a front with an older sheet") {
  Complex k = cube();
  sweep(k, {across(-1, 2.0), across(5, 2.0)}, 1);
  CHECK(sweep(k,
              {line({1.5, -1, 5}, {1.5, 5, 5}), line({1.7, -1, 3}, {1.7, 5, 3}), line({1.8, -1, 1.2}, {1.8, 5, 1.2})},
              2) > 0);
  CHECK(pieces(k) == 3);
}

TEST_CASE("event: a front passes out of the body and in again") {
  Complex k = Complex::from_skin(make_pumpkin(6));
  const auto row = [](double s) {
    Row p;
    for (int i = 0; i <= 12; ++i) p.push_back({-1.6 + 3.2 * i / 12.0, 0.9 * std::sin(0.7 * i + s), -1.5 + 3 * s});
    return p;
  };
  sweep(k, {row(0), row(0.2), row(0.4), row(0.6), row(0.8), row(1)}, 1);
  CHECK(pieces(k) >= 2);
}

TEST_CASE("event: a ring inside and a core that is drilled") {
  Complex k = cube();
  const auto ring = [](double radius, double z) {
    Row p;
    for (int i = 0; i < 9; ++i)
      p.push_back({2.03 + radius * std::cos(0.698 * i), 2.01 + radius * std::sin(0.698 * i), z});
    return p;
  };
  CHECK(sweep(k, {ring(0.4, 2.1), ring(0.9, 2.2), ring(1.3, 2.4)}, 1, true) > 0);  // grows like an opening flaw
  CHECK(pieces(k) == 1);
  sweep(k, {ring(0.7, -0.5), ring(0.7, 1), ring(0.7, 3), ring(0.7, 4.5)}, 2, true);
  CHECK(pieces(k) >= 2);
}

TEST_CASE("event: three sheets that meet in a line") {
  Complex k = cube();
  TriangleMesh sheet;
  sheet.vertices = {{2.1, -1, 2}, {2.1, 5, 2}, {-1, -1, 2.3}, {-1, 5, 2.3},
                    {5, -1, 3.1}, {5, 5, 3.1}, {3, -1, -1},   {3, 5, -1}};
  sheet.triangles = {{0, 1, 2}, {1, 3, 2}, {0, 1, 4}, {1, 5, 4}, {0, 1, 6}, {1, 7, 6}};
  insert_sheet(k, sheet, 1);
  CHECK(check_complex(k, SelfIntersections::find).first_problem == "");
  CHECK(pieces(k) == 3);
}

TEST_CASE("event: a sweep that crosses itself") {
  Complex k = cube();
  CHECK_NOTHROW(sweep(
      k,
      {line({1, 0.5, 1}, {3, 3.5, 1.2}, 3), line({3, 0.5, 2}, {1, 3.5, 2.2}, 3), line({1, 0.7, 3}, {3, 3.2, 3.1}, 3)},
      1));
  CHECK(pieces(k) == 1);
}

TEST_CASE("event: T, Y and X with older cracks, along one, and at its tip") {
  Complex k = cube();
  sweep(k, {across(-1, 2), across(2.5, 2)}, 1);                                     // ends inside
  sweep(k, {line({1, -1, 5}, {1, 5, 5}), line({1, -1, 2}, {1, 5, 2})}, 2);          // T
  sweep(k, {line({2.5, -1, 2}, {2.5, 5, 2}), line({3.5, -1, 1}, {3.5, 5, 1})}, 3);  // goes on at the tip
  sweep(k, {line({2.5, -1, 2}, {2.5, 5, 2}), line({5, -1, 3}, {5, 5, 3})}, 4);      // Y at the tip
  sweep(k, {line({-1, -1, 2}, {-1, 5, 2}), line({0.7, -1, 2}, {0.7, 5, 2})}, 5);    // along the first
  sweep(k, {line({1.7, -1, 5}, {1.7, 5, 5}), line({1.9, -1, 3}, {1.9, 5, 3}), line({1.6, -1, -1}, {1.6, 5, -1})},
        6);  // X
  CHECK(pieces(k) >= 4);
}

TEST_CASE("event: a front that turns back over its own sheet and stands still in part") {
  Complex k = cube();
  Row bent = across(2.4, 1.5);
  bent[2].x() = 1.2;
  sweep(k, {across(-1, 1.5), across(2.4, 1.5), across(1.1, 1.5), bent, bent, across(5, 1.5)}, 1);
  CHECK(pieces(k) == 2);
}

TEST_CASE("event: pieces that touch at a vertex only") {
  Complex k = cube();
  // Two corners cut off, up to the same point of an edge.
  TriangleMesh left, right;
  left.vertices = {{6, -2, 6}, {-2, 6, 6}, {-2, -2, -2}};
  right.vertices = {{-2, -2, 6}, {6, 6, 6}, {6, -2, -2}};
  left.triangles = right.triangles = {{0, 1, 2}};
  insert_sheet(k, left, 1);
  CHECK(pieces(k) == 2);
  insert_sheet(k, right, 2);
  CHECK(pieces(k) == 3);
  const Pieces parts = find_pieces(k);
  std::vector<double> volumes(parts.volume);
  std::sort(volumes.begin(), volumes.end());
  CHECK(volumes[0] == Approx(8.0 / 6).epsilon(1e-13));
  CHECK(volumes[1] == Approx(8.0 / 6).epsilon(1e-13));
  CHECK(check_complex(k, SelfIntersections::find).first_problem == "");
}

TEST_CASE("event: coordinates scaled by a millionth and a million, and moved far away") {
  for (const double scale : {1e-6, 1.0, 1e6})
    for (const double shift : {0.0, 1e6}) {
      if (scale < 1 && shift > 0) continue;  // nothing of the model would be left
      CAPTURE(scale, shift);
      TriangleMesh mesh = make_pumpkin(5);
      for (Vec3& p : mesh.vertices) p = scale * p + Vec3::Constant(shift);
      Complex k = Complex::from_skin(mesh);
      std::vector<Row> rows;
      for (int s = 0; s <= 6; ++s) {
        rows.emplace_back();
        for (int i = 0; i <= 8; ++i)
          rows.back().push_back(scale * Vec3(-1.7 + 3.4 * i / 8.0, -1.7 + 3.4 * s / 6.0, 0.1 * std::sin(i + 0.5 * s)) +
                                Vec3::Constant(shift));
      }
      sweep(k, rows, 1);
      CHECK(pieces(k) == 2);
    }
}
