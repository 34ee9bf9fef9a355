// Constraint: min n · a − max n · b ≥ separation at the end. Where it is violated, vertices of a
// and b move along ± n beyond the plane midway between the two extremes, with equal weights.
#include "contact/motion/separation_projection.h"

#include <algorithm>
#include <limits>
#include <numeric>

#include "contact/detection/candidate_axes.h"
#include "geometry/affine_fit.h"
#include "kerf/parallel.h"

namespace geo {
namespace {

// Calls use(v) for each vertex of a constraint.
template <class Constraint, class Use>
void for_each_vertex(const Constraint& c, const Use& use) {
  for (int k = 0; k < c.a.size; ++k) use(c.a.v[k]);
  for (int k = 0; k < c.b.size; ++k) use(c.b.v[k]);
}

// The constraints of each vertex, as indices in compressed rows.
struct ConstraintsOfVertices {
  std::vector<std::uint32_t> first, constraint;

  template <class Constraint>
  ConstraintsOfVertices(std::size_t vertices, const std::vector<Constraint>& constraints) : first(vertices + 1, 0) {
    for (const Constraint& c : constraints) for_each_vertex(c, [&](std::uint32_t v) { ++first[v + 1]; });
    std::partial_sum(first.begin(), first.end(), first.begin());
    constraint.resize(first.back());
    std::vector<std::uint32_t> end(first.begin(), first.end() - 1);
    for (std::uint32_t i = 0; i < constraints.size(); ++i)
      for_each_vertex(constraints[i], [&](std::uint32_t v) { constraint[end[v]++] = i; });
  }
};

}  // namespace

// `next`: the end of the motion, which the axes at the end refer to.
void SeparationProjection::choose_axis(Constraint& c, const CandidateAxes& axes, std::size_t lane,
                                       const std::vector<Vec3>& next) const {
  const bool adjacent = c.a.size < 3 || c.b.size < 3;
  const double share = adjacent ? 0.5 : 1;  // adjacent triangles may become thinner as the body is squeezed
  double largest = 0, best = -std::numeric_limits<double>::infinity();
  for (const auto& start : axes.start_separation) largest = std::max(largest, start[lane]);
  // max end separation, subject to start separation ≥ min(largest, gap) / 2.
  const auto consider = [&](const Vec3& axis, double start, double end) {
    if (start > 0 && start >= 0.5 * std::min(largest, gap_) && end > best) {
      best = end;
      c.axis = axis;
      c.separation = std::min(gap_, share * start);
    }
    return false;  // consider all
  };
  for (int k = 0; k < CandidateAxes::count; ++k)
    consider({axes.normal[k][0][lane], axes.normal[k][1][lane], axes.normal[k][2][lane]},
             axes.start_separation[k][lane], axes.end_separation[k][lane]);
  if (!adjacent) any_tilted_axis({c.a, c.b}, axes, lane, start_, next, consider);
}

void SeparationProjection::add(std::span<const Pair> pairs, const std::vector<Vec3>& next) {
  std::vector<std::size_t> added;
  for (const auto& pair : pairs) {
    std::pair<Simplex, Simplex> simplices[2];
    const auto count =
        static_cast<std::size_t>(disjoint_subsimplices(triangles_[pair.first], triangles_[pair.second], simplices));
    const std::uint64_t key = std::uint64_t(pair.first) << 32 | pair.second;
    const std::size_t first = first_of_pair_.try_emplace(key, constraints_.size()).first->second;
    if (first == constraints_.size()) constraints_.resize(first + count);
    for (std::size_t k = 0; k < count; ++k) {
      for (Simplex* simplex : {&simplices[k].first, &simplices[k].second})
        for (int i = simplex->size; i < 3; ++i) simplex->v[i] = simplex->v[0];
      constraints_[first + k] = {.a = simplices[k].first,
                                 .b = simplices[k].second,
                                 .axis = Vec3::Zero(),
                                 .separation = 0,
                                 .s = pair.first,
                                 .t = pair.second};
      added.push_back(first + k);
    }
  }
  parallel_for(added.size(), 64, [&](std::size_t begin, std::size_t end) {
    const auto choose = [&](std::size_t i, const CandidateAxes& axes, std::size_t lane) {
      choose_axis(constraints_[i], axes, lane, next);
    };
    CandidateAxisBatch<decltype(choose)> batch(start_, next, true, choose);
    for (std::size_t i = begin; i < end; ++i) batch.add({constraints_[added[i]].a, constraints_[added[i]].b}, added[i]);
    batch.finish();
  });
  for (const auto i : added)
    if (constraints_[i].axis.isZero(0)) make_rigid({{{constraints_[i].s, constraints_[i].t}}});
}

bool SeparationProjection::is_still(const Simplex& simplex) const {
  return !still_.empty() && still_[simplex.v[0]] && still_[simplex.v[1]] && still_[simplex.v[2]];
}

bool SeparationProjection::make_rigid(std::span<const Pair> pairs) {
  bool changed = false;
  for (const auto& [s, t] : pairs) changed |= zones_.merge(triangles_[s], triangles_[t]);
  return changed;
}

std::size_t SeparationProjection::project(std::vector<Vec3>& next, std::size_t max_evaluations) const {
  constexpr int max_sweeps = 30;  // bounds the effort; bounded_motion.cpp tests and projects again
  constexpr double margin = 0.1;  // of a constraint's separation: projections do not end on its bound
  const ConstraintsOfVertices of_vertex(next.size(), constraints_);
  const auto zones = zones_.zones();
  std::vector<std::uint8_t> rigid(constraints_.size(), 0);
  if (!zones.empty())
    parallel_for(rigid.size(), 1024, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) rigid[i] = is_rigid(constraints_[i].s, constraints_[i].t);
    });
  // Only constraints with a vertex that has moved are projected again.
  std::vector<std::uint32_t> active(constraints_.size()), moved;
  std::iota(active.begin(), active.end(), 0u);
  std::vector<std::uint8_t> becomes_active(constraints_.size(), 0), has_moved(next.size(), 0);
  const auto mark_moved = [&](std::uint32_t v) {
    if (!has_moved[v]) {
      has_moved[v] = 1;
      moved.push_back(v);
    }
  };
  std::size_t evaluations = 0;
  for (int sweep = 0; sweep < max_sweeps && !active.empty() && evaluations < max_evaluations; ++sweep) {
    evaluations += active.size();
    for (const auto i : active) {
      if (rigid[i]) continue;
      const Constraint& c = constraints_[i];
      double at_a[3], at_b[3];  // of vertices along the axis
      for (int k = 0; k < 3; ++k) {
        at_a[k] = c.axis.dot(next[c.a.v[k]]);
        at_b[k] = c.axis.dot(next[c.b.v[k]]);
      }
      const double low = std::min({at_a[0], at_a[1], at_a[2]}), high = std::max({at_b[0], at_b[1], at_b[2]});
      if (low - high >= c.separation) continue;
      const bool a_stays = is_still(c.a), b_stays = is_still(c.b);
      if (a_stays && b_stays) continue;
      const double half = 0.5 * (1 + margin) * c.separation;
      const double middle = a_stays ? low - half : b_stays ? high + half : 0.5 * (low + high);
      const auto move = [&](std::uint32_t v, double deficit, double sign) {
        if (!(deficit > 0) || (!still_.empty() && still_[v])) return;
        next[v] += sign * deficit * c.axis;
        mark_moved(v);
      };
      for (int k = 0; k < c.a.size; ++k) move(c.a.v[k], middle + half - at_a[k], 1);
      for (int k = 0; k < c.b.size; ++k) move(c.b.v[k], at_b[k] - middle + half, -1);
    }
    for (const auto& zone : zones) {
      const auto needs_fit = [&](std::uint32_t v) { return sweep == 0 || has_moved[v]; };
      if (std::none_of(zone.begin(), zone.end(), needs_fit)) continue;
      apply_rigid_fit(zone, start_, next, next);
      for (const auto v : zone) mark_moved(v);
    }
    for (const auto v : moved) {
      has_moved[v] = 0;
      for (auto j = of_vertex.first[v]; j < of_vertex.first[v + 1]; ++j) becomes_active[of_vertex.constraint[j]] = 1;
    }
    moved.clear();
    active.resize(becomes_active.size());
    std::size_t count = 0;  // compacted without branches
    for (std::uint32_t i = 0; i < becomes_active.size(); ++i) {
      active[count] = i;
      count += becomes_active[i];
      becomes_active[i] = 0;
    }
    active.resize(count);
  }
  return evaluations;
}

}  // namespace geo
