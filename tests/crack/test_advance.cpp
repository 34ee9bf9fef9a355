#include <algorithm>
#include <catch2/catch.hpp>
#include <numeric>

#include "base/random.h"
#include "cases.h"
#include "crack/grid_case.h"
#include "kerf/check.h"
#include "kerf/crack.h"
#include "kerf/error.h"
#include "kerf/mesh.h"
#include "kerf/pieces.h"

using namespace geo;

namespace {

std::vector<Vec3> line(const Vec3& from, const Vec3& to, int segments) {
  std::vector<Vec3> points;
  for (int i = 0; i <= segments; ++i) points.push_back(from + (to - from) * (double(i) / segments));
  return points;
}

void require_sound(const Complex& k, double volume) {
  const auto report = check_complex(k, SelfIntersections::find);
  INFO(report.first_problem);
  REQUIRE(report.good());
  const Pieces pieces = find_pieces(k);
  REQUIRE(std::accumulate(pieces.volume.begin(), pieces.volume.end(), 0.0) == Approx(volume).epsilon(1e-12));
}

// A plane sheet z = height over [-1, 5]² of a 4-cube, swept along x.
void sweep_plane(Complex& k, double height, int steps, int segments, std::int32_t crack, double to = 5) {
  FrontState front = begin_front(line({-1, -1, height}, {-1, 5, height}, segments), false, crack);
  for (int s = 1; s <= steps; ++s) {
    const double x = -1 + (to + 1) * s / steps;
    advance(k, front, line({x, -1, height}, {x, 5, height}, segments));
  }
}

}  // namespace

TEST_CASE("planes through vertices and edges of a grid cube separate it, in any number of steps") {
  for (const int steps : {1, 3, 12})
    for (const int segments : {1, 5, 8}) {
      CAPTURE(steps, segments);
      Complex k = Complex::from_skin(make_block({4, 4, 4}, 1));
      sweep_plane(k, 2, steps, segments, 1);
      require_sound(k, 64);
      const Pieces pieces = find_pieces(k);
      REQUIRE(pieces.count == 2);
      CHECK(pieces.volume[0] == Approx(32).epsilon(1e-14));
      // The same plane again, divided otherwise: everything is there already.
      const auto before = k.live_face_count();
      sweep_plane(k, 2, 5, 7, 2);
      CHECK(find_pieces(k).count == 2);
      CHECK(k.live_face_count() >= before);
      require_sound(k, 64);
    }
}

TEST_CASE("a partial cut leaves one piece with a front and going on separates it") {
  Complex k = Complex::from_skin(make_block({4, 4, 4}, 1));
  FrontState front = begin_front(line({-1, -1, 1.3}, {-1, 5, 1.3}, 4), false, 1);
  for (const double x : {0.5, 1.7, 2.9}) {
    advance(k, front, line({x, -1, 1.3}, {x, 5, 1.3}, 4));
    CHECK(find_pieces(k).count == 1);
    require_sound(k, 64);
  }
  advance(k, front, line({4.5, -1, 1.3}, {4.5, 5, 1.3}, 4));
  CHECK(find_pieces(k).count == 2);
  require_sound(k, 64);
}

TEST_CASE("a crack may begin inside, stand still in part, turn back, and reach no skin at all") {
  Complex k = Complex::from_skin(make_block({4, 4, 4}, 1));
  FrontState front = begin_front(line({1.1, 1.2, 2.1}, {1.1, 2.9, 2.1}, 2), false, 1);
  advance(k, front, std::vector<Vec3>{{1.1, 1.2, 2.1}, {2.0, 2.0, 2.1}, {2.2, 2.9, 2.3}});
  require_sound(k, 64);
  CHECK(find_pieces(k).count == 1);
  std::vector<Vec3> same;
  for (const auto& p : front.points) same.push_back(p.position);
  CHECK(advance(k, front, same).empty());
  advance(k, front, std::vector<Vec3>{{1.1, 1.2, 2.1}, {1.5, 2.0, 2.4}, {2.2, 2.9, 2.3}});
  require_sound(k, 64);
  CHECK(k.two_sided().triangles.size() == make_block({4, 4, 4}, 1).triangles.size() +
                                              2 * (k.live_face_count() - make_block({4, 4, 4}, 1).triangles.size()));
}

TEST_CASE("a crack that meets an older one is joined to it: T and X") {
  Complex k = Complex::from_skin(make_block({4, 4, 4}, 1));
  sweep_plane(k, 2, 4, 4, 1);
  FrontState front = begin_front(line({1.5, -1, 3.3}, {1.5, 5, 3.3}, 3), false, 2);
  advance(k, front, line({1.5, -1, 5}, {1.5, 5, 5}, 3));
  require_sound(k, 64);
  CHECK(find_pieces(k).count == 2);
  FrontState down = begin_front(line({1.5, -1, 5}, {1.5, 5, 5}, 3), false, 3);
  for (const double z : {3.0, 1.0, -1.0}) advance(k, down, line({1.5, -1, z}, {1.5, 5, z}, 3));
  require_sound(k, 64);
  CHECK(find_pieces(k).count == 4);
}

TEST_CASE("a ring front drills a core") {
  Complex k = Complex::from_skin(make_block({4, 4, 4}, 1));
  const auto ring = [](double z) {
    std::vector<Vec3> p;
    for (int i = 0; i < 8; ++i) p.push_back({2.03 + std::cos(0.785 * i), 2.01 + std::sin(0.785 * i), z});
    return p;
  };
  FrontState front = begin_front(ring(-0.5), true, 1);
  for (const double z : {1.0, 2.5, 4.5}) advance(k, front, ring(z));
  require_sound(k, 64);
  CHECK(find_pieces(k).count == 2);
}

TEST_CASE("a front that misses changes nothing") {
  Complex k = Complex::from_skin(make_sphere(4));
  FrontState front = begin_front(line({3, 0, 0}, {3, 1, 0}, 2), false, 1);
  CHECK(advance(k, front, line({4, 0, 0}, {4, 1, 0}, 2)).empty());
  CHECK(front.step == 1);
  CHECK_THROWS_AS(begin_front(std::vector<Vec3>{{0, 0, 0}}, false, 1), InputError);
  CHECK_THROWS_AS(advance(k, front, std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}}), InputError);
}

TEST_CASE("a front that passes over steps of its file is new until it has moved") {
  // It begins so near a face that its free points move away from it, before the first step alone.
  const auto made = [](std::uint32_t passed) {
    Complex k = Complex::from_skin(make_block({4, 4, 4}, 1));
    FrontState front = begin_front(line({0.5, 1.5, 4 - 1e-8}, {3.5, 1.5, 4 - 1e-8}, 2), false, 1);
    front.step = passed;
    CHECK_FALSE(front.has_moved);
    advance(k, front, line({0.5, 1.5, 2}, {3.5, 1.5, 2}, 2));
    CHECK(front.has_moved);
    CHECK(front.step == passed + 1);
    return k.two_sided().vertices;
  };
  CHECK(made(6) == made(0));
}

TEST_CASE("random curved cuts, partial and complete, keep every invariant") {
  std::size_t refused = 0, steps = 0;
  for (int seed = 1; seed <= cases(25); ++seed) {
    CAPTURE(seed);
    Random random(static_cast<std::uint64_t>(seed));
    const TriangleMesh mesh = make_pumpkin(6);
    Complex k = Complex::from_skin(mesh);
    for (int cut = 1; cut <= 2; ++cut) {
      const Vec3 d1 = random.direction(), d2 = d1.cross(random.direction()).normalized(), n = d1.cross(d2);
      const double offset = random.uniform(-0.5, 0.5), bend = random.below(2) ? 0.15 : 0,
                   whole = random.below(2) ? 1.0 : random.uniform();
      const auto row = [&](double s) {
        std::vector<Vec3> p;
        for (int j = 0; j <= 8; ++j)
          p.push_back(offset * n + 3.2 * (s * whole - 0.5) * d1 + 3.2 * (j / 8.0 - 0.5) * d2 +
                      bend * std::sin(4 * s + j) * n);
        return p;
      };
      const int count = random.below(2) ? 12 : 1 + static_cast<int>(random.below(3));
      FrontState front = begin_front(row(0), false, cut);
      for (int s = 1; s <= count; ++s, ++steps) {
        const auto before = k.live_face_count();
        try {
          advance(k, front, row(double(s) / count));
        } catch (const GeometryError&) {
          ++refused;
          CHECK(k.live_face_count() == before);
        }
      }
    }
    require_sound(k, signed_volume(mesh));
  }
  CHECK(refused * 100 <= steps);
}

namespace {

// Whether a living vertex of K is between two consecutive entries of a segment that has moved,
// which lists the vertices of K on it. `before`: where the front's points were.
bool lacks_contacts(const Complex& k, const FrontState& front, const std::vector<FrontState::Point>& before) {
  const double tolerance = 1e-12 * k.extent().diagonal();
  for (std::size_t s = 0; s < front.segments.size(); ++s) {
    const auto& segment = front.segments[s];
    if (segment.front().position == before[s].position && segment.back().position == before[s + 1].position) continue;
    for (std::size_t i = 1; i < segment.size(); ++i) {
      const Vec3 &a = segment[i - 1].position, &b = segment[i].position;
      if (a == b) continue;
      std::vector<FaceId> near;
      k.faces_near(box_of(a, b, b).grown(tolerance), near);
      for (const FaceId f : near)
        for (const VertexId v : k.face(f).v) {
          if (v == segment[i - 1].id || v == segment[i].id) continue;
          const Vec3 along = b - a, w = k.point(v) - a;
          const double t = w.dot(along) / along.squaredNorm();
          if (t > 0 && t < 1 && (w - t * along).norm() < tolerance) return true;
        }
    }
  }
  return false;
}

// A copy of point i beside it, and a segment without length between the two.
void duplicate_point(FrontState& front, std::size_t i) {
  const FrontState::Point p = front.points[i];
  front.points.insert(front.points.begin() + static_cast<std::ptrdiff_t>(i), p);
  front.segments.insert(front.segments.begin() + static_cast<std::ptrdiff_t>(i), {p, p});
}

}  // namespace

// Points stand, move on, or part from one that they were at, through the skin or inside.
TEST_CASE("a front knows each vertex of the complex that is on it") {
  const Seeds all = seeds(100);
  std::size_t refused = 0, steps = 0;
  for (std::uint64_t seed = all.first; seed < all.first + static_cast<std::uint64_t>(all.count); ++seed) {
    INFO("KERF_CASE=" << seed);
    Random random(seed);
    Complex k = Complex::from_skin(make_block({4, 4, 4}, 1));
    const double height = random.uniform(1.05, 2.95);
    FrontState front = begin_front(line({-0.3, 0.7, height}, {-0.3, 4.6, height}, 4), false, 1);
    for (int s = 0; s < 6; ++s) {
      if (random.below(2) == 0) duplicate_point(front, random.below(static_cast<std::uint32_t>(front.points.size())));
      std::vector<Vec3> next;
      for (const auto& p : front.points) {
        const Vec3 by(random.uniform(0.1, 1.0), random.uniform(-0.3, 0.3), random.uniform(-0.1, 0.1));
        next.push_back(random.below(3) == 0 ? p.position : Vec3(p.position + by));
      }
      const std::vector<FrontState::Point> before = front.points;
      ++steps;
      try {
        advance(k, front, next);
      } catch (const GeometryError&) {
        ++refused;
        continue;
      }
      REQUIRE(!lacks_contacts(k, front, before));
    }
    require_sound(k, 64);
  }
  CHECK(refused * 100 <= steps);
}

namespace {

// Compares all that two complexes have, dead ids included.
void require_same(const Complex& a, const Complex& b) {
  REQUIRE(a.vertex_count() == b.vertex_count());
  REQUIRE(a.face_count() == b.face_count());
  REQUIRE(a.surface_vertex_count() == b.surface_vertex_count());
  REQUIRE(a.live_face_count() == b.live_face_count());
  REQUIRE(a.crack_count() == b.crack_count());
  std::vector<std::uint32_t> rows_a, rows_b;
  const TriangleMesh ma = a.two_sided(&rows_a), mb = b.two_sided(&rows_b);
  REQUIRE(rows_a == rows_b);
  REQUIRE((ma.vertices == mb.vertices && ma.triangles == mb.triangles && ma.patch == mb.patch && ma.site == mb.site &&
           ma.source == mb.source));
  bool rings = true, fans = true, near = true;
  std::vector<FaceId> near_a, near_b;
  for (std::uint32_t f = 0; f < a.face_count(); ++f) {
    if (!a.alive(FaceId(f))) continue;
    const auto& v = a.face(FaceId(f)).v;
    for (int k = 0; k < 3; ++k) {
      rings = rings && std::ranges::equal(a.faces_around(v[k], v[(k + 1) % 3]), b.faces_around(v[k], v[(k + 1) % 3]));
      fans = fans && std::ranges::equal(a.faces_at(v[k]), b.faces_at(v[k]));
    }
    near_a.clear();
    near_b.clear();
    a.faces_near(a.box(FaceId(f)), near_a);
    b.faces_near(b.box(FaceId(f)), near_b);
    near = near && near_a == near_b;
  }
  for (std::uint32_t v = 0; v < a.surface_vertex_count(); ++v)
    if (a.alive(SurfaceVertexId(v))) fans = fans && a.corner_of(SurfaceVertexId(v)) == b.corner_of(SurfaceVertexId(v));
  CHECK(rings);
  CHECK(fans);
  CHECK(near);
}

}  // namespace

TEST_CASE("skin along the axes stays exactly flat") {
  const Seeds which = seeds(100);
  for (int i = 0; i < which.count; ++i) {
    const std::uint64_t seed = which.first + static_cast<std::uint64_t>(i);
    CAPTURE(seed);
    Random random(seed);
    // Doubles are dense around zero: a rounded plane is not flat there.
    const Vec3 corner(0, -2, random.uniform(-3, 3));
    TriangleMesh block = make_block({2, 2, 2}, 1);
    for (Vec3& p : block.vertices) p += corner;
    Complex k = Complex::from_skin(block);
    const Vec3 middle = corner + Vec3::Ones(), across = 4 * random.direction(), along = 4 * across.unitOrthogonal();
    FrontState front = begin_front(line(middle - along - across, middle - along + across, 3), false, 1);
    for (const double at : {-0.2, 0.3, 1.0})
      advance(k, front, line(middle + at * along - across, middle + at * along + across, 3));
    REQUIRE(find_pieces(k).count == 2);
    for (std::uint32_t f = 0; f < k.face_count(); ++f) {
      if (!k.alive(FaceId(f)) || k.face(FaceId(f)).crack != 0) continue;
      const auto t = k.corners(FaceId(f));
      int flat = 0;
      for (int axis = 0; axis < 3; ++axis) flat += t[0][axis] == t[1][axis] && t[1][axis] == t[2][axis];
      CHECK(flat == 1);
    }
  }
}

TEST_CASE("a step that is taken back leaves the complex as it was, and what comes next as it would have been") {
  const auto [first, count] = seeds(20);
  std::size_t taken_back = 0;
  for (auto seed = first; seed < first + static_cast<std::uint64_t>(count); ++seed) {
    CAPTURE(seed);
    const GridCase grid = random_case(seed);
    Complex k = Complex::from_skin(make_block(Vec3::Constant(GridCase::size), GridCase::size / grid.divisions)),
            plain = k;
    REQUIRE_THROWS_AS(k.undo(), GeometryError);
    for (std::size_t c = 0; c < grid.cracks.size(); ++c) {
      FrontState front = begin_front(grid.cracks[c].rows[0], grid.cracks[c].closed, static_cast<std::int32_t>(c + 1));
      for (std::size_t s = 1; s < grid.cracks[c].rows.size(); ++s) {
        const FrontState before = front;
        try {
          const bool changed = !advance(k, front, grid.cracks[c].rows[s]).empty();
          if (changed) {
            k.undo();
            ++taken_back;
            require_same(k, plain);
            REQUIRE_THROWS_AS(k.undo(), GeometryError);
            FrontState again = before;
            advance(k, again, grid.cracks[c].rows[s]);
          }
          FrontState other = before;
          advance(plain, other, grid.cracks[c].rows[s]);
          require_same(k, plain);
        } catch (const GeometryError&) {
          break;
        }
      }
    }
  }
  CHECK(taken_back > 0);
}
