// A plan has three phases: move live points, carry points in air with them, extend the ends along
// the surface. It is then resampled to about the point interval.
#include "simulation/fracture_front.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/elementary.h"
#include "body/locate.h"
#include "geometry/predicates.h"
#include "kerf/error.h"

namespace geo {
namespace {

// In node spacings. Nodes resolve neither a finer front nor the stress in a thinner ligament.
constexpr double point_interval = 0.7;  // between the points of a front
constexpr double ligament = 0.5;        // thickness below which a front cuts through to the surface
constexpr double overhang = 1.0 / 7;    // of a front beyond the surface

// Distance from p along the unit direction d to the first face; infinity if it exceeds `reach`. The
// first thousandth of the way is skipped, since p may lie on a face.
double distance_to_face(const Complex& complex, const Vec3& p, const Vec3& d, double reach) {
  const Vec3 from = p + 1e-3 * reach * d, to = p + reach * d;
  Box3 box{from, from};
  box.add(to);
  std::vector<FaceId> near;
  complex.faces_near(box, near);
  double first = std::numeric_limits<double>::infinity();
  for (const FaceId f : near) {
    const auto t = complex.corners(f);
    if (!segment_meets_triangle(from, to, t[0], t[1], t[2])) continue;
    const Vec3 n = (t[1] - t[0]).cross(t[2] - t[0]);
    const double along = n.dot(d);
    first = std::min(first, along == 0 ? 0.0 : std::clamp(n.dot(t[0] - p) / along, 0.0, reach));
  }
  return first;
}

Vec3 unit_or(const Vec3& v, const Vec3& otherwise) { return v.squaredNorm() > 0 ? v.normalized() : otherwise; }

// True where a part of the segment is inside the material.
bool spans_material(const FrontState& front, std::size_t segment) {
  const auto& s = front.segments[segment];
  return std::any_of(s.begin(), s.end(), [](const auto& p) { return p.id.valid(); });
}

}  // namespace

TipFrame tip_frame(const GrowingFront& g, std::size_t i) {
  const std::size_t n = g.size();
  const std::size_t before = i > 0 ? i - 1 : g.front.closed ? n - 1 : 0;
  const std::size_t after = i + 1 < n ? i + 1 : g.front.closed ? 0 : n - 1;
  const Vec3& normal = g.normal[i];
  const Vec3 tangent =
      unit_or(g.front.points[after].position - g.front.points[before].position, normal.unitOrthogonal());
  const Vec3 across = unit_or(normal - normal.dot(tangent) * tangent, tangent.unitOrthogonal());
  return {g.front.points[i].position, tangent.cross(across), across};
}

GrowingFront growing(FrontState front, std::vector<Vec3> normals) {
  if (normals.size() != front.points.size()) throw InputError("a growing front needs one normal a point");
  GrowingFront g;
  g.owed.assign(front.points.size(), 0);
  for (const auto& p : front.points) g.ended.push_back(front.has_moved && !p.id.valid());
  g.normal = std::move(normals);
  g.front = std::move(front);
  return g;
}

std::optional<GrowingFront> growing_after(const FrontState& before, FrontState after) {
  const std::size_t n = after.points.size();
  if (before.points.size() != n) return {};
  std::vector<Vec3> normals(n, Vec3::Zero());
  Vec3 mean = Vec3::Zero();
  const bool closed = after.closed;
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t last = i > 0 ? i - 1 : closed ? n - 1 : 0, next = i + 1 < n ? i + 1 : closed ? 0 : n - 1;
    const Vec3 along = after.points[next].position - after.points[last].position;
    normals[i] = unit_or((after.points[i].position - before.points[i].position).cross(along), Vec3::Zero());
    mean += normals[i];
  }
  if (!(mean.norm() > 0)) return {};
  for (Vec3& normal : normals)
    if (normal.isZero()) normal = mean.normalized();
  GrowingFront front = growing(std::move(after), std::move(normals));
  for (std::size_t i = 0; i < n; ++i)
    if (front.live(i)) return front;
  return {};
}

CrackTip tip_of(const GrowingFront& front) {
  CrackTip tip{.crack = front.front.crack, .at = Vec3::Zero(), .length = front.length};
  double live = 0;
  for (std::size_t i = 0; i < front.size(); ++i) {
    if (!front.live(i)) continue;
    tip.at += front.front.points[i].position;
    ++live;
  }
  if (live > 0) tip.at /= live;
  return tip;
}

namespace {

// A point that a plan adds beyond an end of the front, and whether it lies at or beyond a surface.
struct ExtraPoint {
  Vec3 position;
  bool ended;
};

// Works out plan_front(), phase by phase.
class FrontPlanner {
 public:
  FrontPlanner(const Complex& complex, const GrowingFront& front, std::span<const double> step,
               std::span<const Vec3> direction, double spacing)
      : complex_(complex),
        g_(front),
        step_(step),
        direction_(direction),
        spacing_(spacing),
        overhang_(overhang * spacing),
        interval_(point_interval * spacing),
        next_(front.size()),
        ended_(front.ended) {}

  FrontPlan plan() {
    advance_live_points();
    carry_points_in_air();
    if (!g_.front.closed) {
      const std::size_t last = g_.size() - 1;
      extend_end(0, 1, head_);
      extend_end(last, last - 1, tail_);
      detour_around_edge(0, head_);
      detour_around_edge(last, tail_);
    }
    for (std::size_t k = head_.size(); k-- > 0;) add(0, head_[k].position, head_[k].ended);
    for (std::size_t i = 0; i < g_.size(); ++i) {
      if (!replaced(i)) add(i, next_[i], ended_[i]);
      if (!g_.front.closed && i + 1 == g_.size()) break;
      resample_between(i, (i + 1) % g_.size());
    }
    for (const ExtraPoint& p : tail_) add(g_.size() - 1, p.position, p.ended);
    return std::move(plan_);
  }

 private:
  bool moves(std::size_t i) const { return next_[i] != g_.front.points[i].position; }
  void add(std::size_t from, const Vec3& to, bool end) {
    plan_.from.push_back(static_cast<std::uint32_t>(from));
    plan_.next.push_back(to);
    plan_.ended.push_back(end);
  }
  // An end in air whose place an extension has taken: it only is where new points start.
  bool replaced(std::size_t i) const {
    return !g_.live(i) && ((i == 0 && !head_.empty()) || (i + 1 == g_.size() && !tail_.empty()));
  }
  void advance_live_points();
  void carry_points_in_air();
  void extend_end(std::size_t end, std::size_t neighbor, std::vector<ExtraPoint>& beyond) const;
  void detour_around_edge(std::size_t end, std::vector<ExtraPoint>& beyond) const;
  void resample_between(std::size_t i, std::size_t j);
  void bridge_edge(std::size_t i, std::size_t j);

  const Complex& complex_;
  const GrowingFront& g_;
  std::span<const double> step_;
  std::span<const Vec3> direction_;
  double spacing_, overhang_, interval_;  // model units
  std::vector<Vec3> next_;                // per point of the front
  std::vector<std::uint8_t> ended_;       // per point of the front
  std::vector<ExtraPoint> head_, tail_;   // beyond the first and the last point, outwards
  FrontPlan plan_;
};

// Live points grow by their step, or through a surface where one is near.
void FrontPlanner::advance_live_points() {
  for (std::size_t i = 0; i < g_.size(); ++i) {
    next_[i] = g_.front.points[i].position;
    if (!g_.live(i) || !(step_[i] > 0)) continue;
    const double reach = step_[i] + ligament * spacing_,
                 surface = distance_to_face(complex_, next_[i], direction_[i], reach);
    ended_[i] = surface <= reach;
    next_[i] += (ended_[i] ? surface + overhang_ : step_[i]) * direction_[i];
  }
}

// Points in air follow the mean motion of their live neighbours. Those without one, between which
// the front passes through material, move straight ahead.
void FrontPlanner::carry_points_in_air() {
  const std::size_t n = g_.size();
  std::vector<Vec3> carried = next_;
  for (std::size_t i = 0; i < n; ++i) {
    if (g_.front.points[i].id.valid()) continue;
    int live_neighbors = 0;
    bool spans = false;
    Vec3 motion = Vec3::Zero();
    for (const bool after : {false, true}) {
      if (!g_.front.closed && (after ? i + 1 == n : i == 0)) continue;
      const std::size_t j = after ? (i + 1) % n : (i + n - 1) % n;
      spans = spans || spans_material(g_.front, after ? i : j);
      if (!g_.live(j)) continue;
      ++live_neighbors;
      motion += next_[j] - g_.front.points[j].position;
    }
    if (live_neighbors > 0)
      carried[i] += motion / live_neighbors;
    else if (spans)
      carried[i] += interval_ * tip_frame(g_, i).ahead;
  }
  next_ = carried;
}

// Widens an open front at a live end, from the end's next position along the front. It reaches to
// the surface if that is within three intervals, else one interval; new points are an interval
// apart.
void FrontPlanner::extend_end(std::size_t end, std::size_t neighbor, std::vector<ExtraPoint>& beyond) const {
  const std::size_t base = g_.live(end) ? end : neighbor;
  if (!g_.live(base) || !moves(base) || ended_[base]) return;
  Vec3 along = g_.front.points[end].position - g_.front.points[neighbor].position;
  along -= along.dot(direction_[base]) * direction_[base];
  if (!(along.norm() > 0)) return;
  along.normalize();
  const double reach = 3 * interval_, surface = distance_to_face(complex_, next_[base], along, reach),
               to = surface <= reach ? surface + overhang_ : interval_;
  for (int k = 1; k * interval_ < to - 0.4 * interval_; ++k)
    beyond.push_back({next_[base] + k * interval_ * along, false});
  beyond.push_back({next_[base] + to * along, surface <= reach});
}

// An end in air leaves a border of the crack that no front follows, so its path must stay in air.
// Where the path would not, at an edge of the body, the end moves to a position that sees its new
// place, and both belong to the front. Trials: one to three intervals away, at 0° to 67.5° from
// straight ahead outwards; failing those, one interval straight outwards.
void FrontPlanner::detour_around_edge(std::size_t end, std::vector<ExtraPoint>& beyond) const {
  const Vec3 &from = g_.front.points[end].position, to = beyond.empty() ? next_[end] : beyond.back().position;
  if (g_.live(end) || from == to || !is_blocked(complex_, from, to)) return;
  if (beyond.empty()) beyond.push_back({to, ended_[end] != 0});
  const Vec3 ahead = tip_frame(g_, end).ahead,
             away = unit_or(from - g_.front.points[end == 0 ? 1 : end - 1].position, ahead);
  Vec3 corner = from + interval_ * away;
  bool seen = false;
  for (int k = 1; k <= 3 && !seen; ++k)
    for (int turn = 0; turn < 4 && !seen; ++turn) {
      const double angle = turn * std::numbers::pi / 8;
      const Vec3 trial = from + k * interval_ * (cosine(angle) * ahead + sine(angle) * away);
      seen = !is_blocked(complex_, from, trial) && !is_blocked(complex_, trial, to);
      if (seen) corner = trial;
    }
  beyond.push_back({corner, true});
}

// Points i and j, neighbours on the front, have left the body on different sides of one of its
// edges: a third point outside joins them.
void FrontPlanner::bridge_edge(std::size_t i, std::size_t j) {
  const Vec3 ahead = unit_or(direction_[i] + direction_[j], direction_[i]);
  for (int k = 1; k <= 4; ++k) {
    const Vec3 trial = 0.5 * (next_[i] + next_[j]) + k * 0.5 * interval_ * ahead;
    if (is_blocked(complex_, next_[i], trial) || is_blocked(complex_, trial, next_[j])) continue;
    add(moves(i) ? i : j, trial, true);
    return;
  }
}

// Inserts points between neighbours that have moved apart by more than 1.6 intervals, and merges
// those closer than 0.4. Parts of a divided gap are longer than 0.8 intervals, so that none merges.
void FrontPlanner::resample_between(std::size_t i, std::size_t j) {
  const double gap = (next_[i] - next_[j]).norm();
  if ((i == 0 && replaced(i)) || (j + 1 == g_.size() && !tail_.empty() && !g_.live(j))) return;
  if (ended_[i] && ended_[j] && (moves(i) || moves(j)) && is_blocked(complex_, next_[i], next_[j]))
    return bridge_edge(i, j);
  if (!moves(i) || !moves(j)) return;
  if (gap > 1.6 * interval_) {
    const int parts = static_cast<int>(std::ceil(gap / (1.6 * interval_)));
    const auto moved = [&](std::size_t p) { return (next_[p] - g_.front.points[p].position).norm(); };
    const std::size_t from = moved(i) >= moved(j) ? i : j;
    for (int k = 1; k < parts; ++k)
      add(from, next_[i] + double(k) / parts * (next_[j] - next_[i]), ended_[i] && ended_[j]);
  } else if (gap < 0.4 * interval_ && j > i && !ended_[i] && !ended_[j] && g_.live(i) && g_.live(j)) {
    next_[j] = next_[i];
  }
}

}  // namespace

FrontPlan plan_front(const Complex& complex, const GrowingFront& front, std::span<const double> step,
                     std::span<const Vec3> direction, double spacing) {
  return FrontPlanner(complex, front, step, direction, spacing).plan();
}

FrontState with_planned_points(const GrowingFront& g, const FrontPlan& plan) {
  FrontState front = g.front;
  front.points.clear();
  front.segments.clear();
  const std::size_t n = plan.from.size();
  for (std::size_t k = 0; k < n; ++k) {
    const auto i = plan.from[k], j = plan.from[(k + 1) % n];
    front.points.push_back(g.front.points[i]);
    if (!front.closed && k + 1 == n) break;
    if (i == j)
      front.segments.push_back({g.front.points[i], g.front.points[i]});
    else
      front.segments.push_back(g.front.segments[i]);
  }
  return front;
}

namespace {

// The front after a step, with equal neighbours merged; without segments where nothing is left.
GrowingFront merged(const GrowingFront& before, const FrontPlan& plan, const FrontState& moved,
                    std::span<const Vec3> direction) {
  GrowingFront g;
  g.front = moved;
  g.front.points.clear();
  g.front.segments.clear();
  g.length = before.length;
  double farthest = 0;
  const auto add = [&](std::size_t k, const FrontState::Point& p) {
    const auto i = plan.from[k];
    const Vec3 growth = p.position - before.front.points[i].position;
    farthest = std::max(farthest, growth.norm());
    g.front.points.push_back(p);
    // The new crack surface behind the point contains its growth and the front's tangent.
    const TipFrame old = tip_frame(before, i);
    const Vec3 ahead = before.live(i) && growth.squaredNorm() > 0 ? direction[i] : old.ahead,
               tangent = old.normal.cross(old.ahead);
    g.normal.push_back(unit_or(ahead.cross(tangent), old.normal));
    g.owed.push_back(growth.squaredNorm() > 0 ? 0 : before.owed[i]);
    g.ended.push_back(plan.ended[k] || !p.id.valid());
  };
  const std::size_t n = moved.points.size();
  for (std::size_t k = 0; k < moved.segments.size(); ++k) {
    if (moved.points[k].position == moved.points[(k + 1) % n].position) continue;
    add(k, moved.segments[k].front());
    g.front.segments.push_back(moved.segments[k]);
  }
  if (g.front.segments.empty()) return g;
  if (!moved.closed) add(n - 1, g.front.segments.back().back());
  g.length += farthest;
  return g;
}

// True where a segment has a live end, or passes through material between two points in air.
bool may_grow(const GrowingFront& g, std::size_t segment) {
  const std::size_t a = segment, b = (segment + 1) % g.size();
  return g.live(a) || g.live(b) ||
         (!g.front.points[a].id.valid() && !g.front.points[b].id.valid() && spans_material(g.front, segment));
}

void append_point(GrowingFront& to, const GrowingFront& from, std::size_t i) {
  to.front.points.push_back(from.front.points[i]);
  to.normal.push_back(from.normal[i]);
  to.owed.push_back(from.owed[i]);
  to.ended.push_back(from.ended[i]);
}

}  // namespace

std::vector<GrowingFront> fronts_after(const GrowingFront& before, const FrontPlan& plan, const FrontState& moved,
                                       std::span<const Vec3> direction) {
  const GrowingFront g = merged(before, plan, moved, direction);
  const std::size_t count = g.front.segments.size(), points = g.size();
  if (count == 0) return {};
  std::size_t begin = 0;
  while (begin < count && may_grow(g, begin)) ++begin;
  if (begin == count) return {g};
  // One open front for each run of segments that may grow.
  std::vector<GrowingFront> runs;
  if (!g.front.closed) begin = 0;
  bool open = false;
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t s = (begin + k) % count;
    if (!may_grow(g, s)) {
      open = false;
      continue;
    }
    if (!open) {
      FrontState& front = runs.emplace_back().front;
      front.closed = false;
      front.crack = g.front.crack;
      front.has_moved = g.front.has_moved;
      front.step = g.front.step;
      front.name = g.front.name;
      runs.back().length = g.length;
      append_point(runs.back(), g, s);
      open = true;
    }
    append_point(runs.back(), g, (s + 1) % points);
    runs.back().front.segments.push_back(g.front.segments[s]);
  }
  return runs;
}

std::pair<GrowingFront, FrontPlan> plan_flaw(const Complex& complex, const Vec3& center, const Vec3& normal,
                                             double radius, std::int32_t crack) {
  constexpr int count = 12;
  const Vec3 x = normal.unitOrthogonal(), y = normal.cross(x);
  GrowingFront g =
      growing(begin_front(std::vector<Vec3>(count, center), true, crack), std::vector<Vec3>(count, normal));
  FrontPlan plan;
  for (std::uint32_t i = 0; i < count; ++i) {
    const double angle = 2 * std::numbers::pi * i / count, reach = (1 + ligament) * radius;
    const Vec3 d = cosine(angle) * x + sine(angle) * y;
    const double surface = distance_to_face(complex, center, d, reach);
    plan.from.push_back(i);
    plan.next.push_back(center + (surface <= reach ? surface + overhang * radius : radius) * d);
    plan.ended.push_back(surface <= reach);
  }
  return {g, plan};
}

}  // namespace geo
