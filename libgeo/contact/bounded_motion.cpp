#include "contact/bounded_motion.h"

#include <algorithm>
#include <map>
#include <numeric>
#include <utility>

#include "base/parallel.h"
#include "contact/affine_motion.h"
#include "contact/close_pairs.h"
#include "contact/crossing.h"
#include "contact/dividers.h"
#include "contact/parting.h"
#include "contact/smooth_field.h"
#include "contact/straight_motion.h"

namespace geo {
namespace {

// Vertices that move as rigid bodies.
class Zones {
 public:
  explicit Zones(std::size_t vertices) : parent_(vertices), in_(vertices, 0) { std::iota(parent_.begin(), parent_.end(), 0u); }

  bool has(std::uint32_t v) const { return in_[v]; }
  bool same(std::uint32_t v, std::uint32_t w) { return in_[v] && in_[w] && root(v) == root(w); }
  std::size_t count() const { return static_cast<std::size_t>(std::count(in_.begin(), in_.end(), 1)); }
  /// Returns true when this is new.
  bool join(std::uint32_t v, std::uint32_t w) {
    const bool is_new = !same(v, w);
    in_[v] = in_[w] = 1;
    const auto a = root(v), b = root(w);
    parent_[std::max(a, b)] = std::min(a, b);
    return is_new;
  }
  void place(const std::vector<Vec3>& from, const std::vector<Vec3>& to, std::vector<Vec3>& at) {
    std::map<std::uint32_t, std::vector<std::uint32_t>> members;
    for (std::uint32_t v = 0; v < in_.size(); ++v)
      if (in_[v]) members[root(v)].push_back(v);
    for (const auto& [zone, rows] : members) move_rigidly(rows, from, to, at);
  }
 private:
  std::uint32_t root(std::uint32_t v) {
    while (parent_[v] != v) v = parent_[v] = parent_[parent_[v]];
    return v;
  }
  std::vector<std::uint32_t> parent_;
  std::vector<std::uint8_t> in_;
};

class Mover {
 public:
  Mover(const SurfaceMotion& m, bool two_sided, BoundedMotion& report) : m_(m), two_sided_(two_sided), report_(report), at_(m.from), triangles_(m.triangles) {
    std::vector<std::uint8_t> used(m.from.size(), 0);
    for (auto& t : triangles_)
      for (auto& v : t) v = m.together[v], used[v] = 1;
    for (std::uint32_t v = 0; v < used.size(); ++v)
      if (used[v]) rows_.push_back(v);
    for (const auto& [a, b, c] : triangles_) edge_ += (at_[b] - at_[a]).norm() + (at_[c] - at_[b]).norm() + (at_[a] - at_[c]).norm();
    edge_ /= std::max(1.0, 3 * double(triangles_.size()));
  }

  std::vector<Vec3> run() {
    bool whole = false;
    double left = wanting();
    for (int round = 0; round < most_carries && !whole && left > 0; ++round) {
      whole = carry(round);
      for (int i = 0; i < most_advances; ++i) advance();
      const double before = std::exchange(left, wanting());
      if (left > 2 * before / 3) break;  // the rest is blocked
    }
    for (std::size_t v = 0; v < at_.size(); ++v) at_[v] = at_[m_.together[v]];
    return std::move(at_);
  }

 private:
  static constexpr double steepest = 0.6;  // below 1, where a motion need not be one-to-one
  static constexpr int most_carries = 8, most_advances = 2, most_settles = 2, most_growths = 10;

  double wanting() const {
    double sum = 0;
    for (const auto v : rows_) sum += (m_.to[v] - at_[v]).norm();
    return sum;
  }

  // All as one, then by a smooth field: no further than it is one-to-one all the way. True when that was all of it.
  bool carry(int round) {
    std::vector<Vec3> start = at_, by(at_.size(), Vec3::Zero());
    if (round == 0) move_affinely(rows_, at_, m_.to, start);
    for (const auto v : rows_) by[v] = m_.to[v] - start[v];
    const SmoothField field(start, by, rows_, 4 * edge_);
    const double share = std::min(1.0, steepest / std::max(1e-300, field.slope()));
    std::vector<Vec3> next = start;
    parallel_for(rows_.size(), 256, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) next[rows_[i]] += share * field(start[rows_[i]]);
    });
    std::vector<double> deviation(triangles_.size());
    for (std::size_t t = 0; t < triangles_.size(); ++t) {
      const auto& [a, b, c] = triangles_[t];
      deviation[t] = share * field.deviation(std::sqrt(std::max({(start[b] - start[a]).squaredNorm(), (start[c] - start[b]).squaredNorm(), (start[a] - start[c]).squaredNorm()})));
    }
    near(start, next);
    if (!mend(start, deviation, next)) {
      next = start;  // as one body, unless rounding forbids even that
      near(next, next);
      report_.held = !find_crossings(pairs_, triangles_, next, m_.together, two_sided_).empty();
      if (report_.held) next = at_, near(next, next);
    }
    at_ = std::move(next);
    return share == 1;
  }

  Box3 box(std::size_t t, const std::vector<Vec3>& at) const {
    const auto& [a, b, c] = triangles_[t];
    return box_of(at[a], at[b], at[c]);
  }

  // How far planes may let a row go from where it was carried.
  double room(std::uint32_t v, const std::vector<Vec3>& next) const { return std::min(0.5 * edge_, (m_.to[v] - next[v]).norm()); }

  // Triangles that may come together from `start` to `next`, and from there on while no row goes further than its room.
  void near(const std::vector<Vec3>& start, const std::vector<Vec3>& next) {
    boxes_.resize(triangles_.size());
    parallel_for(boxes_.size(), 1024, [&](std::size_t begin, std::size_t end) {
      for (std::size_t t = begin; t < end; ++t) {
        const auto& [a, b, c] = triangles_[t];
        boxes_[t] = box(t, next).grown(std::max({room(a, next), room(b, next), room(c, next)}) + 0.5 * m_.gap);
        boxes_[t].add(box(t, start));
      }
    });
    pairs_ = close_pairs(boxes_);
  }

  // Whether the pairs are those of all triangles that meet.
  bool covered(const std::vector<Vec3>& next) const {
    for (std::size_t t = 0; t < boxes_.size(); ++t) {
      const Box3 now = box(t, next);
      if ((now.lo.array() < boxes_[t].lo.array()).any() || (now.hi.array() > boxes_[t].hi.array()).any()) return false;
    }
    return true;
  }

  // Pairs that may have passed through each other: so near that it matters that triangles are flat, and parted by no direction at
  // both ends.
  std::vector<std::pair<std::uint32_t, std::uint32_t>> passed(std::span<const std::pair<std::uint32_t, std::uint32_t>> pairs, const std::vector<Vec3>& start,
                                                              const std::vector<double>& deviation, const std::vector<Vec3>& next) const {
    std::vector<std::uint8_t> through(pairs.size(), 0);
    parallel_for(pairs.size(), 512, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        const auto &s = triangles_[pairs[i].first], &t = triangles_[pairs[i].second];
        const auto in_t = [&](std::uint32_t v) { return v == t[0] || v == t[1] || v == t[2]; };
        if (in_t(s[0]) || in_t(s[1]) || in_t(s[2])) continue;  // neighbours cannot pass without crossing others
        const Simplex a{{s[0], s[1], s[2]}, 3}, b{{t[0], t[1], t[2]}, 3};
        const double enough = (deviation[pairs[i].first] + deviation[pairs[i].second]) / (1 - steepest);
        through[i] = !some_direction(a, b, start, next, [&](const Vec3& n, double before) { return before > enough * n.norm() || (before > 0 && parted(n, a, b, next) > 0); });
      }
    });
    std::vector<std::pair<std::uint32_t, std::uint32_t>> result;
    for (std::size_t i = 0; i < pairs.size(); ++i)
      if (through[i]) result.push_back(pairs[i]);
    return result;
  }

  // Zones for what crosses or passes, until nothing does; false: in vain.
  bool mend(const std::vector<Vec3>& start, const std::vector<double>& deviation, std::vector<Vec3>& next) {
    Zones zones(at_.size());
    std::vector<std::uint8_t> changed(triangles_.size(), 1);
    std::vector<Box3> ways(triangles_.size());
    std::vector<std::pair<std::uint32_t, std::uint32_t>> meeting;
    const std::vector<Vec3> wanted = next;
    for (int growth = 0;; ++growth) {
      for (std::size_t t = 0; t < ways.size(); ++t) ways[t] = box(t, next), ways[t].add(box(t, start));
      meeting.clear();
      for (const auto& pair : pairs_)
        if ((changed[pair.first] || changed[pair.second]) && ways[pair.first].meets(ways[pair.second])) meeting.push_back(pair);
      auto failing = find_crossings(meeting, triangles_, next, m_.together, two_sided_);
      for (const auto& pair : passed(meeting, start, deviation, next))
        if (!each_row(pair, [&](std::uint32_t v) { return zones.same(triangles_[pair.first][0], v); })) failing.push_back(pair);  // a zone keeps what is inside it apart
      if (failing.empty()) break;
      bool grown = false;
      for (const auto& pair : failing) each_row(pair, [&](std::uint32_t v) { return grown |= zones.join(triangles_[pair.first][0], v), true; });
      if (!grown || growth == most_growths) return false;
      const std::vector<Vec3> before = next;
      zones.place(start, wanted, next);
      const bool known = covered(next);
      if (!known) near(start, next);
      for (std::size_t t = 0; t < changed.size(); ++t)
        changed[t] = !known || std::any_of(triangles_[t].begin(), triangles_[t].end(), [&](auto v) { return next[v] != before[v]; });
    }
    if (zones.count() > 0) near(next, next);
    report_.in_zones = std::max(report_.in_zones, zones.count());
    return true;
  }

  // True when `test` is of all corners of both triangles.
  template <class Test>
  bool each_row(const std::pair<std::uint32_t, std::uint32_t>& pair, const Test& test) const {
    const auto &s = triangles_[pair.first], &t = triangles_[pair.second];
    return std::all_of(s.begin(), s.end(), test) && std::all_of(t.begin(), t.end(), test);
  }

  // Each row goes its own way.
  void advance() {
    parallel_for(boxes_.size(), 1024, [&](std::size_t begin, std::size_t end) {
      for (std::size_t t = begin; t < end; ++t) {
        const auto& [a, b, c] = triangles_[t];
        boxes_[t] = box(t, at_);
        boxes_[t].add(box(t, m_.to));
        boxes_[t] = boxes_[t].grown(std::max({room(a, at_), room(b, at_), room(c, at_)}) + 0.5 * m_.gap);
      }
    });
    pairs_ = close_pairs(boxes_);
    move_straight(triangles_, pairs_, m_.to, m_.gap, at_);
    settle();
  }

  // Rounds of planes.
  void settle() {
    const std::vector<Vec3> start = at_;
    std::vector<double> rooms(at_.size(), 0), limit(at_.size(), 0);
    for (const auto v : rows_) rooms[v] = room(v, start);
    for (int round = 0; round < most_settles; ++round) {
      for (const auto v : rows_) limit[v] = std::min((m_.to[v] - at_[v]).norm(), std::max(0.0, rooms[v] - (at_[v] - start[v]).norm()));
      const DividerWork done = move_divided({triangles_, pairs_, m_.to, limit, m_.gap}, at_);
      report_.planes += done.planes, ++report_.rounds;
      if (done.farthest < m_.gap) break;
    }
  }

  const SurfaceMotion& m_;
  bool two_sided_;
  BoundedMotion& report_;
  std::vector<Vec3> at_;
  std::vector<Triangle> triangles_;  // of rows that stand for others
  std::vector<std::uint32_t> rows_;  // those, ascending
  double edge_ = 0;
  std::vector<Box3> boxes_;  // that the pairs are of
  std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs_;
};

}  // namespace

std::vector<Vec3> move_without_crossing(const SurfaceMotion& motion, bool two_sided, BoundedMotion* told) {
  BoundedMotion own;
  return Mover(motion, two_sided, told ? *told : own).run();
}

}  // namespace geo
