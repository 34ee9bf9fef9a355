#include <Eigen/Geometry>
#include <catch2/catch.hpp>
#include <cmath>

#include "base/random.h"
#include "cases.h"
#include "contact/detection/contact_candidates.h"
#include "contact/motion/bounded_motion.h"
#include "contact/motion/straight_motion.h"
#include "contact/response/contact_constraints.h"
#include "contact/two_sheets.h"
#include "geometry/predicates.h"
#include "kerf/mesh.h"

using namespace geo;

namespace {

struct Soup {
  std::vector<Triangle> triangles;
  std::vector<std::uint32_t> representative;
  std::vector<Vec3> from, to;
  void add(const TriangleMesh& m, const Vec3& at, double size) {
    const auto base = static_cast<std::uint32_t>(from.size());
    for (const Vec3& p : m.vertices) {
      representative.push_back(static_cast<std::uint32_t>(from.size()));
      from.push_back(at + size * p);
    }
    for (const auto& [a, b, c] : m.triangles) triangles.push_back({a + base, b + base, c + base});
  }
  std::vector<Vec3> move(BoundedMotionStats* report = nullptr) const {
    return move_without_crossing({triangles, representative, from, to, 1e-4, 2e-3}, false, report);
  }
  std::size_t crossings(const std::vector<Vec3>& at) const {
    return crossings_pair_by_pair(triangles, at, representative);
  }
};

// Two uneven sheets with different meshes, a little apart. They are pressed into each other and
// slide.
struct Sheets : Soup {
  static constexpr std::uint32_t n = 12;
  static constexpr double edge = 1.0 / n;
  double depth, slide;
  explicit Sheets(Random& random) {
    const double waves = 0.1 * random.uniform();
    depth = 0.2 * edge * random.uniform();
    slide = 0.3 * edge * random.uniform();
    const auto height = [&](double x, double y) { return waves * edge * std::sin(5 * x) * std::cos(4 * y); };
    const auto off = [&](std::uint32_t k) { return k == 0 || k == n ? 0.0 : 0.2 * edge * (random.uniform() - 0.5); };
    triangles = triangles_of_two_sheets(n);
    from = place_two_sheets(n, [&](std::uint32_t side, std::uint32_t i, std::uint32_t j) {
      const double x = i * edge + off(i), y = j * edge + off(j);
      return Vec3(x, y, height(x, y) + side * (0.06 * edge));
    });
    representative = all_apart(from.size());
    to = from;
    for (std::size_t i = 0; i < to.size(); ++i)
      to[i] += i < half() ? Vec3(0, 0, 0.5 * (depth + 0.06 * edge)) : Vec3(slide, 0, -0.5 * (depth + 0.06 * edge));
  }
  std::size_t half() const { return from.size() / 2; }
};

// Pairs of triangles, a corner of one nearer to the other than rounding: on it, but for the bits of
// its coordinates. They do not cross.
struct Touching : Soup {
  explicit Touching(Random& random) {
    while (triangles.size() < 20) {
      const Vec3 at(double(triangles.size()), 0, 0);
      std::array<Vec3, 3> a;
      for (Vec3& p : a) p = at + 0.4 * random.direction();
      const double u = random.uniform(0.1, 0.4);
      const double v = random.uniform(0.1, 0.4);
      const Vec3 touching = u * a[0] + v * a[1] + (1 - u - v) * a[2];
      const int side = orient3d(a[0], a[1], a[2], touching);
      const Vec3 normal = (a[1] - a[0]).cross(a[2] - a[0]);
      if (side == 0 || normal.norm() < 0.01) continue;
      const Vec3 away = touching + side * 0.2 * normal.normalized();
      const std::array<Vec3, 2> others = {away + 0.1 * random.direction(), away + 0.1 * random.direction()};
      if (orient3d(a[0], a[1], a[2], others[0]) != side || orient3d(a[0], a[1], a[2], others[1]) != side) continue;
      const auto first = static_cast<std::uint32_t>(from.size());
      from.insert(from.end(), {a[0], a[1], a[2], touching, others[0], others[1]});
      triangles.push_back({first, first + 1, first + 2});
      triangles.push_back({first + 3, first + 4, first + 5});
    }
    representative = all_apart(from.size());
  }
};

}  // namespace

// An affine motion keeps them apart but for rounding, and nothing else moves them: what is not
// certified is tested again all the same.
TEST_CASE("triangles that only rounding makes cross do not cross", "[campaign]") {
  int crossed_by_rounding = 0;
  const auto [first, count] = seeds(300);
  for (std::uint64_t seed = first; seed < first + static_cast<std::uint64_t>(count); ++seed) {
    INFO("KERF_CASE=" << seed);
    Random random(seed);
    Touching s(random);
    REQUIRE(s.crossings(s.from) == 0);
    Mat3 map = Eigen::AngleAxisd(random.uniform(0, 1), random.direction()).toRotationMatrix();
    for (int k = 0; k < 3; ++k) map.col(k) += random.uniform(0, 0.1) * random.direction();
    const Vec3 by = random.direction();
    s.to = s.from;
    for (Vec3& p : s.to) p = map * p + by;
    crossed_by_rounding += s.crossings(s.to) > 0;
    CHECK(s.crossings(s.move()) == 0);
  }
  CHECK(4 * crossed_by_rounding > count);
}

TEST_CASE("nothing crosses at the end of a motion, whatever its targets are", "[campaign]") {
  const auto [first, count] = seeds(150);
  for (std::uint64_t seed = first; seed < first + static_cast<std::uint64_t>(count); ++seed) {
    INFO("KERF_CASE=" << seed);
    Random random(seed);
    Soup s;
    s.add(make_sphere(2), {0, 0, 0}, 1);
    s.add(make_block({1, 1, 1}, 0.5), {1.05, random.uniform(-1, 0.5), random.uniform(-1, 0.5)}, 1);
    REQUIRE(s.crossings(s.from) == 0);
    const std::uint32_t kind = random.below(4);
    const Vec3 blow = random.uniform(0, 2) * random.direction();
    const Eigen::AngleAxisd turn(random.uniform(0, 1), random.direction());
    for (std::size_t v = 0; v < s.from.size(); ++v) {
      const Vec3& x = s.from[v];
      const bool ball = v < 42;
      s.to.push_back(kind == 0   ? Vec3(x + (ball ? blow : Vec3(-blow)))                  // thrown on each other
                     : kind == 1 ? Vec3(x + random.uniform(0, 0.3) * random.direction())  // every vertex for itself
                     : kind == 2
                         ? Vec3(turn * x + Vec3(ball ? 0.3 : -0.3, 0, 0))         // turning and pressed
                         : Vec3(x.x() > 1 ? Vec3(2 - x.x(), x.y(), x.z()) : x));  // folded over: coplanar in part
    }
    const auto end = s.move();
    CHECK(s.crossings(end) == 0);
  }
}

TEST_CASE("from a certified guess vertices only come nearer, and another guess is projected", "[campaign]") {
  const auto [first, count] = seeds(40);
  std::size_t held = 0;
  for (std::uint64_t seed = first; seed < first + static_cast<std::uint64_t>(count); ++seed) {
    INFO("KERF_CASE=" << seed);
    Random random(seed);
    const Sheets s(random);
    const auto end = s.move();
    const auto again = [&](const std::vector<Vec3>& guess) {
      return move_without_crossing({s.triangles, s.representative, s.from, s.to, 1e-4, 2e-3, &guess}, false);
    };
    const auto onwards = again(end);
    CHECK(s.crossings(onwards) == 0);
    bool nearer = true;
    for (std::size_t v = 0; v < end.size(); ++v)
      nearer = nearer && (onwards[v] - s.to[v]).norm() <= (end[v] - s.to[v]).norm() * (1 + 1e-12);
    held += nearer;
    std::vector<Vec3> worse = s.to;
    for (Vec3& x : worse) x += 0.01 * Sheets::edge * random.direction();
    CHECK(s.crossings(again(worse)) == 0);
  }
  CHECK(held > static_cast<std::size_t>(count) * 9 /
                   10);  // the exceptions took the fallback, which does not end at its own result
}

TEST_CASE("a wild motion ends after a bounded effort, and nothing crosses") {
  const auto [first, count] = seeds(2);
  std::size_t most = 0;  // evaluations per triangle
  for (std::uint64_t seed = first; seed < first + static_cast<std::uint64_t>(count); ++seed) {
    INFO("KERF_CASE=" << seed);
    Random random(seed);
    Soup s;  // two thin plates, whose vertices are all thrown about
    for (int plate = 0; plate < 2; ++plate) s.add(make_block({1, 1, 0.04}, 0.04), {0, 0, 0.05 * plate}, 1);
    REQUIRE(s.crossings(s.from) == 0);
    for (const Vec3& x : s.from) s.to.push_back(x + random.uniform(0, 0.5) * random.direction());
    BoundedMotionStats report;
    BroadPhase near;
    const std::vector<Vec3> at =
        move_without_crossing({s.triangles, s.representative, s.from, s.to, 1e-4, 2e-3}, false, &report, &near);
    CHECK(s.crossings(at) == 0);
    CHECK(near.pairs().size() <= near.most_of_motion());
    CHECK(report.evaluations < 1200 * s.triangles.size());
    most = std::max(most, report.evaluations / s.triangles.size());
  }
  CHECK(most > 900);  // it would be above 80,000
}

TEST_CASE("a motion past many triangles goes on in rounds") {
  // Triangles in layers that glide past each other, oblique to the axes: all boxes meet.
  Random random(4);
  Soup s;
  const Vec3 normal = Vec3(1, 1, 1).normalized(), u = normal.unitOrthogonal(), v = normal.cross(u);
  for (std::uint32_t layer = 0; layer < 2000; ++layer) {
    const Vec3 middle = 0.0005 * layer * normal + random.uniform(-0.5, 0.5) * u + random.uniform(-0.5, 0.5) * v;
    const double turn = random.uniform(0, 2 * M_PI);
    for (int k = 0; k < 3; ++k) {
      const double angle = turn + k * 2 * M_PI / 3;
      s.from.push_back(middle + 0.05 * (std::cos(angle) * u + std::sin(angle) * v));
    }
    s.triangles.push_back({3 * layer, 3 * layer + 1, 3 * layer + 2});
    const double to = random.uniform(0, 2 * M_PI);
    for (int k = 0; k < 3; ++k)
      s.to.push_back(s.from[3 * layer + std::uint32_t(k)] + 2 * (std::cos(to) * u + std::sin(to) * v));
  }
  s.representative = all_apart(s.from.size());
  REQUIRE(s.crossings(s.from) == 0);
  BroadPhase near;
  const std::vector<Vec3> at =
      move_without_crossing({s.triangles, s.representative, s.from, s.to, 1e-4, 2e-3}, false, nullptr, &near);
  CHECK(s.crossings(at) == 0);
  CHECK(near.pairs().size() <= near.most_of_motion());
  double left = 0;
  for (std::size_t i = 0; i < at.size(); ++i) left += (at[i] - s.to[i]).norm() / 2 / double(at.size());
  CHECK(left < 0.1);
}

TEST_CASE("pairs at rest do not count against the bound of a motion") {
  // A cylinder along the diagonal of the axes has 319 pairs of boxes per triangle at rest.
  const std::uint32_t n = 500;
  const Vec3 axis = Vec3(1, 1, 1).normalized(), u = axis.unitOrthogonal(), v = axis.cross(u);
  Soup s;
  for (int end = 0; end < 2; ++end)
    for (std::uint32_t k = 0; k < n; ++k) {
      const double angle = 2 * M_PI * k / n;
      s.from.push_back(end * 3 * axis + std::cos(angle) * u + std::sin(angle) * v);
    }
  for (std::uint32_t k = 0; k < n; ++k) {
    const std::uint32_t next = (k + 1) % n;
    s.triangles.push_back({k, next, n + next});
    s.triangles.push_back({k, n + next, n + k});
    if (k > 0 && next > 0) {
      s.triangles.push_back({0, next, k});
      s.triangles.push_back({n, n + k, n + next});
    }
  }
  s.representative = all_apart(s.from.size());
  BroadPhase near;
  for (const Vec3& x : s.from) s.to.push_back(x + 0.05 * std::sin(3 * u.dot(x)) * v);
  const std::vector<Vec3> at =
      move_without_crossing({s.triangles, s.representative, s.from, s.to, 1e-4, 2e-3}, false, nullptr, &near);
  CHECK(near.pairs().size() > BroadPhase::max_per_triangle * s.triangles.size());
  CHECK(at == s.to);
}

TEST_CASE("a surface that is clear of everything reaches its targets, to the bit") {
  Soup s;
  s.add(make_sphere(2), {0, 0, 0}, 1);
  s.add(make_sphere(2), {4, 0, 0}, 1);
  const Eigen::AngleAxisd turn(0.2, Vec3(1, 2, 3).normalized());
  for (const Vec3& x : s.from) s.to.push_back(turn * x + Vec3(5, 5, 5));
  BoundedMotionStats report;
  CHECK(s.move(&report) == s.to);
  CHECK(report.in_zones == 0);
}

TEST_CASE("straight motion reaches free targets, and passes through nothing") {
  Soup s;
  s.add(make_block({1, 1, 1}, 0.5), {0, 0, 0}, 1);
  const std::size_t second = s.from.size();
  s.add(make_block({1, 1, 1}, 0.5), {1.25, 0.013, 0.017}, 1);
  const std::size_t third = s.from.size();
  s.add(make_block({1, 1, 1}, 0.5), {0, 0, 3}, 1);
  // The first block's targets are beyond the second, which stays; the third is free.
  for (std::size_t v = 0; v < s.from.size(); ++v)
    s.to.push_back(s.from[v] + (v < second ? Vec3(2.6, 0, 0) : v < third ? Vec3(0, 0, 0) : Vec3(0.3, 0.1, 0.7)));
  std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs;
  for (std::uint32_t i = 0; i < s.triangles.size(); ++i)
    for (std::uint32_t j = i + 1; j < s.triangles.size(); ++j) pairs.push_back({i, j});
  std::vector<Vec3> at = s.from;
  move_straight(s.triangles, pairs, s.to, 1e-4, at);
  CHECK(s.crossings(at) == 0);
  for (std::size_t v = third; v < at.size(); ++v) CHECK(at[v] == s.to[v]);
  double farthest = 0;
  for (std::size_t v = 0; v < second; ++v) farthest = std::max(farthest, at[v].x());
  CHECK(farthest < 1.25);
  // Targets inside the second block: a quarter of the way ends before it.
  for (std::size_t v = 0; v < second; ++v) s.to[v] = s.from[v] + Vec3(0.4, 0, 0);
  at = s.from;
  move_straight(s.triangles, pairs, s.to, 1e-4, at);
  CHECK(s.crossings(at) == 0);
  double way = 0;
  for (std::size_t v = 0; v < second; ++v) way = std::max(way, at[v].x() - s.from[v].x());
  CHECK(way >= 0.1);
}

TEST_CASE("nothing leaves a shell at any speed, nor passes a triangle in its own plane") {
  const auto times_around = [](const Soup& s, const std::vector<Vec3>& at, std::size_t shell,
                               const Vec3& p) {  // van Oosterom and Strackee 1983
    double angle = 0;
    for (std::size_t t = 0; t < shell; ++t) {
      const Vec3 a = at[s.triangles[t][0]] - p, b = at[s.triangles[t][1]] - p, c = at[s.triangles[t][2]] - p;
      angle += 2 * std::atan2(a.dot(b.cross(c)), a.norm() * b.norm() * c.norm() + a.dot(b) * c.norm() +
                                                     b.dot(c) * a.norm() + c.dot(a) * b.norm());
    }
    return angle / (4 * 3.14159265358979323846);
  };
  for (const double speed : {0.1, 1.0, 100.0, 1e4}) {
    INFO(speed);
    for (const int kind : {0, 1, 2}) {
      INFO(kind);
      Soup s;
      s.add(make_sphere(2), {0, 0, 0}, 1);
      const std::size_t shell = s.triangles.size(), first = s.from.size();
      s.add(kind == 0 ? make_sphere(1) : make_block({1, 1, 1}, 0.5), {0.3, 0.2, 0}, 0.3);
      REQUIRE(s.crossings(s.from) == 0);
      s.to = s.from;
      for (std::size_t v = first; v < s.to.size(); ++v)
        s.to[v] +=
            speed * (kind == 2 ? Vec3(s.from[v] - Vec3(0.4, 0.3, 0.1)) : Vec3(0.6, 0.8, 0.2));  // flies, or bursts
      const auto end = s.move();
      CHECK(s.crossings(end) == 0);
      for (std::size_t v = first; v < end.size(); ++v)
        CHECK(times_around(s, end, shell, end[v]) == Approx(1).margin(1e-6));
    }
    // Two coplanar triangles side by side: the targets of one are inside the other.
    Soup s;
    s.triangles = {{0, 1, 2}, {3, 4, 5}};
    s.representative = {0, 1, 2, 3, 4, 5};
    s.from = {{-5, -5, 0}, {5, -5, 0}, {0, 5, 0}, {6, 0, 0}, {7, 0, 0}, {6, 1, 0}};
    s.to = s.from;
    for (std::size_t v = 3; v < 6; ++v) s.to[v].x() -= speed;
    REQUIRE(s.crossings(s.from) == 0);
    CHECK(s.crossings(s.move()) == 0);
  }
}

TEST_CASE("triangles that a fixed axis separates at both ends do not meet in between") {
  // Against a slow oracle: the motion in 2,000 steps, exactly.
  const auto [first, count] = seeds(300);
  std::size_t parted_both = 0, met = 0;
  for (std::uint64_t seed = first; seed < first + static_cast<std::uint64_t>(count); ++seed) {
    INFO("KERF_CASE=" << seed);
    Random random(seed);
    Soup s;
    s.triangles = {{0, 1, 2}, {3, 4, 5}};
    s.representative = {0, 1, 2, 3, 4, 5};
    for (int v = 0; v < 6; ++v)
      s.from.push_back(Vec3(v < 3 ? 0 : 1, 0, 0) + random.uniform(0, 0.5) * random.direction());
    const Vec3 closer = Vec3(0.4, 0, 0) + random.uniform(0, 0.5) * random.direction();
    for (int v = 0; v < 6; ++v)
      s.to.push_back(s.from[static_cast<std::size_t>(v)] + (v < 3 ? closer : Vec3(-closer)) +
                     random.uniform(0, 0.3) * random.direction());
    if (s.crossings(s.from) > 0) continue;
    Soup held = s;  // a fixed sphere around them, so that the surface as a whole does not move
    held.add(make_sphere(2), {0, 0, 0}, 100);
    held.to.insert(held.to.end(), held.from.begin() + 6, held.from.end());
    BroadPhase near;
    const auto watched =
        find_contact_candidates({held.triangles, held.representative, held.from, held.to, 1e-4, 2e-3}, near);
    bool meets = false;
    for (int step = 0; step <= 2000 && !meets; ++step) {
      std::vector<Vec3> at;
      for (std::size_t v = 0; v < 6; ++v) at.push_back(s.from[v] + step / 2000.0 * (s.to[v] - s.from[v]));
      meets = s.crossings(at) > 0;
    }
    if (meets) {
      ++met;
      CHECK_FALSE(watched.empty());  // all that meet are candidates
    } else if (watched.empty()) {
      ++parted_both;
    }
  }
  CHECK(met > 20);
  CHECK(parted_both > 20);
}

TEST_CASE("contact constraints do not depend on what the broad phase was used for before") {
  const auto [first, count] = seeds(20);
  std::size_t found = 0, in_another_order = 0;
  for (std::uint64_t seed = first; seed < first + static_cast<std::uint64_t>(count); ++seed) {
    INFO("KERF_CASE=" << seed);
    Random random(seed);
    const Sheets soup(random);
    std::vector<std::uint32_t> owner;
    for (std::size_t v = 0; v < soup.from.size(); ++v) owner.push_back(static_cast<std::uint32_t>(v / 7));
    BroadPhase fresh, used;
    // The broad phase has seen the same triangles elsewhere.
    std::vector<Vec3> elsewhere;
    for (const Vec3& p : soup.from) elsewhere.push_back({p.y(), random.uniform(), -p.x()});
    used.update(
        soup.triangles,
        [&](std::size_t t) {
          return box_of(elsewhere[soup.triangles[t][0]], elsewhere[soup.triangles[t][1]],
                        elsewhere[soup.triangles[t][2]]);
        },
        0);
    used.invalidate();
    const SurfaceMotion motion{soup.triangles, soup.representative, soup.from,
                               soup.to,        0.05 * Sheets::edge, 0.1 * Sheets::edge};
    const auto of_fresh = find_contact_candidates(motion, fresh, {owner, 2}),
               of_used = find_contact_candidates(motion, used, {owner, 2});
    for (std::size_t i = 0; i < std::min(of_fresh.size(), of_used.size()); ++i)
      in_another_order += !std::equal(of_fresh[i].a.v, of_fresh[i].a.v + 3, of_used[i].a.v);
    const auto a = contact_constraints(of_fresh, motion, {0.01, 0, 0.1 * Sheets::edge}),
               b = contact_constraints(of_used, motion, {0.01, 0, 0.1 * Sheets::edge});
    REQUIRE(a.size() == b.size());
    found += a.size();
    const auto same = [](const SurfacePoint& p, const SurfacePoint& q) {
      return p.size == q.size && std::equal(p.vertex, p.vertex + p.size, q.vertex) &&
             std::equal(p.weight, p.weight + p.size, q.weight);
    };
    for (std::size_t i = 0; i < a.size(); ++i)
      CHECK((same(a[i].a, b[i].a) && same(a[i].b, b[i].b) && a[i].normal == b[i].normal && a[i].depth == b[i].depth &&
             a[i].approach == b[i].approach));
  }
  CHECK(found > 200);
  CHECK(in_another_order > 200);
}

TEST_CASE(
    "targets of sheets that are pressed together while they slide are projected by their deficit, without zones") {
  const auto [first, count] = seeds(20);
  for (std::uint64_t seed = first; seed < first + static_cast<std::uint64_t>(count); ++seed) {
    INFO("KERF_CASE=" << seed);
    Random random(seed);
    const Sheets soup(random);
    REQUIRE(soup.crossings(soup.from) == 0);
    BoundedMotionStats report;
    const std::vector<Vec3> at = soup.move(&report);
    CHECK(soup.crossings(at) == 0);
    CHECK(report.in_zones == 0);
    double lag = 0;
    for (std::size_t i = 0; i < at.size(); ++i) lag = std::max(lag, (at[i] - soup.to[i]).norm());
    CHECK(lag < soup.depth + 0.3 * Sheets::edge);
  }
}

TEST_CASE("triangles so near that rounding hides every separating axis become rigid, and no others") {
  const auto [first, count] = seeds(20);
  std::size_t bound = 0;
  for (std::uint64_t seed = first; seed < first + static_cast<std::uint64_t>(count); ++seed) {
    INFO("KERF_CASE=" << seed);
    Random random(seed);
    Sheets soup(random);
    const std::vector<Vec3> otherwise = soup.move();
    // A vertex of the upper sheet is put on a triangle of the lower one, above it by a few ulps.
    const auto v = soup.half() + (Sheets::n + 1) * (4 + random.below(5)) + 4 + random.below(5);
    double low = -1, high = soup.from[v].z();
    for (double middle; low < (middle = 0.5 * (low + high)) && middle < high;) {
      soup.from[v].z() = middle;
      (soup.crossings(soup.from) == 0 ? high : low) = middle;
    }
    soup.from[v].z() = high + 2e-15 * (1 + random.uniform());
    REQUIRE(soup.crossings(soup.from) == 0);
    BoundedMotionStats report;
    const std::vector<Vec3> at = soup.move(&report);
    CHECK(soup.crossings(at) == 0);
    CHECK(report.in_zones <= 24);
    bound += report.in_zones > 0;
    double most = 0;
    for (std::size_t i = 0; i < at.size(); ++i)
      if ((soup.from[i] - soup.from[v]).norm() > 4 * Sheets::edge) most = std::max(most, (at[i] - otherwise[i]).norm());
    CHECK(most < 0.1 * Sheets::edge);
  }
  CHECK(2 * bound > static_cast<std::size_t>(count));
}

TEST_CASE("what is still keeps its place where others can move instead, and nothing crosses", "[campaign]") {
  const auto [first, count] = seeds(100);
  int kept = 0;
  for (std::uint64_t seed = first; seed < first + static_cast<std::uint64_t>(count); ++seed) {
    INFO("KERF_CASE=" << seed);
    Random random(seed);
    Soup s;
    s.add(make_sphere(2), {0, 0, 0}, 1);
    const std::size_t balls = s.from.size();
    s.add(make_block({1, 1, 1}, 0.5), {1.02, random.uniform(-1, 0.5), random.uniform(-1, 0.5)}, 1);
    s.to = s.from;
    const Vec3 blow = random.uniform(0, 0.3) * random.direction();
    std::vector<std::uint8_t> still(s.from.size(), 0);
    for (std::size_t v = 0; v < s.from.size(); ++v) {
      still[v] = v < balls;
      if (!still[v]) s.to[v] += blow;
    }
    const auto end = move_without_crossing({.triangles = s.triangles,
                                            .representative = s.representative,
                                            .from = s.from,
                                            .to = s.to,
                                            .gap = 1e-4,
                                            .reach = 2e-3,
                                            .still = still},
                                           false);
    CHECK(s.crossings(end) == 0);
    kept += std::equal(end.begin(), end.begin() + std::ptrdiff_t(balls), s.from.begin());
  }
  CHECK(kept >= count * 9 / 10);  // else the fallback has moved it
}
