#include "simulation/fracture_front.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "body/locate.h"
#include "geometry/predicates.h"
#include "kerf/error.h"

namespace geo {
namespace {

constexpr double apart = 0.7;     // points of a front, in spacings
constexpr double ligament = 0.5;  // what nodes cannot carry
constexpr double overhang = 1.0 / 7;

// How far along the unit direction d from p a face is met first, beyond what p itself touches;
// beyond `reach`: infinity.
double distance_to_face(const Complex& complex, const Vec3& p, const Vec3& d, double reach) {
  const Vec3 from = p + 1e-3 * reach * d, to = p + reach * d;
  Box3 box{from, from};
  box.add(to);
  std::vector<FaceId> near;
  complex.near(box, near);
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

// A part of the front is inside between two points in air.
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
  for (const auto& p : front.points) g.ended.push_back(front.step > 0 && !p.id.valid());
  g.normal = std::move(normals);
  g.front = std::move(front);
  return g;
}

FrontPlan plan_front(const Complex& complex, const GrowingFront& g, std::span<const double> step,
                     std::span<const Vec3> direction, double spacing) {
  const std::size_t n = g.size();
  const double out = overhang * spacing, wanted = apart * spacing;
  std::vector<Vec3> next(n);
  std::vector<std::uint8_t> ended(g.ended);
  const auto goes = [&](std::size_t i) { return next[i] != g.front.points[i].position; };
  for (std::size_t i = 0; i < n; ++i) {
    next[i] = g.front.points[i].position;
    if (!g.live(i) || !(step[i] > 0)) continue;
    const double reach = step[i] + ligament * spacing,
                 surface = distance_to_face(complex, next[i], direction[i], reach);
    ended[i] = surface <= reach;
    next[i] += (ended[i] ? surface + out : step[i]) * direction[i];
  }
  // Points in air beside what is still inside follow their live neighbour, or go on where they were
  // going.
  std::vector<Vec3> carried = next;
  for (std::size_t i = 0; i < n; ++i) {
    if (g.front.points[i].id.valid()) continue;
    int beside_live = 0;
    bool spans = false;
    Vec3 way = Vec3::Zero();
    for (const bool after : {false, true}) {
      if (!g.front.closed && (after ? i + 1 == n : i == 0)) continue;
      const std::size_t j = after ? (i + 1) % n : (i + n - 1) % n;
      spans = spans || spans_material(g.front, after ? i : j);
      if (!g.live(j)) continue;
      ++beside_live;
      way += next[j] - g.front.points[j].position;
    }
    if (beside_live > 0)
      carried[i] += way / beside_live;
    else if (spans)
      carried[i] += wanted * tip_frame(g, i).ahead;
  }
  next = carried;
  FrontPlan plan;
  const auto add = [&](std::size_t from, const Vec3& to, bool end) {
    plan.from.push_back(static_cast<std::uint32_t>(from)), plan.next.push_back(to), plan.ended.push_back(end);
  };
  // Beyond a live end of the front: from next[i] along it to the surface, with new points on the
  // way.
  const auto widen = [&](std::size_t end, std::size_t neighbor, std::vector<std::pair<Vec3, bool>>& beyond) {
    const bool lives = g.live(end);
    const std::size_t base = lives ? end : neighbor;
    if (!g.live(base) || !goes(base) || ended[base]) return;
    Vec3 along = g.front.points[end].position - g.front.points[neighbor].position;
    along -= along.dot(direction[base]) * direction[base];
    if (!(along.norm() > 0)) return;
    along.normalize();
    const double reach = 3 * wanted, surface = distance_to_face(complex, next[base], along, reach),
                 to = surface <= reach ? surface + out : wanted;
    for (int k = 1; k * wanted < to - 0.4 * wanted; ++k) beyond.push_back({next[base] + k * wanted * along, false});
    beyond.push_back({next[base] + to * along, surface <= reach});
  };
  // The way of an end in air is a border of the crack that no front follows: it must stay in air.
  // Where it would not (round an edge of the body), the end goes ahead to where it sees its new
  // place, and both belong to the front.
  const auto round_edge = [&](std::size_t end, std::vector<std::pair<Vec3, bool>>& beyond) {
    const Vec3 &from = g.front.points[end].position, to = beyond.empty() ? next[end] : beyond.back().first;
    if (g.live(end) || from == to || !is_blocked(complex, from, to)) return;
    if (beyond.empty()) beyond.push_back({to, ended[end]});
    const Vec3 ahead = tip_frame(g, end).ahead,
               away = unit_or(from - g.front.points[end == 0 ? 1 : end - 1].position, ahead);
    Vec3 corner = from + wanted * away;
    bool seen = false;
    for (int k = 1; k <= 3 && !seen; ++k)
      for (int turn = 0; turn < 4 && !seen; ++turn) {
        const double angle = turn * std::numbers::pi / 8;
        const Vec3 trial = from + k * wanted * (std::cos(angle) * ahead + std::sin(angle) * away);
        seen = !is_blocked(complex, from, trial) && !is_blocked(complex, trial, to);
        if (seen) corner = trial;
      }
    beyond.push_back({corner, true});
  };
  std::vector<std::pair<Vec3, bool>> head, tail;
  if (!g.front.closed) {
    widen(0, 1, head), widen(n - 1, n - 2, tail);
    round_edge(0, head), round_edge(n - 1, tail);
  }
  for (std::size_t k = head.size(); k-- > 0;) add(0, head[k].first, head[k].second);
  for (std::size_t i = 0; i < n; ++i) {
    // A dead end whose place was taken by what widening found is only where new points start.
    const bool replaced = (i == 0 && !head.empty() && !g.live(i)) || (i + 1 == n && !tail.empty() && !g.live(i));
    if (!replaced) add(i, next[i], ended[i]);
    if (!g.front.closed && i + 1 == n) break;
    const std::size_t j = (i + 1) % n;
    const double gap = (next[i] - next[j]).norm();
    if ((i == 0 && replaced) || (j + 1 == n && !tail.empty() && !g.live(j))) continue;
    // Two that have come out on different sides of an edge of the body: a third goes out between
    // them.
    if (ended[i] && ended[j] && (goes(i) || goes(j)) && is_blocked(complex, next[i], next[j])) {
      const Vec3 ahead = unit_or(direction[i] + direction[j], direction[i]);
      for (int k = 1; k <= 4; ++k) {
        const Vec3 trial = 0.5 * (next[i] + next[j]) + k * 0.5 * wanted * ahead;
        if (is_blocked(complex, next[i], trial) || is_blocked(complex, trial, next[j])) continue;
        add(goes(i) ? i : j, trial, true);
        break;
      }
      continue;
    }
    if (!goes(i) || !goes(j)) continue;
    if (gap > 1.6 * wanted) {
      const int parts = static_cast<int>(std::ceil(gap / (1.6 * wanted)));
      const std::size_t from =
          (next[i] - g.front.points[i].position).norm() >= (next[j] - g.front.points[j].position).norm() ? i : j;
      for (int k = 1; k < parts; ++k)
        add(from, next[i] + double(k) / parts * (next[j] - next[i]), ended[i] && ended[j]);
    } else if (gap < 0.4 * wanted && j > i && !ended[i] && !ended[j] && g.live(i) && g.live(j)) {
      next[j] = next[i];
    }
  }
  for (std::size_t k = 0; k < tail.size(); ++k) add(n - 1, tail[k].first, tail[k].second);
  return plan;
}

FrontState depart(const GrowingFront& g, const FrontPlan& plan) {
  FrontState front = g.front;
  front.points.clear(), front.segments.clear();
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

std::vector<GrowingFront> arrive(const GrowingFront& before, const FrontPlan& plan, FrontState moved,
                                 std::span<const Vec3> direction) {
  GrowingFront g;
  g.front = moved;
  g.front.points.clear(), g.front.segments.clear();
  g.length = before.length;
  const std::size_t n = moved.points.size();
  double farthest = 0;
  const auto take = [&](std::size_t k, const FrontState::Point& p) {
    const auto i = plan.from[k];
    const Vec3 way = p.position - before.front.points[i].position;
    farthest = std::max(farthest, way.norm());
    g.front.points.push_back(p);
    // The crack behind the point holds its way and the front's tangent.
    const TipFrame old = tip_frame(before, i);
    const Vec3 ahead = before.live(i) && way.squaredNorm() > 0 ? direction[i] : old.ahead,
               tangent = old.normal.cross(old.ahead);
    g.normal.push_back(unit_or(ahead.cross(tangent), old.normal));
    g.owed.push_back(way.squaredNorm() > 0 ? 0 : before.owed[i]);
    g.ended.push_back(plan.ended[k] || !p.id.valid());
  };
  for (std::size_t k = 0; k < moved.segments.size(); ++k) {
    if (moved.points[k].position == moved.points[(k + 1) % n].position) continue;
    take(k, moved.segments[k].front());
    g.front.segments.push_back(moved.segments[k]);
  }
  if (g.front.segments.empty()) return {};
  if (!moved.closed) take(n - 1, g.front.segments.back().back());
  g.length += farthest;
  // Runs of segments that have a live end, or are inside between two points in air.
  const std::size_t count = g.front.segments.size(), points = g.size();
  const auto alive = [&](std::size_t s) {
    const std::size_t a = s, b = (s + 1) % points;
    return g.live(a) || g.live(b) ||
           (!g.front.points[a].id.valid() && !g.front.points[b].id.valid() && spans_material(g.front, s));
  };
  std::size_t begin = 0;
  while (begin < count && alive(begin)) ++begin;
  if (begin == count) return {g};
  std::vector<GrowingFront> parts;
  if (!g.front.closed) begin = 0;
  bool open = false;
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t s = (begin + k) % count;
    if (!alive(s)) {
      open = false;
      continue;
    }
    const auto put = [&](GrowingFront& part, std::size_t i) {
      part.front.points.push_back(g.front.points[i]);
      part.normal.push_back(g.normal[i]), part.owed.push_back(g.owed[i]), part.ended.push_back(g.ended[i]);
    };
    if (!open) {
      parts.emplace_back();
      auto& f = parts.back().front;
      f.closed = false, f.crack = g.front.crack, f.step = g.front.step, f.name = g.front.name;
      parts.back().length = g.length;
      put(parts.back(), s);
      open = true;
    }
    put(parts.back(), (s + 1) % points);
    parts.back().front.segments.push_back(g.front.segments[s]);
  }
  return parts;
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
    const Vec3 d = std::cos(angle) * x + std::sin(angle) * y;
    const double surface = distance_to_face(complex, center, d, reach);
    plan.from.push_back(i);
    plan.next.push_back(center + (surface <= reach ? surface + overhang * radius : radius) * d);
    plan.ended.push_back(surface <= reach);
  }
  return {g, plan};
}

}  // namespace geo
