#include "contact/detection/dividers.h"

#include <algorithm>
#include <cmath>

#include "contact/detection/parting_lanes.h"
#include "contact/detection/triangle_planes.h"
#include "kerf/parallel.h"

namespace geo {
namespace {

struct Divider {
  Simplex a, b;
  Vec3 normal;      // from b to a
  double at, half;  // a stays above at + half, b below at − half
};

// How far two parts may come towards each other.
double way_of(const Divided& d, const Couple& c) {
  double a = 0, b = 0;
  for (int k = 0; k < c.a.size; ++k) a = std::max(a, d.limit[c.a.v[k]]);
  for (int k = 0; k < c.b.size; ++k) b = std::max(b, d.limit[c.b.v[k]]);
  return a + b;
}

// Whether the parts may come together, and the plane between them then.
bool divide(const Divided& d, const std::vector<Vec3>& at, bool adjacent, const Partings& p, std::size_t lane,
            Divider& out) {
  const double reach = way_of(d, {out.a, out.b}) + d.gap;
  // The corners' centres and the triangles' own normals part most; only else closest places are looked at.
  int taken = Partings::across;
  for (int k = 0; k < Partings::closest; ++k) {
    if (p.first[k][lane] > reach) return false;
    if (p.first[k][lane] > p.first[taken][lane]) taken = k;
  }
  if (adjacent || p.first[taken][lane] < d.gap) {
    taken = Partings::closest;
    if (p.first[taken][lane] > reach) return false;
  }
  out.normal = {p.normal[taken][0][lane], p.normal[taken][1][lane], p.normal[taken][2][lane]};
  double low = -std::numeric_limits<double>::infinity(), high = -low, wants_low = low, wants_high = high;
  for (int k = 0; k < out.a.size; ++k)
    high = std::min(high, out.normal.dot(at[out.a.v[k]])),
    wants_high = std::min(wants_high, out.normal.dot(d.to[out.a.v[k]]));
  for (int k = 0; k < out.b.size; ++k)
    low = std::max(low, out.normal.dot(at[out.b.v[k]])),
    wants_low = std::max(wants_low, out.normal.dot(d.to[out.b.v[k]]));
  const double free = high - low;
  // Parts of neighbours may become thinner as the body is squeezed, but never flat; sheets in contact keep their
  // distance.
  const double gap = free > d.gap ? d.gap : adjacent ? 0.5 * free : free;
  out.half = 0.5 * gap;
  out.at = std::clamp(0.5 * (wants_low + wants_high), low + out.half, std::max(low + out.half, high - out.half));
  return true;
}

// Where one vertex comes to. `size`: of coordinates, for rounding.
Vec3 moved(const Vec3& from, const Vec3& to, double limit, std::span<const std::pair<const Divider*, double>> planes,
           double size) {
  Vec3 x = to;
  const auto within = [&] {
    if (const Vec3 way = x - from; way.norm() > limit) x = from + limit / way.norm() * way;
  };
  within();
  constexpr int most_rounds = 8;
  constexpr double spare = 0.02;  // of half a gap: what is projected is clear of planes, not on them
  for (int round = 0; round < most_rounds; ++round) {
    bool inside = true;
    for (const auto& [p, side] : planes)
      if (const double lack = p->half * (1 + spare) - side * (p->normal.dot(x) - p->at); lack > 0.5 * spare * p->half)
        x += side * lack * p->normal, inside = false;
    if (inside) break;
  }
  within();
  double share = 1;
  for (const auto& [p, side] : planes) {
    if (!(p->half > 1e-13 * size)) return from;
    const double before = side * (p->normal.dot(from) - p->at) - p->half,
                 after = side * (p->normal.dot(x) - p->at) - p->half;
    if (after < 0) share = std::min(share, std::max(0.0, before) / (std::max(0.0, before) - after));
  }
  return share == 1 ? x : Vec3(from + share * (x - from));
}

}  // namespace

int parts_apart(const Triangle& s, const Triangle& t, std::pair<Simplex, Simplex> (&parts)[2]) {
  Simplex s_own{{}, 0}, t_own{{}, 0};
  for (int k = 0; k < 3; ++k) {
    if (s[k] != t[0] && s[k] != t[1] && s[k] != t[2]) s_own.v[s_own.size++] = s[k];
    if (t[k] != s[0] && t[k] != s[1] && t[k] != s[2]) t_own.v[t_own.size++] = t[k];
  }
  if (s_own.size == 0 || t_own.size == 0) return 0;
  const Simplex s_all{{s[0], s[1], s[2]}, 3}, t_all{{t[0], t[1], t[2]}, 3};
  parts[0] = {s_own, t_all}, parts[1] = {s_all, t_own};
  return s_own.size == 3 ? 1 : 2;
}

std::size_t move_divided(const Divided& d, std::vector<Vec3>& at) {
  constexpr std::size_t stretch = 1024;
  std::vector<std::vector<Divider>> found((d.pairs.size() + stretch - 1) / stretch);
  std::vector<Box3> boxes(d.triangles.size());
  std::vector<double> way(d.triangles.size(), 0);
  const TrianglePlanes planes_of(d.triangles, at, at);
  parallel_for(boxes.size(), 1024, [&](std::size_t begin, std::size_t end) {
    for (std::size_t t = begin; t < end; ++t) {
      for (const auto v : d.triangles[t]) boxes[t].add(at[v]), way[t] = std::max(way[t], d.limit[v]);
      boxes[t] = boxes[t].grown(way[t] + 0.5 * d.gap);
    }
  });
  parallel_for(found.size(), 1, [&](std::size_t begin, std::size_t end) {
    std::pair<Simplex, Simplex> parts[2];
    for (std::size_t s = begin; s < end; ++s) {
      // Numbers: of the pair, which couple of it, of how many.
      const auto judge = [&](std::size_t number, const Partings& p, std::size_t lane) {
        const auto& [t, o] = d.pairs[number / 4];
        const bool adjacent = number % 2 != 0;
        parts_apart(d.triangles[t], d.triangles[o], parts);
        const auto& [a, b] = parts[number / 2 % 2];
        Divider one{a, b, Vec3::Zero(), 0, 0};
        if (divide(d, at, adjacent, p, lane, one)) found[s].push_back(one);
      };
      CouplesInLanes<decltype(judge)> couples(at, at, false, judge);
      for (std::size_t i = s * stretch; i < std::min(d.pairs.size(), (s + 1) * stretch); ++i) {
        const auto& [t, o] = d.pairs[i];
        if (!boxes[t].meets(boxes[o]) || planes_of.part(t, o, way[t] + way[o] + d.gap, way[t] + way[o] + d.gap))
          continue;
        std::pair<Simplex, Simplex> own[2];
        const int count = parts_apart(d.triangles[t], d.triangles[o], own);
        for (int k = 0; k < count; ++k) {
          const Couple c{own[k].first, own[k].second};
          const double both = way_of(d, c);
          if (both > 0 && part_across(c, at, at).first <= both + d.gap)
            couples.add(c, 4 * i + 2 * static_cast<std::size_t>(k) + (count == 2));
        }
      }
      couples.finish();
    }
  });
  std::vector<std::size_t> first(at.size() + 1, 0);
  const auto each = [&](const auto& take) {
    for (const auto& some : found)
      for (const Divider& p : some) {
        for (int k = 0; k < p.a.size; ++k)
          if (d.limit[p.a.v[k]] > 0) take(p.a.v[k], p, 1.0);
        for (int k = 0; k < p.b.size; ++k)
          if (d.limit[p.b.v[k]] > 0) take(p.b.v[k], p, -1.0);
      }
  };
  each([&](std::uint32_t v, const Divider&, double) { ++first[v + 1]; });
  for (std::size_t v = 0; v < at.size(); ++v) first[v + 1] += first[v];
  std::vector<std::pair<const Divider*, double>> planes(first.back());
  std::vector<std::size_t> next(first.begin(), first.end() - 1);
  each([&](std::uint32_t v, const Divider& p, double side) { planes[next[v]++] = {&p, side}; });
  parallel_for(at.size(), 256, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v) {
      if (!(d.limit[v] > 0)) continue;
      at[v] = moved(at[v], d.to[v], d.limit[v], {planes.data() + first[v], first[v + 1] - first[v]},
                    at[v].cwiseAbs().maxCoeff());
    }
  });
  std::size_t planes_found = 0;
  for (const auto& some : found) planes_found += some.size();
  return planes_found;
}

}  // namespace geo
