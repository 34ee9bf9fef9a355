#include "contact/motion/bounded_motion.h"

#include <algorithm>
#include <numeric>
#include <optional>

#include "contact/detection/find_crossings.h"
#include "contact/detection/motion_certifier.h"
#include "contact/motion/fallback_motion.h"
#include "contact/motion/separation_projection.h"
#include "contact/motion/vertex_advance.h"
#include "geometry/affine_fit.h"
#include "kerf/parallel.h"

namespace geo {
namespace {

class Mover {
 public:
  Mover(const SurfaceMotion& m, bool two_sided, BroadPhase& near, const VertexFans& fans, BoundedMotionStats& report)
      : m_(m), two_sided_(two_sided), near_(near), fans_(fans), report_(report), surface_(m), at_(m.from) {
    edge_ = mean_edge();
    double size = 0;
    for (const auto v : surface_.vertices)
      size = std::max({size, m.from[v].cwiseAbs().maxCoeff(), m.to[v].cwiseAbs().maxCoeff()});
    rounding_ = 1e-14 * size;
  }

  std::vector<Vec3> run() {
    for (int round = 0; round < most_rounds && wanting(); ++round) {
      const Way way = advance(round);
      if (way == Way::free) break;
      report_.planes += advance_vertices(surface_.triangles, m_.to, edge_, m_.gap, at_);
      if (way == Way::carried) break;
    }
    for (std::size_t v = 0; v < at_.size(); ++v) at_[v] = at_[m_.representative[v]];
    return std::move(at_);
  }

 private:
  static constexpr double spare = 0.05;  // of an edge: so that what is carried further stays in its box
  static constexpr int most_rounds = 8, most_mendings = 240, patience = 6, growths_apart = 10, most_growths = 20;

  // Sums of stretches one after the other, the same for any number of threads.
  double mean_edge() const {
    constexpr std::size_t stretch = 2048;
    std::vector<double> sums((surface_.triangles.size() + stretch - 1) / stretch, 0);
    parallel_for(sums.size(), 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t t = begin * stretch; t < std::min(surface_.triangles.size(), end * stretch); ++t) {
        const auto& [a, b, c] = surface_.triangles[t];
        sums[t / stretch] += (at_[b] - at_[a]).norm() + (at_[c] - at_[b]).norm() + (at_[a] - at_[c]).norm();
      }
    });
    return std::accumulate(sums.begin(), sums.end(), 0.0) / std::max(1.0, 3 * double(surface_.triangles.size()));
  }

  bool wanting() const {
    return std::any_of(surface_.vertices.begin(), surface_.vertices.end(), [&](auto v) { return at_[v] != m_.to[v]; });
  }

  // Straight to where all want to be; what would cross or pass something is carried along instead,
  // and left behind where the field would be too steep.
  enum class Way { free, carried, behind };
  Way advance(int round) {
    std::vector<Vec3> start = at_;
    if (round == 0) apply_affine_fit(surface_.vertices, at_, m_.to, start);
    std::vector<Vec3> next = straight(start, round == 0 && m_.guess ? *m_.guess : m_.to);
    cover(start, next);
    if (give_way(start, next)) {
      at_ = std::move(next);
      return Way::free;
    }
    next = straight(start, m_.to);
    cover(start, next);
    MotionCertifier check({surface_, fans_, m_.representative, two_sided_, start, next, rounding_}, near_.planes());
    std::optional<FallbackMotion> carried;
    const MotionCertifier::KnownDisjoint keep_apart = [&](std::uint32_t s, std::uint32_t t, double distance) {
      return carried && carried->keeps_apart(s, t, distance);
    };
    std::vector<std::uint8_t> changed(surface_.triangles.size(), 1);
    for (int growth = 0;; ++growth) {
      const auto failing = check.uncertified_pairs(near_.pairs(), changed, keep_apart);
      if (failing.empty()) break;
      if (!carried) carried.emplace(surface_.triangles, surface_.vertices, start, m_.to, edge_);
      bool grown = carried->add(failing);
      if (growth == growths_apart) grown |= carried->add_all();
      if (!grown || growth == most_growths) {
        move_as_one(start, next);
        break;
      }
      const std::vector<Vec3> before = next;
      carried->apply(next);
      mark(before, next, changed);
      cover(start, next, &changed);
    }
    if (carried) report_.in_zones = std::max(report_.in_zones, carried->in_zones());
    at_ = std::move(next);
    return !carried || carried->share() == 1 ? Way::carried : Way::behind;
  }

  std::vector<Vec3> straight(const std::vector<Vec3>& start, const std::vector<Vec3>& to) const {
    std::vector<Vec3> next = start;
    for (const auto v : surface_.vertices) next[v] = to[v];
    return next;
  }

  // Mends where all want to go until nothing would cross or pass anything; false: something would
  // all the same.
  bool give_way(const std::vector<Vec3>& start, std::vector<Vec3>& next) {
    SeparationProjection couples(surface_.triangles, start, m_.gap);
    MotionCertifier check({surface_, fans_, m_.representative, two_sided_, start, next, rounding_}, near_.planes());
    const MotionCertifier::KnownDisjoint bound = [&](std::uint32_t s, std::uint32_t t, double) {
      return couples.bound(s, t);
    };
    std::vector<std::uint8_t> changed(surface_.triangles.size(), 1);
    std::size_t many = ~std::size_t(0);
    int since = 0;  // the round in which so many failed
    bool free = false;
    for (int round = 0; round < most_mendings; ++round) {
      const auto failing = check.uncertified_pairs(near_.pairs(), changed, bound);
      free = failing.empty();
      if (free) break;
      if (failing.size() < many - many / 4) many = failing.size(), since = round;
      const std::vector<Vec3> before = next;
      if (round - since < patience)
        couples.add(failing, next);
      else
        couples.bind(failing), many = failing.size(), since = round;
      couples.push(next);
      if (next == before) {
        if (!couples.bind(failing)) break;
        couples.push(next);
      }
      mark(before, next, changed);
      for (const auto& [s, t] : failing) changed[s] = changed[t] = 1;  // they may not have been moved
      cover(start, next, &changed);
    }
    report_.in_zones = std::max(report_.in_zones, couples.in_zones());
    return free;
  }

  // Triangles of which a corner has another place.
  void mark(const std::vector<Vec3>& before, const std::vector<Vec3>& next, std::vector<std::uint8_t>& changed) const {
    std::vector<std::uint8_t> moved(next.size(), 0);
    for (const auto v : surface_.vertices) moved[v] = next[v] != before[v];
    for (std::size_t t = 0; t < changed.size(); ++t) {
      const auto& [a, b, c] = surface_.triangles[t];
      changed[t] = moved[a] | moved[b] | moved[c];
    }
  }

  // As one body, unless rounding forbids even that.
  void move_as_one(const std::vector<Vec3>& start, std::vector<Vec3>& next) {
    next = start;
    cover(next, next);
    std::vector<BroadPhase::Pair> pairs = near_.pairs();
    for (std::uint32_t v = 0; v < fans_.size(); ++v)
      fans_.for_each_pair(
          v, [v](std::uint32_t w) { return w < v; },
          [&](std::uint32_t s, std::uint32_t t) {
            pairs.push_back({s, t});
          });
    report_.held = !find_crossings(pairs, surface_.triangles, next, m_.representative, two_sided_).empty();
    if (report_.held) next = at_;
  }

  // Sees to it that all pairs are there that may come together from `start` to `next`; only these
  // triangles have another `next`.
  void cover(const std::vector<Vec3>& start, const std::vector<Vec3>& next,
             const std::vector<std::uint8_t>* changed = nullptr) {
    near_.update(
        m_.triangles, [&](std::size_t t) { return surface_.swept_box(t, start, next); }, spare * edge_, changed);
  }

  const SurfaceMotion& m_;
  bool two_sided_;
  BroadPhase& near_;
  const VertexFans& fans_;
  BoundedMotionStats& report_;
  RepresentativeSurface surface_;
  std::vector<Vec3> at_;
  double edge_ = 0, rounding_ = 0;
};

}  // namespace

std::vector<Vec3> move_without_crossing(const SurfaceMotion& motion, bool two_sided, BoundedMotionStats* told,
                                        BroadPhase* near, const VertexFans* fans) {
  BoundedMotionStats own;
  BroadPhase pairs;
  if (!fans) {
    const VertexFans made(motion.triangles, motion.from.size());
    return move_without_crossing(motion, two_sided, told, near, &made);
  }
  return Mover(motion, two_sided, near ? *near : pairs, *fans, told ? *told : own).run();
}

}  // namespace geo
