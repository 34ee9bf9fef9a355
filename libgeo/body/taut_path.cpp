// The path leads over the sides of the surface, from a side that `from` sees to a side that `to`
// sees. It crosses edges at points pulled taut, and is lowered towards the surface until it touches
// nothing. Floating point only proposes points; exact predicates decide.
#include "body/taut_path.h"

#include <algorithm>
#include <map>
#include <set>

#include "base/random.h"
#include "body/locate.h"
#include "geometry/predicates.h"

namespace geo {
namespace {

using Step = std::pair<Side, int>;  // a side, and the edge over which the path leaves it

// Visibility along segments, with a limit of 100000 tests in one search. Nearly all paths that
// exist need less than a thousand; a higher limit costs time where no path exists.
class PathVisibility {
 public:
  explicit PathVisibility(const Complex& k) : k_(k) {}
  bool blocked(const Vec3& p, const Vec3& q) { return tests_left_ == 0 || (--tests_left_, is_blocked(k_, p, q)); }
  bool spent() const { return tests_left_ == 0; }

 private:
  const Complex& k_;
  int tests_left_ = 100000;
};

// A visible point on each of the sides that x sees along the axes and at the middles of near faces.
// One point may see several shells.
std::map<Side, Vec3> visible_sides(const Complex& k, const Vec3& x, double reach) {
  std::map<Side, Vec3> visible;
  std::vector<FaceId> faces;
  // Points near an edge do not count: the other face there may block the path.
  const auto add = [&](Side s, const Vec3& at) {
    const auto t = k.corners(s.face);
    const Vec3 n = (t[1] - t[0]).cross(t[2] - t[0]);
    for (int e = 0; e < 3; ++e)
      if (n.dot((t[(e + 1) % 3] - t[e]).cross(at - t[e])) < 0.01 * n.squaredNorm()) return;
    if (is_in_front(k, s, at, x)) visible.try_emplace(s, at);
  };
  const auto look_towards = [&](const Vec3& to) {
    Box3 box{x, x};
    box.add(to);
    faces.clear();
    k.faces_near(box, faces);
    double first = 2;
    Side side;
    for (const FaceId f : faces) {
      const auto t = k.corners(f);
      const Vec3 n = (t[1] - t[0]).cross(t[2] - t[0]);
      const double along = n.dot(to - x), at = along != 0 ? n.dot(t[0] - x) / along : 2;
      if (at > 0 && at < first && segment_meets_triangle(x, to, t[0], t[1], t[2])) {
        first = at;
        side = {f, along < 0 ? 1 : 0};
      }
    }
    if (side.face.valid()) add(side, x + first * (to - x));
  };
  for (int i = 0; i < 6; ++i) {
    Vec3 to = x;
    to[i % 3] = i < 3 ? k.extent().hi[i % 3] + reach : k.extent().lo[i % 3] - reach;
    look_towards(to);
  }
  std::vector<FaceId> targets;
  k.faces_near(Box3{x, x}.grown(reach), targets);
  for (std::size_t i = 0; i < std::min<std::size_t>(targets.size(), 32); ++i) {
    const auto t = k.corners(targets[i]);
    add({targets[i], orient3d(t[0], t[1], t[2], x) > 0 ? 1 : 0}, (t[0] + t[1] + t[2]) / 3);
  }
  return visible;
}

// The path over the fewest sides from one of `starts` to one of `ends` without `closed` steps;
// empty when there is none. The edge of the last step has no meaning.
std::vector<Step> sides_between(const Complex& k, const std::map<Side, Vec3>& starts, const std::map<Side, Vec3>& ends,
                                const std::set<Step>& closed) {
  std::map<Side, Step> before;
  std::vector<Side> queue;
  for (const auto& [side, at] : starts) {
    before[side] = {side, 0};
    queue.push_back(side);
  }
  for (std::size_t q = 0; q < queue.size(); ++q) {
    if (ends.count(queue[q])) {
      std::vector<Step> path{{queue[q], 0}};
      while (before.at(path.back().first).first != path.back().first) path.push_back(before.at(path.back().first));
      std::reverse(path.begin(), path.end());
      return path;
    }
    for (int e = 0; e < 3; ++e)
      if (!closed.count({queue[q], e}))
        if (const Side n = k.neighbor(queue[q], e); before.try_emplace(n, queue[q], e).second) queue.push_back(n);
  }
  return {};
}

Vec3 normal_of(const Complex& k, Side s) {
  const auto t = k.corners(s.face);
  return (s.which ? 1.0 : -1.0) * (t[1] - t[0]).cross(t[2] - t[0]).normalized();
}

// A support of the path: in front of a side at its ends, around an edge in between.
struct Support {
  Vec3 at;
  std::vector<Vec3> off;  // directions from `at` to points of the path, in order
  double height;
  std::size_t step = 0;  // index of the last step that it crosses
  Vec3 aim = at;         // the point that `at` is a few ulps from
  Vec3 point(std::size_t i) const { return at + height * off[i]; }
};

// Directions from the edge pq to points of a path from above one side to above the other.
std::vector<Vec3> around_edge(const Complex& k, Side a, Side b, const Vec3& p, const Vec3& q) {
  const Vec3 along = (q - p).normalized(), rise = normal_of(k, a), land = normal_of(k, b);
  const auto into = [&](Side s) {  // from the edge into the face
    const auto c = k.corners(s.face);
    const Vec3 w = (c[0] + c[1] + c[2]) / 3 - 0.5 * (p + q);
    return Vec3((w - w.dot(along) * along).normalized());
  };
  const Vec3 from = into(a), to = into(b);
  // Does material span more than 180 degrees around the edge? At a crack front both sides are of
  // one face.
  const auto t = k.corners(a.face);
  int behind = 0;
  for (const Vec3& c : k.corners(b.face))
    if (c != p && c != q) behind = orient3d(t[0], t[1], t[2], c) * (a.which ? -1 : 1);
  const bool reflex = a.face == b.face || behind > 0;
  // The bisector of the material's wedge; near 180 degrees the normals give it best.
  const Vec3 turn = (from.dot(to) < 0 ? Vec3(rise + land) : reflex ? Vec3(-(from + to)) : Vec3(from + to)).normalized();
  return reflex ? std::vector<Vec3>{rise, turn, land} : std::vector<Vec3>{turn};
}

// Points where a taut path crosses the edges of a path over sides, at least the share `clear` from
// their ends. 16 Gauss–Seidel rounds. The two triangles at an edge are unfolded into a plane, where
// the path is straight at t = (t_a h_b + t_b h_a) / (h_a + h_b).
std::vector<Vec3> crossings(const Complex& k, const std::vector<Step>& path, const Vec3& start, const Vec3& end,
                            double clear) {
  const std::size_t n = path.size() - 1;
  std::vector<std::array<Vec3, 2>> edges(n);
  std::vector<Vec3> at(n);
  for (std::size_t s = 0; s < n; ++s) {
    const auto t = k.corners(path[s].first.face);
    edges[s] = {t[static_cast<std::size_t>(path[s].second)], t[static_cast<std::size_t>((path[s].second + 1) % 3)]};
    at[s] = 0.5 * (edges[s][0] + edges[s][1]);
  }
  for (int round = 0; round < 16; ++round)
    for (std::size_t s = 0; s < n; ++s) {
      const Vec3 &p = edges[s][0], d = edges[s][1] - p, a = (s ? at[s - 1] : start) - p,
                 b = (s + 1 < n ? at[s + 1] : end) - p;
      const double ta = a.dot(d) / d.squaredNorm(), tb = b.dot(d) / d.squaredNorm();
      const double ha = (a - ta * d).norm(), hb = (b - tb * d).norm();
      const double t = ha + hb > 0 ? (ta * hb + tb * ha) / (ha + hb) : 0.5 * (ta + tb);
      at[s] = p + std::clamp(t, clear, 1 - clear) * d;
    }
  return at;
}

// An end of the path: a point in the material and a point that it sees on a side.
struct PathEnd {
  Vec3 point, foot;
};

// A taut path over given sides, as supports that are lowered until nothing blocks the path between
// them.
class SupportedPath {
 public:
  SupportedPath(const Complex& k, const std::vector<Step>& path, const PathEnd& from, const PathEnd& to, double reach,
                double clear)
      : from_(from), to_(to), lowest_(1e-16 * k.extent().diagonal()), random_(path.size() - 1) {
    const auto support_end = [&](const PathEnd& end, std::size_t step) {
      const Vec3 off = end.point - end.foot;
      supports_.push_back(
          {.at = end.foot, .off = {off.normalized()}, .height = std::min(0.25 * reach, off.norm()), .step = step});
    };
    support_end(from, 0);
    const auto at = crossings(k, path, from.foot, to.foot, clear);
    for (std::size_t s = 0; s < at.size();) {
      // The plane of a needle has no meaning: where its edges nearly touch, both are crossed as
      // one.
      std::size_t last = s;
      while (last + 1 < at.size() && (at[last + 1] - at[s]).norm() < 1e-9 * reach) ++last;
      const auto t = k.corners(path[s].first.face);
      supports_.push_back(
          {.at = at[s],
           .off = around_edge(k, path[s].first, path[last + 1].first, t[static_cast<std::size_t>(path[s].second)],
                              t[static_cast<std::size_t>((path[s].second + 1) % 3)]),
           .height = 0.25 * reach,
           .step = last});
      s = last + 1;
    }
    support_end(to, at.size());
  }
  /// Lowers supports until no segment is blocked. False when that fails; `blocked` is then a step
  /// of the path that cannot be passed.
  bool lower(PathVisibility& visibility, std::size_t& blocked) {
    int tries = 0;
    for (std::size_t h = 0; h < supports_.size() && !visibility.spent();) {
      bool open = true;
      for (std::size_t i = 0; i + 1 < supports_[h].off.size() && open; ++i)
        open = !visibility.blocked(supports_[h].point(i), supports_[h].point(i + 1));
      if (open && (h + 1 == supports_.size() ||
                   !visibility.blocked(supports_[h].point(supports_[h].off.size() - 1), supports_[h + 1].point(0)))) {
        ++h;
        continue;
      }
      // The higher end of a blocked segment is lowered; then the segment before is tested again.
      Support& high = open && supports_[h + 1].height > supports_[h].height ? supports_[h + 1] : supports_[h];
      high.height *= 0.5;
      if (high.height < lowest_) {
        if (tries++ == 250) {
          blocked = high.step;
          return false;
        }
        // Below the resolution of doubles single points fail, but a segment between others may
        // pass.
        perturb(supports_[h]);
        perturb(open ? supports_[h + 1] : supports_[h]);
      }
      h -= h > 0;
    }
    return true;
  }
  /// The path, ends included; empty when a segment is blocked.
  std::vector<Vec3> polyline(PathVisibility& visibility) const {
    std::vector<Vec3> points{from_.point};
    for (const Support& support : supports_)
      for (std::size_t i = 0; i < support.off.size(); ++i) points.push_back(support.point(i));
    points.push_back(to_.point);
    for (std::size_t s = 0; s + 1 < points.size(); ++s)
      if (visibility.blocked(points[s], points[s + 1])) return {};
    return points;
  }

 private:
  void perturb(Support& support) {
    const Vec3 direction = random_.direction();
    support.at = support.aim + 4 * lowest_ * random_.uniform() * direction;
    support.height = lowest_ * std::exp2(8 * random_.uniform());
  }

  PathEnd from_, to_;
  double lowest_;  // height: about the resolution of doubles in the extent of K (2⁻⁵³ ≈ 1e-16)
  Random random_;
  std::vector<Support> supports_;
};

}  // namespace

std::vector<Vec3> taut_path(const Complex& k, const Vec3& from, const Vec3& to, double reach) {
  const auto starts = visible_sides(k, from, reach), ends = visible_sides(k, to, reach);
  std::set<Step> closed;
  PathVisibility visibility(k);
  for (int attempt = 0; attempt < 32 && !visibility.spent(); ++attempt) {
    const auto path = sides_between(k, starts, ends, closed);
    if (path.empty()) return {};
    std::size_t blocked = 0;
    const PathEnd first{from, starts.at(path.front().first)}, last{to, ends.at(path.back().first)};
    for (const double clear : {1.0 / 16, 1.0 / 4, 1.0 / 2}) {
      SupportedPath supported(k, path, first, last, reach, clear);
      if (!supported.lower(visibility, blocked)) continue;
      auto points = supported.polyline(visibility);
      if (!points.empty()) return points;
      blocked = 0;
    }
    if (path.size() == 1) return {};
    closed.insert(path[std::min(blocked, path.size() - 2)]);
  }
  return {};
}

}  // namespace geo
