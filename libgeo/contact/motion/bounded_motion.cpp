// Rounds of affine motion, projected targets, and fallback; each motion is accepted only if it is
// certified (motion_certifier.h). The last resort is the affine motion alone, or none.
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

// Limits of effort. None changes whether something crosses: the fallback and the exact test follow.
// They bound what one step may cost where walls are pressed far into each other (decision 083).
//
// Progress is a quarter fewer uncertified pairs. Without it for `patience` projections, pairs turn
// rigid. If each progress takes all its patience, 240 projections make 240 / 6 = 40 of them, and
// (3/4)⁴⁰ = 1e-5 leaves one pair of a hundred thousand.
constexpr std::size_t progress_divisor = 4;
constexpr int patience = 6;
constexpr int max_projections = 240;  // in all rounds; what is left takes the fallback
// Four for each of 240 projections, rounded. Triangles have more only where a motion takes them far
// past each other.
constexpr int max_evaluations = 1000;  // of constraints, per triangle, in all projections; then no further round
// The tracking error that is left after them is made up in the next time steps. More rounds bring a
// vertex nearer to its target sooner, and cost more.
constexpr int max_rounds = 8;
// The fallback's set of vertices grows while its own motion makes triangles cross. After half of
// the growths all vertices follow the field; after all of them, everything moves as one.
constexpr int max_growths = 20;
constexpr int growths_to_follow = 10;
// Margin of boxes in the broad phase, in edges: projected vertices mostly stay within it. Larger:
// more pairs, fewer new queries, the same result.
constexpr double box_margin = 0.05;
// Error bound of separations over the size of coordinates: 45 ulps of 2⁻⁵², more than the rounding
// of the products n · x and their difference.
constexpr double relative_rounding = 1e-14;

class CrossingFreeMotion {
 public:
  CrossingFreeMotion(const SurfaceMotion& m, bool two_sided, BroadPhase& near, const VertexFans& fans,
                     BoundedMotionStats& stats)
      : m_(m),
        still_(m.still),
        two_sided_(two_sided),
        near_(near),
        fans_(fans),
        stats_(stats),
        surface_(m),
        at_(m.from) {
    edge_ = mean_edge();
    double size = 0;
    for (const auto v : surface_.vertices)
      size = std::max({size, m.from[v].cwiseAbs().maxCoeff(), m.to[v].cwiseAbs().maxCoeff()});
    rounding_ = relative_rounding * size;
  }

  std::vector<Vec3> run() {
    for (int round = 0; round < max_rounds && !arrived(); ++round) {
      const bool guessed = round == 0 && m_.guess;
      const Outcome outcome = advance(round);
      if (outcome == Outcome::free) {
        // Without an obstacle, the guess alone keeps a vertex off its target.
        if (guessed) advance_free_vertices(surface_.triangles, m_.to, edge_, m_.gap, at_);
        break;
      }
      stats_.planes += advance_vertices(surface_.triangles, m_.to, edge_, m_.gap, at_);
      if (outcome == Outcome::fallback || evaluations_left() == 0) break;
    }
    stats_.evaluations += evaluations_;
    for (std::size_t v = 0; v < at_.size(); ++v) at_[v] = at_[m_.representative[v]];
    return std::move(at_);
  }

 private:
  // How a round ended. free: all vertices went straight to their projected targets. fallback: some
  // followed the fallback's field, unscaled, or another round would end as this one. scaled_down:
  // motion or field were scaled by a share < 1.
  enum class Outcome { free, fallback, scaled_down };

  // Chunked sums, the same for any number of threads.
  double mean_edge() const {
    constexpr std::size_t chunk = 2048;
    std::vector<double> sums((surface_.triangles.size() + chunk - 1) / chunk, 0);
    parallel_for(sums.size(), 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t t = begin * chunk; t < std::min(surface_.triangles.size(), end * chunk); ++t) {
        const auto& [a, b, c] = surface_.triangles[t];
        sums[t / chunk] += (at_[b] - at_[a]).norm() + (at_[c] - at_[b]).norm() + (at_[a] - at_[c]).norm();
      }
    });
    return std::accumulate(sums.begin(), sums.end(), 0.0) / std::max(1.0, 3 * double(surface_.triangles.size()));
  }

  bool arrived() const {
    return std::none_of(surface_.vertices.begin(), surface_.vertices.end(), [&](auto v) { return at_[v] != m_.to[v]; });
  }

  std::size_t evaluations_left() const {
    const std::size_t most = max_evaluations * surface_.triangles.size();
    return most - std::min(most, evaluations_);
  }

  Outcome advance(int round) {
    std::vector<Vec3> start = at_;
    if (round == 0 && still_.empty()) apply_affine_fit(surface_.vertices, at_, m_.to, start);
    std::vector<Vec3> next = straight(start, round == 0 && m_.guess ? *m_.guess : m_.to);
    const double share = shorten(start, next);
    if (project_targets(start, next)) {
      at_ = std::move(next);
      return share == 1 ? Outcome::free : share > 0 ? Outcome::scaled_down : Outcome::fallback;
    }
    return fall_back(start);
  }

  // Finds near pairs for the largest share of a motion without too many of them, which becomes the
  // motion. Returns this share.
  double shorten(const std::vector<Vec3>& start, std::vector<Vec3>& next) {
    std::vector<Vec3> part;
    const std::vector<Vec3>* end = &next;
    const double share = near_.update_for_share(
        m_.triangles, [&](std::size_t t) { return surface_.swept_box(t, start, *end); }, box_margin * edge_,
        [&](double s) {
          part = share_of_motion(surface_.vertices, start, next, s);
          end = &part;
        });
    if (share < 1) next = std::move(part);
    return share;
  }

  // The end of a straight motion of all vertices in use.
  std::vector<Vec3> straight(const std::vector<Vec3>& start, const std::vector<Vec3>& to) const {
    return share_of_motion(surface_.vertices, start, to, 1);
  }

  MotionCertifier certifier(const std::vector<Vec3>& start, const std::vector<Vec3>& next) {
    return {{.surface = surface_,
             .fans = fans_,
             .representative = m_.representative,
             .two_sided = two_sided_,
             .start = start,
             .next = next,
             .rounding = rounding_},
            near_.planes()};
  }

  // Changes `next` until the motion from `start` is certified. Returns whether it is.
  bool project_targets(const std::vector<Vec3>& start, std::vector<Vec3>& next) {
    SeparationProjection projection(surface_.triangles, start, m_.gap, still_);
    MotionCertifier certify = certifier(start, next);
    const MotionCertifier::KnownDisjoint rigid = [&](std::uint32_t s, std::uint32_t t, double) {
      return projection.is_rigid(s, t);
    };
    std::vector<std::uint8_t> changed = all_changed();
    std::size_t fewest = ~std::size_t(0);  // uncertified pairs at the last progress
    int last_progress = 0;                 // the iteration of it
    bool certified = false;
    for (int i = 0; projections_ < max_projections && evaluations_left() > 0; ++i, ++projections_) {
      const auto uncertified = certify.uncertified_pairs(near_.pairs(), changed, rigid);
      certified = uncertified.empty();
      if (certified) break;
      if (uncertified.size() < fewest - fewest / progress_divisor) {
        fewest = uncertified.size();
        last_progress = i;
      }
      const std::vector<Vec3> before = next;
      const bool patient = i - last_progress < patience;
      if (!patient && !still_.empty()) break;  // the fallback moves what sleeps, too
      if (patient)
        projection.add(uncertified, next);
      else {
        projection.make_rigid(uncertified);
        fewest = uncertified.size();
        last_progress = i;
      }
      evaluations_ += projection.project(next, evaluations_left());
      if (next == before) {
        if (!still_.empty() || !projection.make_rigid(uncertified)) break;
        evaluations_ += projection.project(next, evaluations_left());
      }
      mark_changed(before, next, uncertified, changed);
      if (!update_near(start, next, changed)) break;
    }
    stats_.in_zones = std::max(stats_.in_zones, projection.in_zones());
    return certified && stay(start, next);
  }

  // Whether no zone has moved what is still, whose pairs are not looked at.
  bool stay(const std::vector<Vec3>& start, const std::vector<Vec3>& next) const {
    for (std::size_t v = 0; v < still_.size(); ++v)
      if (still_[v] && next[v] != start[v]) return false;
    return true;
  }

  // Moves at_ from `start`, by the fallback where the straight motion is not certified.
  Outcome fall_back(const std::vector<Vec3>& start) {
    if (!still_.empty()) near_.select({});
    still_ = {};
    std::vector<Vec3> next = straight(start, m_.to);
    const double share = shorten(start, next);
    const std::vector<Vec3> to = next;
    bool moves_as_one = false;
    MotionCertifier certify = certifier(start, next);
    std::optional<FallbackMotion> fallback;
    const MotionCertifier::KnownDisjoint kept_apart = [&](std::uint32_t s, std::uint32_t t, double distance) {
      return fallback && fallback->keeps_apart(s, t, distance);
    };
    std::vector<std::uint8_t> changed(surface_.triangles.size(), 1);
    for (int growth = 0;; ++growth) {
      const auto uncertified = certify.uncertified_pairs(near_.pairs(), changed, kept_apart);
      if (uncertified.empty()) break;
      if (!fallback) fallback.emplace(surface_.triangles, surface_.vertices, start, to, edge_);
      bool grown = fallback->add(uncertified);
      if (growth == growths_to_follow) grown |= fallback->add_all();
      moves_as_one = !grown || growth == max_growths;
      if (moves_as_one) break;
      const std::vector<Vec3> before = next;
      fallback->apply(next);
      mark_changed(before, next, uncertified, changed);
      moves_as_one = !update_near(start, next, changed);
      if (moves_as_one) break;
    }
    if (moves_as_one) move_as_one(start, next);
    if (fallback) stats_.in_zones = std::max(stats_.in_zones, fallback->in_zones());
    at_ = std::move(next);
    if (share < 1) return share == 0 || moves_as_one ? Outcome::fallback : Outcome::scaled_down;
    return !fallback || fallback->share() == 1 ? Outcome::fallback : Outcome::scaled_down;
  }

  // Marks triangles whose pairs are to be tested again: with a vertex that has moved, and those of
  // pairs that were not certified, though nothing has moved them.
  void mark_changed(const std::vector<Vec3>& before, const std::vector<Vec3>& next,
                    std::span<const BroadPhase::Pair> uncertified, std::vector<std::uint8_t>& changed) const {
    std::vector<std::uint8_t> moved(next.size(), 0);
    for (const auto v : surface_.vertices) moved[v] = next[v] != before[v];
    for (std::size_t t = 0; t < changed.size(); ++t) {
      const auto& [a, b, c] = surface_.triangles[t];
      changed[t] = moved[a] | moved[b] | moved[c];
    }
    for (const auto& [s, t] : uncertified) changed[s] = changed[t] = 1;
  }

  // Last resort: the affine motion alone, which crosses nothing but for rounding; if rounding makes
  // it cross, no motion.
  void move_as_one(const std::vector<Vec3>& start, std::vector<Vec3>& next) {
    next = start;
    near_.update(m_.triangles, swept(next, next), box_margin * edge_);
    std::vector<BroadPhase::Pair> pairs = near_.pairs();
    for (std::uint32_t v = 0; v < fans_.size(); ++v)
      fans_.for_each_pair(
          v, [v](std::uint32_t w) { return w < v; },
          [&](std::uint32_t s, std::uint32_t t) {
            pairs.push_back({s, t});
          });
    stats_.held = !find_crossings(pairs, surface_.triangles, next, m_.representative, two_sided_).empty();
    if (stats_.held) next = at_;
  }

  // Makes near_ a superset of the pairs that may meet between `start` and `next`. Only triangles
  // marked in `changed` have another `next` than before. Returns whether they are few enough for a
  // motion; if not, near_ has none.
  bool update_near(const std::vector<Vec3>& start, const std::vector<Vec3>& next,
                   const std::vector<std::uint8_t>& changed) {
    return near_.update(m_.triangles, swept(start, next), box_margin * edge_, &changed, near_.most_of_motion());
  }

  // The boxes that triangles sweep.
  std::function<Box3(std::size_t)> swept(const std::vector<Vec3>& start, const std::vector<Vec3>& next) const {
    return [&](std::size_t t) { return surface_.swept_box(t, start, next); };
  }

  // Triangles whose end is to be certified first.
  std::vector<std::uint8_t> all_changed() const {
    return still_.empty() ? std::vector<std::uint8_t>(surface_.triangles.size(), 1)
                          : moving_triangles(m_.triangles, still_);
  }

  const SurfaceMotion& m_;
  std::span<const std::uint8_t> still_;  // as SurfaceMotion::still, until the fallback moves all
  bool two_sided_;
  BroadPhase& near_;
  const VertexFans& fans_;
  BoundedMotionStats& stats_;
  RepresentativeSurface surface_;
  std::vector<Vec3> at_;            // per vertex; current for representatives only
  double edge_ = 0, rounding_ = 0;  // model units
  int projections_ = 0;             // so far
  std::size_t evaluations_ = 0;     // of constraints, in all projections
};

}  // namespace

std::vector<Vec3> move_without_crossing(const SurfaceMotion& motion, bool two_sided, BoundedMotionStats* stats,
                                        BroadPhase* near, const VertexFans* fans) {
  BoundedMotionStats own_stats;
  BroadPhase own_near;
  if (!fans) {
    const VertexFans own_fans(motion.triangles, motion.from.size());
    return move_without_crossing(motion, two_sided, stats, near, &own_fans);
  }
  return CrossingFreeMotion(motion, two_sided, near ? *near : own_near, *fans, stats ? *stats : own_stats).run();
}

}  // namespace geo
