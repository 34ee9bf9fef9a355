#include "contact/bounded_motion.h"

#include <algorithm>
#include <map>
#include <numeric>

#include "base/parallel.h"
#include "contact/affine_motion.h"
#include "contact/close_pairs.h"
#include "contact/crossing.h"
#include "contact/dividers.h"
#include "contact/give_way.h"
#include "contact/parting_lanes.h"
#include "contact/smooth_field.h"
#include "contact/straight_motion.h"
#include "contact/tilted.h"
#include "contact/triangle_planes.h"

namespace geo {
namespace {

// Vertices that move as rigid bodies.
class Zones {
 public:
  explicit Zones(std::size_t vertices) : parent_(vertices), in_(vertices, 0) { std::iota(parent_.begin(), parent_.end(), 0u); }

  bool has(std::uint32_t v) const { return in_[v]; }
  bool same(std::uint32_t v, std::uint32_t w) const { return in_[v] && in_[w] && root(v) == root(w); }
  std::size_t count() const { return static_cast<std::size_t>(std::count(in_.begin(), in_.end(), 1)); }
  /// Returns true when this is new.
  bool join(std::uint32_t v, std::uint32_t w) {
    const bool is_new = !same(v, w);
    in_[v] = in_[w] = 1;
    const auto a = root(v), b = root(w), least = std::min(a, b);
    parent_[std::max(a, b)] = parent_[v] = parent_[w] = least;
    return is_new;
  }
  void place(const std::vector<Vec3>& from, const std::vector<Vec3>& to, std::vector<Vec3>& at) {
    std::map<std::uint32_t, std::vector<std::uint32_t>> members;
    for (std::uint32_t v = 0; v < in_.size(); ++v)
      if (in_[v]) members[root(v)].push_back(v);
    for (const auto& [zone, rows] : members) move_rigidly(rows, from, to, at);
  }
 private:
  std::uint32_t root(std::uint32_t v) const {
    while (parent_[v] != v) v = parent_[v];
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
    for (const auto v : rows_) size_ = std::max({size_, m.from[v].cwiseAbs().maxCoeff(), m.to[v].cwiseAbs().maxCoeff()});
  }

  std::vector<Vec3> run() {
    for (int round = 0; round < most_rounds && wanting(); ++round) {
      const Way way = advance(round);
      if (way == Way::free) break;
      settle();
      if (way == Way::carried) break;
    }
    for (std::size_t v = 0; v < at_.size(); ++v) at_[v] = at_[m_.together[v]];
    return std::move(at_);
  }

 private:
  using Pair = std::pair<std::uint32_t, std::uint32_t>;
  static constexpr double steepest = 0.6;  // below 1, where a motion need not be one-to-one
  static constexpr double negligible = 0.01, farthest = 0.1;  // of an edge: not worth a plane, and as far as planes let one go
  static constexpr double spare = 0.05;  // of an edge: so that what is carried further stays in its box
  static constexpr int most_rounds = 8, most_mendings = 20, growths_apart = 10, most_growths = 20;

  bool wanting() const {
    return std::any_of(rows_.begin(), rows_.end(), [&](auto v) { return at_[v] != m_.to[v]; });
  }

  // Straight to where all want to be; what would cross or pass something is carried along instead, and left behind where the field
  // would be too steep.
  enum class Way { free, carried, behind };
  Way advance(int round) {
    std::vector<Vec3> start = at_;
    if (round == 0) move_affinely(rows_, at_, m_.to, start);
    std::vector<Vec3> next = start;
    for (const auto v : rows_) next[v] = m_.to[v];
    near(start, next);
    if (give_way(start, next)) {
      at_ = std::move(next);
      return Way::free;
    }
    for (const auto v : rows_) next[v] = m_.to[v];
    near(start, next);
    Carried carried(at_.size());
    std::vector<std::uint8_t> changed(triangles_.size(), 1);
    for (int growth = 0;; ++growth) {
      const auto failing = failing_pairs(start, next, carried, changed);
      if (failing.empty()) break;
      if (carried.field.empty()) carry(start, carried);
      bool grown = false;
      const std::vector<std::uint8_t> was = carried.is;
      for (const Pair& pair : failing) grown |= carried.add(triangles_[pair.first], triangles_[pair.second], was);
      if (growth == growths_apart)
        for (const auto v : rows_) grown |= !carried.is[v], carried.is[v] = 1;
      if (!grown || growth == most_growths) {
        together(start, next);
        break;
      }
      const std::vector<Vec3> before = next;
      for (const auto v : rows_)
        if (carried.is[v]) next[v] = carried.field[v];
      carried.zones.place(start, carried.field, next);
      mark(before, next, changed);
      near_again(next, changed);
    }
    report_.in_zones = std::max(report_.in_zones, carried.zones.count());
    at_ = std::move(next);
    return carried.share == 1 ? Way::carried : Way::behind;
  }

  // Mends where all want to go until nothing would cross or pass anything; false: something would all the same.
  bool give_way(const std::vector<Vec3>& start, std::vector<Vec3>& next) {
    GiveWay couples(triangles_, start, m_.gap);
    const Carried none(at_.size());
    std::vector<std::uint8_t> changed(triangles_.size(), 1);
    for (int round = 0; round < most_mendings; ++round) {
      const auto failing = failing_pairs(start, next, none, changed);
      if (failing.empty()) return true;
      const std::vector<Vec3> before = next;
      couples.add(failing, next);
      couples.push(next);
      if (next == before) return false;
      mark(before, next, changed);
      for (const auto& [s, t] : failing) changed[s] = changed[t] = 1;  // they may not have been moved
      near_again(next, changed);
    }
    return false;
  }

  // Triangles of which a corner has another place.
  void mark(const std::vector<Vec3>& before, const std::vector<Vec3>& next, std::vector<std::uint8_t>& changed) const {
    for (std::size_t t = 0; t < changed.size(); ++t)
      changed[t] = std::any_of(triangles_[t].begin(), triangles_[t].end(), [&](auto v) { return next[v] != before[v]; });
  }

  // What does not go straight.
  struct Carried {
    explicit Carried(std::size_t vertices) : is(vertices, 0), zones(vertices) {}
    // All corners of a failing pair; in a zone when the field has carried them already. True when that is new.
    bool add(const Triangle& s, const Triangle& t, const std::vector<std::uint8_t>& was) {
      bool grown = false, all = true;
      for (const Triangle* of : {&s, &t})
        for (const auto v : *of) all &= was[v] != 0;
      for (const Triangle* of : {&s, &t})
        for (const auto v : *of) {
          if (all)
            grown |= zones.join(s[0], v);
          else
            grown |= !is[v], is[v] = 1;
        }
      return grown;
    }
    std::vector<std::uint8_t> is;
    std::vector<Vec3> field;        // where it carries each row
    std::vector<double> deviation;  // per triangle, of its inside
    double share = 1;
    Zones zones;
  };

  // A smooth field of what rows want, no further than it is one-to-one all the way.
  void carry(const std::vector<Vec3>& start, Carried& c) const {
    std::vector<Vec3> by(at_.size(), Vec3::Zero());
    for (const auto v : rows_) by[v] = m_.to[v] - start[v];
    const SmoothField field(start, by, rows_, 4 * edge_);
    c.share = std::min(1.0, steepest / std::max(1e-300, field.slope()));
    c.field = start;
    parallel_for(rows_.size(), 256, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) c.field[rows_[i]] += c.share * field(start[rows_[i]]);
    });
    c.deviation.resize(triangles_.size());
    for (std::size_t t = 0; t < triangles_.size(); ++t) {
      const auto& [i, j, k] = triangles_[t];
      c.deviation[t] = c.share * field.deviation(std::sqrt(std::max({(start[j] - start[i]).squaredNorm(), (start[k] - start[j]).squaredNorm(), (start[i] - start[k]).squaredNorm()})));
    }
  }

  // As one body, unless rounding forbids even that.
  void together(const std::vector<Vec3>& start, std::vector<Vec3>& next) {
    next = start;
    near(next, next);
    report_.held = !find_crossings(pairs_, triangles_, next, m_.together, two_sided_).empty();
    if (report_.held) next = at_;
  }

  Box3 box(std::size_t t, const std::vector<Vec3>& at) const {
    const auto& [a, b, c] = triangles_[t];
    return box_of(at[a], at[b], at[c]);
  }

  // Triangles that may come together from `start` to `next`.
  void near(const std::vector<Vec3>& start, const std::vector<Vec3>& next) {
    std::vector<Box3> boxes(triangles_.size());
    parallel_for(boxes.size(), 1024, [&](std::size_t begin, std::size_t end) {
      for (std::size_t t = begin; t < end; ++t) boxes[t] = box(t, next), boxes[t].add(box(t, start));
    });
    tree_ = BoxTree(std::move(boxes));
    pairs_ = tree_.pairs();
  }

  // The same, when only these triangles have another `next`.
  void near_again(const std::vector<Vec3>& next, const std::vector<std::uint8_t>& changed) {
    std::vector<std::uint8_t> outside(triangles_.size(), 0);
    bool any = false;
    for (std::uint32_t t = 0; t < triangles_.size(); ++t) {
      if (!changed[t]) continue;
      const Box3 now = box(t, next), &known = tree_.boxes()[t];
      if (!(now.lo.array() < known.lo.array()).any() && !(now.hi.array() > known.hi.array()).any()) continue;
      outside[t] = 1, any = true;
      tree_.enlarge(t, now.grown(spare * edge_));
    }
    if (!any) return;
    std::erase_if(pairs_, [&](const Pair& p) { return outside[p.first] || outside[p.second]; });
    const auto more = tree_.pairs(&outside);
    pairs_.insert(pairs_.end(), more.begin(), more.end());
  }

  // Among pairs with a changed triangle, those that cross at the end, or may have passed through each other on the way. That they
  // have not is clear where one direction parts them at both ends by more than rounding; the field does not let them pass, either,
  // when they are farther from each other than it deviates.
  std::vector<Pair> failing_pairs(const std::vector<Vec3>& start, const std::vector<Vec3>& next, const Carried& carried, const std::vector<std::uint8_t>& changed) const {
    enum : std::uint8_t { clear, unsure, through };
    const TrianglePlanes planes(triangles_, start, next);
    const double rounding = 1e-14 * size_;
    std::vector<Pair> asked;
    for (const Pair& pair : pairs_)
      if (changed[pair.first] || changed[pair.second]) asked.push_back(pair);
    std::vector<std::uint8_t> found(asked.size(), clear);
    parallel_for(asked.size(), 512, [&](std::size_t begin, std::size_t end) {
      const auto judge = [&](std::size_t i, const Partings& p, std::size_t lane) {
        for (int k = 0; k < Partings::count; ++k)
          if (p.first[k][lane] > rounding && p.last[k][lane] > rounding) return;
        if (some_tilted(couple(asked[i]), p, lane, start, next, [&](const Vec3&, double first, double last) { return first > rounding && last > rounding; })) return;
        const auto &s = triangles_[asked[i].first], &t = triangles_[asked[i].second];
        const auto each = [&](const auto& test) { return test(s[0]) && test(s[1]) && test(s[2]) && test(t[0]) && test(t[1]) && test(t[2]); };
        const bool by_field = !carried.field.empty() && each([&](std::uint32_t v) { return carried.is[v] != 0; });
        const bool parted = by_field && p.first[Partings::closest][lane] > (carried.deviation[asked[i].first] + carried.deviation[asked[i].second]) / (1 - steepest);
        found[i] = parted || (by_field && in_one_zone(carried.zones, s, t)) ? unsure : through;
      };
      CouplesInLanes<decltype(judge)> couples(start, next, true, judge);
      for (std::size_t i = begin; i < end; ++i) {
        const auto& [p, q] = asked[i];
        const auto &s = triangles_[p], &t = triangles_[q];
        const auto in_t = [&](std::uint32_t v) { return v == t[0] || v == t[1] || v == t[2]; };
        if (in_t(s[0]) || in_t(s[1]) || in_t(s[2]))
          found[i] = unsure;  // neighbours cannot pass without crossing others
        else if (!planes.part(p, q, rounding, rounding)) {
          const Couple both = couple(asked[i]);
          if (const Parting across = part_across(both, start, next); !(across.first > rounding && across.last > rounding)) couples.add(both, i);
        }
      }
      couples.finish();
    });
    std::vector<Pair> result, test;
    for (std::size_t i = 0; i < asked.size(); ++i) {
      if (found[i] == through) result.push_back(asked[i]);
      if (found[i] == unsure) test.push_back(asked[i]);
    }
    const auto crossing = find_crossings(test, triangles_, next, m_.together, two_sided_);
    result.insert(result.end(), crossing.begin(), crossing.end());
    return result;
  }

  Couple couple(const Pair& p) const {
    const auto simplex = [&](std::uint32_t t) { return Simplex{{triangles_[t][0], triangles_[t][1], triangles_[t][2]}, 3}; };
    return {simplex(p.first), simplex(p.second)};
  }

  // A zone keeps what is inside it apart.
  static bool in_one_zone(const Zones& zones, const Triangle& s, const Triangle& t) {
    const auto in = [&](std::uint32_t v) { return zones.same(s[0], v); };
    return in(s[1]) && in(s[2]) && in(t[0]) && in(t[1]) && in(t[2]);
  }

  // For those that are not where they want to be: straight on where nothing is in the way, then as far as planes let them go.
  void settle() {
    std::vector<double> room(at_.size(), 0);
    std::vector<Vec3> to = at_;
    for (const auto v : rows_)
      if (const double way = (m_.to[v] - at_[v]).norm(); way > negligible * edge_) room[v] = std::min(farthest * edge_, way), to[v] = m_.to[v];
    std::vector<std::uint8_t> moving(triangles_.size(), 0);
    std::vector<Box3> boxes(triangles_.size());
    for (std::size_t t = 0; t < triangles_.size(); ++t) {
      double most = 0;
      for (const auto v : triangles_[t]) most = std::max(most, room[v]);
      moving[t] = most > 0, boxes[t] = box(t, at_);
      if (moving[t]) boxes[t].add(box(t, to));
      boxes[t] = boxes[t].grown(most + 0.5 * m_.gap);
    }
    if (std::count(moving.begin(), moving.end(), 1) == 0) return;
    pairs_ = close_pairs(std::move(boxes), &moving);
    move_straight(triangles_, pairs_, to, m_.gap, at_);
    for (const auto v : rows_) room[v] = std::min(room[v], (to[v] - at_[v]).norm());
    report_.planes += move_divided({triangles_, pairs_, to, room, m_.gap}, at_);
  }

  const SurfaceMotion& m_;
  bool two_sided_;
  BoundedMotion& report_;
  std::vector<Vec3> at_;
  std::vector<Triangle> triangles_;  // of rows that stand for others
  std::vector<std::uint32_t> rows_;  // those, ascending
  double edge_ = 0, size_ = 0;
  BoxTree tree_;             // that the pairs are of
  std::vector<Pair> pairs_;
};

}  // namespace

std::vector<Vec3> move_without_crossing(const SurfaceMotion& motion, bool two_sided, BoundedMotion* told) {
  BoundedMotion own;
  return Mover(motion, two_sided, told ? *told : own).run();
}

}  // namespace geo
