// The strip of a step: its border, its tags, and snapping to vertices, on random fronts.
#include "crack/sweep.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <map>

#include "base/random.h"
#include "cases.h"
#include "geometry/distance.h"
#include "kerf/check.h"
#include "kerf/mesh.h"

using namespace geo;

namespace {

struct Lexicographic {
  bool operator()(const Vec3& a, const Vec3& b) const {
    return std::lexicographical_compare(a.data(), a.data() + 3, b.data(), b.data() + 3);
  }
};
// How often a chain runs along each edge, from its lower to its higher end; none of them zero.
class Chain {
 public:
  void add(const Vec3& a, const Vec3& b) {
    if (a == b) return;
    const bool up = Lexicographic()(a, b);
    int& times = times_[{up ? a : b, up ? b : a}];
    times += up ? 1 : -1;
    if (times == 0) times_.erase({up ? a : b, up ? b : a});
  }
  void add_border(const Strip& strip) {
    for (const auto& t : strip.triangles)
      for (std::size_t k = 0; k < 3; ++k) add(strip.points[t.p[k]], strip.points[t.p[(k + 1) % 3]]);
  }
  // How often it runs from a to b, less how often from b to a.
  int times(const Vec3& a, const Vec3& b) const {
    const bool up = Lexicographic()(a, b);
    const auto found = times_.find({up ? a : b, up ? b : a});
    return found == times_.end() ? 0 : up ? found->second : -found->second;
  }
  friend bool operator==(const Chain& a, const Chain& b) { return a.times_ == b.times_; }

 private:
  struct Less {
    bool operator()(const std::pair<Vec3, Vec3>& a, const std::pair<Vec3, Vec3>& b) const {
      const Lexicographic before;
      return before(a.first, b.first) || (a.first == b.first && before(a.second, b.second));
    }
  };
  std::map<std::pair<Vec3, Vec3>, int, Less> times_;
};

Vec3 random_point(Random& random, const Box3& box) {
  return {random.uniform(box.lo.x(), box.hi.x()), random.uniform(box.lo.y(), box.hi.y()),
          random.uniform(box.lo.z(), box.hi.z())};
}

// A front with random contacts inside its segments, and where it goes. Some points stand still.
struct Step {
  FrontState front;
  std::vector<Vec3> next;
  explicit Step(Random& random) {
    const Box3 box{{0, 0, 0}, {1, 1, 1}};
    std::vector<Vec3> points;
    for (std::uint32_t i = 0, count = 3 + random.below(4); i < count; ++i) points.push_back(random_point(random, box));
    front = begin_front(points, random.below(2) == 0, 1);
    for (auto& segment : front.segments) {
      const Vec3 a = segment.front().position, b = segment.back().position;
      for (std::uint32_t i = 1, contacts = random.below(3); i <= contacts; ++i)
        segment.insert(segment.end() - 1, {Vec3(a + i / (contacts + 1.0) * (b - a)), VertexId()});
    }
    for (const Vec3& p : points) next.push_back(random.below(4) == 0 ? p : random_point(random, box));
  }
  bool stands(std::size_t i) const {
    return front.segments[i].front().position == next[i] &&
           front.segments[i].back().position == next[(i + 1) % next.size()];
  }
  // The old front with its contacts, the way of its end, the new front backwards and the way of its
  // beginning. A segment that stands still has no strip and thus no part in the border.
  void add_border(Chain& chain) const {
    for (std::size_t i = 0; i < front.segments.size(); ++i) {
      if (stands(i)) continue;
      const auto& segment = front.segments[i];
      for (std::size_t j = 0; j + 1 < segment.size(); ++j) chain.add(segment[j].position, segment[j + 1].position);
      chain.add(next[(i + 1) % next.size()], next[i]);
    }
    if (front.closed) return;
    chain.add(front.points.back().position, next.back());
    chain.add(next.front(), front.points.front().position);
  }
};

// The least distance of a point from a strip.
double distance_from(const Strip& strip, const Vec3& q) {
  double least = 1e300;
  for (const auto& t : strip.triangles) {
    const Vec3 &a = strip.points[t.p[0]], &b = strip.points[t.p[1]], &c = strip.points[t.p[2]];
    least = std::min(least, (closest_point_on_triangle(q, a, b, c) - q).norm());
  }
  return least;
}

}  // namespace

TEST_CASE("a strip is bounded by the old front with its contacts, the ways of its ends, and the new front") {
  const auto [first, count] = seeds(300);
  std::size_t standing = 0;
  for (std::uint64_t seed = first; seed < first + static_cast<std::uint64_t>(count); ++seed) {
    INFO("KERF_CASE=" << seed);
    Random random(seed);
    const Step step(random);
    const Strip strip = sweep(step.front, step.next);
    Chain border, expected;
    border.add_border(strip);
    step.add_border(expected);
    CHECK(border == expected);
    CHECK(strip.new_front == step.next);
    const auto is_old = [&](const Vec3& p) {
      return std::any_of(step.front.segments.begin(), step.front.segments.end(), [&](const auto& segment) {
        return std::any_of(segment.begin(), segment.end(), [&](const auto& q) { return q.position == p; });
      });
    };
    for (std::size_t i = 0; i < strip.points.size(); ++i) CHECK(strip.fixed[i] == is_old(strip.points[i]));
    // Each segment of the new front that moves is tagged once, at the edge where it lies.
    std::map<int, int> tagged;
    for (const auto& t : strip.triangles)
      for (std::size_t k = 0; k < 3; ++k)
        if (const int s = t.segment[k]; s >= 0) {
          ++tagged[s];
          const Vec3 &a = step.next[static_cast<std::size_t>(s)],
                     &b = step.next[(static_cast<std::size_t>(s) + 1) % step.next.size()];
          CHECK((strip.points[t.p[k]] == b && strip.points[t.p[(k + 1) % 3]] == a));
        }
    for (std::size_t i = 0; i < step.front.segments.size(); ++i) {
      CHECK(tagged[static_cast<int>(i)] == (step.stands(i) ? 0 : 1));
      standing += step.stands(i);
    }
  }
  CHECK(standing > 0);
}

TEST_CASE("consecutive strips are oriented alike: the front between them is no border of both together") {
  const auto [first, count] = seeds(100);
  for (std::uint64_t seed = first; seed < first + static_cast<std::uint64_t>(count); ++seed) {
    INFO("KERF_CASE=" << seed);
    Random random(seed);
    Step first_step(random), second(random);
    second.front = begin_front(first_step.next, first_step.front.closed, 1);
    second.next.clear();
    for (const Vec3& p : first_step.next) second.next.push_back(p + random.direction());
    Chain border, expected;
    border.add_border(sweep(first_step.front, first_step.next));
    border.add_border(sweep(second.front, second.next));
    first_step.add_border(expected);
    second.add_border(expected);
    CHECK(border == expected);
    // The edges of the front between them cancel, except where the first step stood still.
    for (std::size_t i = 0; i < second.front.segments.size(); ++i) {
      const auto& segment = second.front.segments[i];
      if (!first_step.stands(i)) CHECK(border.times(segment.front().position, segment.back().position) == 0);
    }
  }
}

TEST_CASE("each face that a strip's triangle crosses is near it") {
  const Complex k = Complex::from_skin(make_pumpkin(6));
  const auto [first, count] = seeds(20);
  std::size_t crossing = 0;
  for (std::uint64_t seed = first; seed < first + static_cast<std::uint64_t>(count); ++seed) {
    INFO("KERF_CASE=" << seed);
    Random random(seed);
    std::vector<Vec3> points;
    for (int i = 0; i < 12; ++i) points.push_back(random_point(random, k.extent().grown(0.2)));
    Strip strip = strip_of(points, std::vector<Triangle>{{0, 1, 2}, {3, 4, 5}, {6, 7, 8}, {9, 10, 11}});
    find_near(strip, k, 1e-9);
    REQUIRE(strip.near_begin.size() == strip.triangles.size() + 1);
    for (std::size_t t = 0; t < strip.triangles.size(); ++t) {
      const auto& p = strip.triangles[t].p;
      for (std::uint32_t f = 0; f < k.face_count(); ++f) {
        const bool crosses = faces_cross({0, 1, 2}, k.corners(FaceId(f)), {3, 4, 5},
                                         {strip.points[p[0]], strip.points[p[1]], strip.points[p[2]]});
        const auto from = strip.near.begin() + strip.near_begin[t], to = strip.near.begin() + strip.near_begin[t + 1];
        if (crosses) CHECK(std::binary_search(from, to, FaceId(f)));
        crossing += crosses;
      }
    }
  }
  CHECK(crossing > 100);
}

TEST_CASE("after snapping, a vertex within reach is a point of the strip, which keeps its border and its place") {
  const auto [first, count] = seeds(100);
  const double reach = 1e-3;
  std::size_t snapped = 0;
  for (std::uint64_t seed = first; seed < first + static_cast<std::uint64_t>(count); ++seed) {
    INFO("KERF_CASE=" << seed);
    Random random(seed);
    const Complex k = Complex::from_skin(make_block({1, 1, 1}, 0.5));
    // Two triangles near three vertices of the block: near a corner, an edge or the inside of one.
    const auto vertex = [&] { return k.point(VertexId(random.below(k.vertex_count()))); };
    Vec3 a = vertex(), b = vertex(), c = vertex();
    if ((b - a).cross(c - a).norm() < 1e-6) continue;
    const auto off = [&] { return Vec3(0.4 * reach * random.uniform() * random.direction()); };
    if (random.below(2) == 0) b = 2 * b - a;
    if (random.below(2) == 0) c = 2 * c - a;
    std::vector<Vec3> points{a + off(), b + off(), c + off(), a + b - c + off()};
    Strip strip = strip_of(points, std::vector<Triangle>{{0, 1, 2}, {1, 0, 3}});
    const Strip before = strip;
    snapped += snap_to_vertices(strip, k, reach);
    for (std::uint32_t v = 0; v < k.vertex_count(); ++v) {
      const Vec3& q = k.point(VertexId(v));
      const bool is_point = std::count(strip.points.begin(), strip.points.end(), q) > 0;
      if (distance_from(before, q) < 0.3 * reach) CHECK(is_point);
      if (is_point) CHECK(distance_from(before, q) < 1.01 * reach);
    }
    for (const Vec3& p : strip.points) CHECK(distance_from(before, p) < 1.01 * reach);
    const auto area = [](const Strip& s) {
      Vec3 sum = Vec3::Zero();
      for (const auto& t : s.triangles)
        sum += 0.5 * (s.points[t.p[1]] - s.points[t.p[0]]).cross(s.points[t.p[2]] - s.points[t.p[0]]);
      return sum;
    };
    CHECK((area(strip) - area(before)).norm() < 10 * reach);
    // Every inner edge has two triangles still: the border is that of the quad, divided.
    std::map<std::pair<std::uint32_t, std::uint32_t>, int> uses;
    for (const auto& t : strip.triangles)
      for (std::size_t i = 0; i < 3; ++i) ++uses[std::minmax(t.p[i], t.p[(i + 1) % 3])];
    std::size_t border = 0, points_used = 0;
    std::vector<bool> used(strip.points.size());
    for (const auto& [edge, times] : uses) {
      border += times == 1;
      used[edge.first] = used[edge.second] = true;
    }
    points_used = static_cast<std::size_t>(std::count(used.begin(), used.end(), true));
    CHECK(points_used + strip.triangles.size() == uses.size() + 1);  // a disk: V − E + F = 1
    CHECK(border == 2 * points_used - 2 - strip.triangles.size());
  }
  CHECK(snapped > static_cast<std::size_t>(count));
}

TEST_CASE("snapping leaves the line of a front that has moved: no vertex beside it divides it") {
  const auto [first, count] = seeds(300);
  const double reach = 1e-3;
  std::size_t in_triangles = 0;
  for (std::uint64_t seed = first; seed < first + static_cast<std::uint64_t>(count); ++seed) {
    INFO("KERF_CASE=" << seed);
    Random random(seed);
    // A tetrahedron whose vertex 2 is beside the middle of the old front: its edge 01, or a line
    // that goes on in the air.
    const Vec3 a(0, 0, 0), b(1, 0, 0);
    const double turn = random.uniform(0, 2 * M_PI), offset = reach * std::pow(10.0, -random.uniform(0.1, 3));
    const Vec3 beside(random.uniform(0.1, 0.9), offset * std::cos(turn), offset * std::sin(turn));
    const Vec3 top(0.5, -0.3, 1);
    // Vertex 2 is on either side of the plane through 0, 1 and 3.
    const bool is_left = (b - a).cross(beside - a).dot(top - a) > 0;
    const std::vector<Triangle> sides = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
    const std::vector<Triangle> turned = {{0, 1, 2}, {0, 3, 1}, {1, 3, 2}, {2, 3, 0}};
    TriangleMesh tetrahedron;
    tetrahedron.vertices = {a, b, beside, top};
    tetrahedron.triangles = is_left ? sides : turned;
    const Complex k = Complex::from_skin(tetrahedron);
    const Vec3 end = random.below(2) == 0 ? b : Vec3(2, 0, 0);
    FrontState front = begin_front(std::vector<Vec3>{a, end}, false, 1);
    front.has_moved = true;
    Strip strip = sweep(front, std::vector<Vec3>{{0, 0.5 + random.uniform(), 0}, {end.x(), 0.5 + random.uniform(), 0}});
    snap_to_vertices(strip, k, reach);
    Chain border;
    border.add_border(strip);
    // Vertex b is on the line in the air exactly, and may divide it.
    CHECK((border.times(a, end) == 1 || (border.times(a, b) == 1 && border.times(b, end) == 1)));
    in_triangles += std::count(strip.points.begin(), strip.points.end(), beside) > 0;
  }
  CHECK(in_triangles > static_cast<std::size_t>(count) / 4);
}
