// Over the sides from one point's sight to the other's, across edges at points pulled tight, low
// enough above both to meet nothing. What is found is only what exact predicates let through; all
// the rest here is where to look.
#include "body/taut_path.h"

#include <algorithm>
#include <map>
#include <set>

#include "base/random.h"
#include "body/locate.h"
#include "geometry/predicates.h"

namespace geo {
namespace {

using Step = std::pair<Side, int>;  ///< out of a side over one of its edges

// Sight along links of a way, as often as one search may ask: nearly all that are found take less
// than a thousand.
class Sight {
 public:
  explicit Sight(const Complex& k) : k_(k) {}
  bool blocked(const Vec3& p, const Vec3& q) { return left_ == 0 || (--left_, is_blocked(k_, p, q)); }
  bool spent() const { return left_ == 0; }

 private:
  const Complex& k_;
  int left_ = 100000;
};

// Where one looks at each of the sides that are seen along the axes and at the middles of near
// faces. One point may see several shells.
std::map<Side, Vec3> look_around(const Complex& k, const Vec3& x, double reach) {
  std::map<Side, Vec3> sights;
  std::vector<FaceId> faces;
  // What is seen near an edge is no foothold: the other face there may be in the way.
  const auto add = [&](Side s, const Vec3& at) {
    const auto t = k.corners(s.face);
    const Vec3 n = (t[1] - t[0]).cross(t[2] - t[0]);
    for (int e = 0; e < 3; ++e)
      if (n.dot((t[(e + 1) % 3] - t[e]).cross(at - t[e])) < 0.01 * n.squaredNorm()) return;
    if (is_in_front(k, s, at, x)) sights.try_emplace(s, at);
  };
  const auto look = [&](const Vec3& to) {
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
      if (at > 0 && at < first && segment_meets_triangle(x, to, t[0], t[1], t[2]))
        first = at, side = {f, along < 0 ? 1 : 0};
    }
    if (side.face.valid()) add(side, x + first * (to - x));
  };
  for (int i = 0; i < 6; ++i) {
    Vec3 to = x;
    to[i % 3] = i < 3 ? k.extent().hi[i % 3] + reach : k.extent().lo[i % 3] - reach;
    look(to);
  }
  std::vector<FaceId> targets;
  k.faces_near(Box3{x, x}.grown(reach), targets);
  for (std::size_t i = 0; i < std::min<std::size_t>(targets.size(), 32); ++i) {
    const auto t = k.corners(targets[i]);
    add({targets[i], orient3d(t[0], t[1], t[2], x) > 0 ? 1 : 0}, (t[0] + t[1] + t[2]) / 3);
  }
  return sights;
}

// Over the fewest sides from one of `starts` to one of `ends`, not by `closed` steps; empty when
// there is no such way. The last step's edge says nothing.
std::vector<Step> sides_between(const Complex& k, const std::map<Side, Vec3>& starts, const std::map<Side, Vec3>& ends,
                                const std::set<Step>& closed) {
  std::map<Side, Step> before;
  std::vector<Side> queue;
  for (const auto& [side, at] : starts) before[side] = {side, 0}, queue.push_back(side);
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

/// A place where the way is held: before a side at its ends, at an edge in between.
struct Hold {
  Vec3 at;
  std::vector<Vec3> off;  ///< directions from `at`, one after another
  double height;
  std::size_t step = 0;  ///< of the path over sides: the one that it crosses last
  Vec3 aim = at;         ///< what `at` is a few last places from
  Vec3 point(std::size_t i) const { return at + height * off[i]; }
};

// From over one side to over another around the edge pq.
std::vector<Vec3> around_edge(const Complex& k, Side a, Side b, const Vec3& p, const Vec3& q) {
  const Vec3 along = (q - p).normalized(), rise = normal_of(k, a), land = normal_of(k, b);
  const auto into = [&](Side s) {  // from the edge into the face
    const auto c = k.corners(s.face);
    const Vec3 w = (c[0] + c[1] + c[2]) / 3 - 0.5 * (p + q);
    return Vec3((w - w.dot(along) * along).normalized());
  };
  const Vec3 from = into(a), to = into(b);
  // More than half a turn of material around the edge? A front's own face comes back on its other
  // side.
  const auto t = k.corners(a.face);
  int behind = 0;
  for (const Vec3& c : k.corners(b.face))
    if (c != p && c != q) behind = orient3d(t[0], t[1], t[2], c) * (a.which ? -1 : 1);
  const bool reflex = a.face == b.face || behind > 0;
  // The middle of the material's wedge, from whatever says it best: near half a turn the normals
  // do.
  const Vec3 turn = (from.dot(to) < 0 ? Vec3(rise + land) : reflex ? Vec3(-(from + to)) : Vec3(from + to)).normalized();
  return reflex ? std::vector<Vec3>{rise, turn, land} : std::vector<Vec3>{turn};
}

// Where a way pulled tight crosses the edges of a path over sides, at least the share `clear` of
// each from its ends.
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

// The way over such a path; where there is none, `blocked` is a step of the path that did not go.
std::vector<Vec3> way_over(const Complex& k, Sight& sight, const std::vector<Step>& path, const Vec3& from,
                           const Vec3& start, const Vec3& to, const Vec3& end, double reach, double clear,
                           std::size_t& blocked) {
  const double least = 1e-16 * k.extent().diagonal();
  std::vector<Hold> holds{{start, {(from - start).normalized()}, std::min(0.25 * reach, (from - start).norm())}};
  const auto at = crossings(k, path, start, end, clear);
  for (std::size_t s = 0; s < at.size();) {
    // A needle is crossed where its edges all but touch, as if it were not there: its own plane
    // says nothing.
    std::size_t last = s;
    while (last + 1 < at.size() && (at[last + 1] - at[s]).norm() < 1e-9 * reach) ++last;
    const auto t = k.corners(path[s].first.face);
    holds.push_back({at[s],
                     around_edge(k, path[s].first, path[last + 1].first, t[static_cast<std::size_t>(path[s].second)],
                                 t[static_cast<std::size_t>((path[s].second + 1) % 3)]),
                     0.25 * reach, last});
    s = last + 1;
  }
  holds.push_back({end, {(to - end).normalized()}, std::min(0.25 * reach, (to - end).norm()), at.size()});
  int tries = 0;
  Random random(at.size());
  for (std::size_t h = 0; h < holds.size() && !sight.spent();) {
    // What is blocked is held lower, at its higher end; then what comes before is asked again.
    bool open = true;
    for (std::size_t i = 0; i + 1 < holds[h].off.size() && open; ++i)
      open = !sight.blocked(holds[h].point(i), holds[h].point(i + 1));
    if (open &&
        (h + 1 == holds.size() || !sight.blocked(holds[h].point(holds[h].off.size() - 1), holds[h + 1].point(0)))) {
      ++h;
      continue;
    }
    Hold& high = open && holds[h + 1].height > holds[h].height ? holds[h + 1] : holds[h];
    high.height *= 0.5;
    if (high.height < least) {
      if (tries++ == 250) {
        blocked = high.step;
        return {};
      }
      // Where no point has room a link may have: what is between two points is finer than doubles.
      for (Hold* hold : {&holds[h], open ? &holds[h + 1] : &holds[h]})
        hold->at = hold->aim + 4 * least * random.uniform() * random.direction(),
        hold->height = least * std::exp2(8 * random.uniform());
    }
    h -= h > 0;
  }
  std::vector<Vec3> way{from};
  for (const Hold& hold : holds)
    for (std::size_t i = 0; i < hold.off.size(); ++i) way.push_back(hold.point(i));
  way.push_back(to);
  for (std::size_t s = 0; s + 1 < way.size(); ++s)
    if (sight.blocked(way[s], way[s + 1])) {
      blocked = 0;
      return {};
    }
  return way;
}

}  // namespace

std::vector<Vec3> taut_path(const Complex& k, const Vec3& from, const Vec3& to, double reach) {
  const auto starts = look_around(k, from, reach), ends = look_around(k, to, reach);
  std::set<Step> closed;
  Sight sight(k);
  for (int attempt = 0; attempt < 32 && !sight.spent(); ++attempt) {
    const auto path = sides_between(k, starts, ends, closed);
    if (path.empty()) return {};
    std::size_t blocked = 0;
    for (const double clear : {1.0 / 16, 1.0 / 4, 1.0 / 2}) {
      auto way = way_over(k, sight, path, from, starts.at(path.front().first), to, ends.at(path.back().first), reach,
                          clear, blocked);
      if (!way.empty()) return way;
    }
    if (path.size() == 1) return {};
    closed.insert(path[std::min(blocked, path.size() - 2)]);
  }
  return {};
}

}  // namespace geo
