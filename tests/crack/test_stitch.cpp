// Stitching: the edit of K that an arrangement stands for, against counts over all faces, and
// radial orders around an edge that a new crack joins.
#include "crack/stitch.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <map>

#include "base/random.h"
#include "cases.h"
#include "crack/block_cuts.h"
#include "crack/guard.h"
#include "kerf/check.h"
#include "kerf/error.h"
#include "kerf/mesh.h"

using namespace geo;

namespace {

using Edge = std::pair<VertexId, VertexId>;

// A complex and the edit that inserts a sheet into it.
struct Stitched {
  Complex k;
  ComplexEdit edit;
  std::size_t kept = 0;

  // A block with up to two earlier cracks, and a bent sheet of six triangles through it.
  explicit Stitched(Random& random) : k(Complex::from_skin(make_block({1, 1, 1}, 0.3))) {
    for (std::int32_t c = 1, earlier = static_cast<std::int32_t>(random.below(3)); c <= earlier; ++c) {
      const auto rows = block_cut(random);
      FrontState front = begin_front(rows[0], false, c);
      for (std::size_t s = 1; s < rows.size(); ++s) advance(k, front, rows[s]);
    }
    const Vec3 middle(random.uniform(), random.uniform(), random.uniform()), n = random.direction(),
                                                                             u = n.unitOrthogonal(), v = n.cross(u);
    std::vector<Vec3> points{middle};
    std::vector<Triangle> triangles;
    for (std::uint32_t i = 0; i < 6; ++i) {
      const double angle = i * 1.0471975511965976, size = random.uniform(0.4, 1);
      points.push_back(middle + size * (std::cos(angle) * u + std::sin(angle) * v) + random.uniform(-0.2, 0.2) * n);
      triangles.push_back({0, 1 + i, 1 + (i + 1) % 6});
    }
    Strip strip = strip_of(points, triangles);
    find_near(strip, k, 1e-9);
    crack::Arrangement arrangement(k, strip);
    CrackStats stats;
    arrangement.meet(stats);
    arrangement.split();
    const crack::EdgeTable edges = crack::edges_of_complex(arrangement);
    const auto inside = crack::children_in_material(arrangement, k, edges);
    std::vector<VertexId> vertex;
    edit = crack::stitch(arrangement, k, edges, inside, 9, vertex);
    kept = inside.size();
  }
  const Vec3& point(VertexId v) const { return point_after(k, edit, v); }
  FaceId new_id(std::size_t i) const { return FaceId(k.face_count() + static_cast<std::uint32_t>(i)); }
  std::array<VertexId, 3> corners(FaceId f) const {
    return f.value < k.face_count() ? k.face(f).v : edit.new_faces[f.value - k.face_count()].v;
  }
  Vec3 vector_area(const std::array<VertexId, 3>& v) const {
    return 0.5 * (point(v[1]) - point(v[0])).cross(point(v[2]) - point(v[0]));
  }
  // The faces at each edge after the edit.
  std::map<Edge, std::vector<FaceId>> faces_at_edges() const {
    std::map<Edge, std::vector<FaceId>> faces;
    const auto add = [&](FaceId f) {
      const auto v = corners(f);
      for (std::size_t e = 0; e < 3; ++e) faces[std::minmax(v[e], v[(e + 1) % 3])].push_back(f);
    };
    for (std::uint32_t f = 0; f < k.face_count(); ++f)
      if (k.alive(FaceId(f)) && !std::count(edit.removed_faces.begin(), edit.removed_faces.end(), FaceId(f)))
        add(FaceId(f));
    for (std::size_t i = 0; i < edit.new_faces.size(); ++i) add(new_id(i));
    return faces;
  }
};

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

TEST_CASE("stitching divides faces into children that cover them, and adds the kept children as crack faces") {
  const auto [first, count] = seeds(40);
  std::size_t divided = 0;
  for (std::uint64_t seed = first; seed < first + static_cast<std::uint64_t>(count); ++seed) {
    INFO("KERF_CASE=" << seed);
    Random random(seed);
    const Stitched s(random);
    std::map<FaceId, Vec3> covered;
    std::size_t crack_faces = 0;
    for (const auto& f : s.edit.new_faces) {
      if (!f.parent.valid()) {
        ++crack_faces;
        CHECK(f.crack == 9);
        continue;
      }
      const Vec3 parent = s.vector_area(s.k.face(f.parent).v), own = s.vector_area(f.v);
      CHECK(f.crack == s.k.face(f.parent).crack);
      CHECK(own.dot(parent) >= -1e-12 * parent.squaredNorm());  // not turned over
      covered.try_emplace(f.parent, Vec3::Zero()).first->second += own;
    }
    CHECK(crack_faces == s.kept);
    CHECK(covered.size() == s.edit.removed_faces.size());
    for (const FaceId f : s.edit.removed_faces) {
      REQUIRE(covered.count(f) == 1);
      CHECK((covered[f] - s.vector_area(s.k.face(f).v)).norm() < 1e-12);
    }
    divided += covered.size();
  }
  CHECK(divided > 10 * static_cast<std::size_t>(count));
}

TEST_CASE("stitching gives the radial order of every edge of a crack face or of a divided edge with three or more") {
  const auto [first, count] = seeds(40);
  std::size_t three = 0, more = 0;
  for (std::uint64_t seed = first; seed < first + static_cast<std::uint64_t>(count); ++seed) {
    INFO("KERF_CASE=" << seed);
    Random random(seed);
    Stitched s(random);
    const auto faces = s.faces_at_edges();
    std::map<Edge, std::size_t> given;
    for (const auto& order : s.edit.radial_orders) {
      const Edge edge = std::minmax(order.a, order.b);
      ++given[edge];
      auto listed = order.faces, found = faces.at(edge);
      (listed.size() == 3 ? three : more) += 1;
      std::sort(listed.begin(), listed.end());
      std::sort(found.begin(), found.end());
      CHECK(listed == found);
      std::vector<Vec3> apex;
      for (const FaceId f : order.faces)
        for (const VertexId v : s.corners(f))
          if (v != order.a && v != order.b) apex.push_back(s.point(v));
      CHECK(in_radial_order(s.point(order.a), s.point(order.b), apex));
    }
    for (const auto& [edge, at] : faces) {
      const bool joined = std::any_of(at.begin(), at.end(), [&](FaceId f) {
        return f.value >= s.k.face_count() && !s.edit.new_faces[f.value - s.k.face_count()].parent.valid();
      });
      const bool is_new = edge.second.value >= s.k.vertex_count();
      if (at.size() >= 3 && (joined || is_new)) CHECK(given[edge] == 1);
    }
    s.k.apply(s.edit);
    CHECK(check_complex(s.k, SelfIntersections::find).first_problem == "");
    CHECK(signed_volume(s.k.two_sided()) == Approx(1).epsilon(1e-12));
  }
  CHECK(three > 10 * static_cast<std::size_t>(count));
  CHECK(4 * more > static_cast<std::size_t>(count));
}

TEST_CASE("a crack that joins an edge is inserted between the faces that it lies between") {
  const std::vector<Vec3> apexes{{0.8, 0.5, 0.5}, {0.5, 0.8, 0.5}, {0.2, 0.5, 0.5}};
  for (const double angle : {0.5, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0}) {
    Complex k = with_faces_around(apexes);
    CAPTURE(angle);
    insert_sheet(k, sheet_to({0.5 + 0.2 * std::cos(angle), 0.5 + 0.2 * std::sin(angle), 0.5}), 2);
    CHECK(check_complex(k, SelfIntersections::find).good());
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
