// Trials with shares 1, 1/2, 1/4, 0 of each vertex' move. A pair that no axis separates at both
// ends shortens the moves of its vertices; only pairs with a shortened move are judged again.
#include "contact/motion/straight_motion.h"

#include <algorithm>

#include "contact/detection/candidate_axes.h"
#include "kerf/parallel.h"

namespace geo {
namespace {

using Pair = std::pair<std::uint32_t, std::uint32_t>;

bool any_vertex(const Triangle& t, const std::vector<std::uint8_t>& marked) {
  return marked[t[0]] || marked[t[1]] || marked[t[2]];
}

Box3 swept_box(const Triangle& t, const std::vector<Vec3>& from, const std::vector<Vec3>& to) {
  Box3 box = box_of(from[t[0]], from[t[1]], from[t[2]]);
  for (const auto v : t) box.add(to[v]);
  return box;
}

class StraightMotion {
 public:
  StraightMotion(const std::vector<Triangle>& triangles, std::span<const Pair> pairs, const std::vector<Vec3>& to,
                 double gap, std::vector<Vec3>& at)
      : triangles_(triangles),
        pairs_(pairs),
        to_(to),
        gap_(gap),
        start_(at),
        at_(at),
        share_(at.size(), 0),
        moves_(at.size(), 0),
        blocked_(at.size(), 0),
        changed_(triangles.size(), 1),
        moving_(triangles.size()),
        boxes_(triangles.size()),
        verdict_(pairs.size(), separated) {}

  void run() {
    for (const auto& t : triangles_)
      for (const auto v : t) {
        share_[v] = to_[v] != start_[v];
        moves_[v] = share_[v] > 0;
      }
    for (int trial = 0;; ++trial) {
      place_vertices();
      judge_pairs();
      if (!find_blocked()) return;
      shorten_moves(trial);
    }
  }

 private:
  // One axis separates a pair at both ends; the pair may meet; or an axis separates it wherever on
  // their paths its vertices are, so that it need not be judged again.
  enum Verdict : std::uint8_t { separated, meets, always_separated };

  void place_vertices() {
    for (std::size_t v = 0; v < at_.size(); ++v)
      if (moves_[v] || blocked_[v])
        at_[v] = share_[v] == 1 ? to_[v] : Vec3(start_[v] + share_[v] * (to_[v] - start_[v]));
    parallel_for(triangles_.size(), 1024, [&](std::size_t begin, std::size_t end) {
      for (std::size_t t = begin; t < end; ++t)
        if (changed_[t]) {
          boxes_[t] = swept_box(triangles_[t], start_, at_).grown(0.5 * gap_);
          moving_[t] = any_vertex(triangles_[t], moves_);
        }
    });
  }

  // Separation to be kept: adjacent triangles may become thinner as the body is squeezed.
  double required(const PairSeparation& p, bool adjacent) const {
    return std::min(gap_, adjacent ? 0.5 * p.start : p.start);
  }
  bool is_separated(const PairSeparation& p, bool adjacent) const {
    return p.start > 0 && p.end >= required(p, adjacent);
  }
  bool is_always_separated(const PairSeparation& p, bool adjacent) const {
    return p.swept > 0 && p.swept >= required(p, adjacent);
  }

  void judge_pairs() {
    parallel_for(pairs_.size(), 512, [&](std::size_t begin, std::size_t end) {
      // Numbers: 2 · pair + whether its triangles are adjacent.
      const auto judge_axes = [&](std::size_t number, const CandidateAxes& axes, std::size_t lane) {
        bool any = false, any_always = false;
        for (int k = 0; k < CandidateAxes::count; ++k) {
          const PairSeparation p{axes.start_separation[k][lane], axes.end_separation[k][lane],
                                 axes.swept_separation[k][lane]};
          any |= is_separated(p, number % 2 != 0);
          any_always |= is_always_separated(p, number % 2 != 0);
        }
        Verdict& verdict = verdict_[number / 2];
        if (!any)
          verdict = meets;
        else if (!any_always && verdict == always_separated)
          verdict = separated;
      };
      CandidateAxisBatch<decltype(judge_axes)> batch(start_, at_, true, judge_axes);
      std::pair<Simplex, Simplex> simplices[2];
      for (std::size_t i = begin; i < end; ++i) {
        const auto& [s, t] = pairs_[i];
        if (verdict_[i] == always_separated) continue;
        verdict_[i] = separated;
        if (!(changed_[s] || changed_[t]) || !(moving_[s] || moving_[t])) continue;
        if (!boxes_[s].meets(boxes_[t])) continue;
        verdict_[i] = always_separated;
        const int count = disjoint_subsimplices(triangles_[s], triangles_[t], simplices);
        const bool adjacent = count == 2;
        for (int k = 0; k < count; ++k) {
          const SimplexPair pair{simplices[k].first, simplices[k].second};
          const PairSeparation p = centroid_separation(pair, start_, at_);
          if (!is_separated(p, adjacent))
            batch.add(pair, 2 * i + adjacent);
          else if (!is_always_separated(p, adjacent) && verdict_[i] == always_separated)
            verdict_[i] = separated;
        }
      }
      batch.finish();
    });
  }

  // Marks vertices of pairs that may meet; false: there are none.
  bool find_blocked() {
    std::fill(blocked_.begin(), blocked_.end(), 0);
    bool any = false;
    for (std::size_t i = 0; i < pairs_.size(); ++i)
      if (verdict_[i] == meets) {
        any = true;
        for (const auto& t : {triangles_[pairs_[i].first], triangles_[pairs_[i].second]})
          for (const auto v : t) blocked_[v] = 1;
      }
    return any;
  }

  void shorten_moves(int trial) {
    constexpr int max_halvings = 2;  // then the vertex stays: at most 4 trials for it
    for (std::size_t v = 0; v < at_.size(); ++v)
      if (blocked_[v]) {
        share_[v] = trial < max_halvings ? 0.5 * share_[v] : 0;
        moves_[v] = share_[v] > 0;
      }
    for (std::size_t t = 0; t < triangles_.size(); ++t) changed_[t] = any_vertex(triangles_[t], blocked_);
  }

  const std::vector<Triangle>& triangles_;
  std::span<const Pair> pairs_;
  const std::vector<Vec3>& to_;
  double gap_;
  const std::vector<Vec3> start_;
  std::vector<Vec3>& at_;
  std::vector<double> share_;                   // per vertex, of its whole move
  std::vector<std::uint8_t> moves_, blocked_;   // per vertex
  std::vector<std::uint8_t> changed_, moving_;  // per triangle: since the last trial; has a vertex that moves
  std::vector<Box3> boxes_;                     // per triangle, swept
  std::vector<Verdict> verdict_;                // per pair
};

}  // namespace

void move_straight(const std::vector<Triangle>& triangles, std::span<const Pair> pairs, const std::vector<Vec3>& to,
                   double gap, std::vector<Vec3>& at) {
  StraightMotion(triangles, pairs, to, gap, at).run();
}

}  // namespace geo
