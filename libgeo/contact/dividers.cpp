#include "contact/dividers.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "contact/triangle_planes.h"

namespace geo {
namespace {

struct Divider {
  Simplex a, b;
  Vec3 normal;      // from b to a
  double at, half;  // a stays above at + half, b below at − half
};

// Whether the parts may come together, and the plane between them then.
bool divide(const Divided& d, const std::vector<Vec3>& at, double within, bool adjacent, Divider& out) {
  const auto way = [&](const Simplex& s) {
    double most = 0;
    for (int k = 0; k < s.size; ++k) most = std::max(most, d.limit[s.v[k]]);
    return most;
  };
  const double both = way(out.a) + way(out.b);
  if (!(both > 0)) return false;
  const auto middle = [&](const Simplex& s) {
    Vec3 sum = at[s.v[0]];
    for (int k = 1; k < s.size; ++k) sum += at[s.v[k]];
    return Vec3(sum / s.size);
  };
  const Vec3 across = middle(out.a) - middle(out.b);
  // The corners' centres and the triangles' own normals part most; only else closest places are looked for.
  const auto normal = [&](const Simplex& s) { return Vec3((at[s.v[1]] - at[s.v[0]]).cross(at[s.v[2]] - at[s.v[0]])); };
  double best = 0;
  const auto clear = [&](const Vec3& n) {
    const double length = n.norm(), along = n.dot(across);
    if (!(length > 0)) return false;
    const Vec3 unit = n / (along < 0 ? -length : length);
    const double free = parted(unit, out.a, out.b, at);
    if (free > best) best = free, out.normal = unit;
    return free > both + within;
  };
  if (clear(across) || (out.a.size == 3 && clear(normal(out.a))) || (out.b.size == 3 && clear(normal(out.b)))) return false;
  Vec3 p[3], q[3];
  for (int k = 0; k < out.a.size; ++k) p[k] = at[out.a.v[k]];
  for (int k = 0; k < out.b.size; ++k) q[k] = at[out.b.v[k]];
  if (adjacent || best < d.gap) {
    const Vec3 apart = closest_places(p, out.a.size, q, out.b.size).apart;
    const double distance = apart.norm();
    if (distance > both + within) return false;
    out.normal = distance > 0 ? Vec3(apart / distance) : Vec3(Vec3::Zero());
  }
  double low = -std::numeric_limits<double>::infinity(), high = -low, wants_low = low, wants_high = high;
  for (int k = 0; k < out.a.size; ++k) high = std::min(high, out.normal.dot(p[k])), wants_high = std::min(wants_high, out.normal.dot(d.to[out.a.v[k]]));
  for (int k = 0; k < out.b.size; ++k) low = std::max(low, out.normal.dot(q[k])), wants_low = std::max(wants_low, out.normal.dot(d.to[out.b.v[k]]));
  const double free = high - low;
  // Parts of neighbours may become thinner as the body is squeezed, but never flat; sheets in contact keep their distance.
  const double gap = free > d.gap ? d.gap : adjacent ? 0.5 * free : free;
  out.half = 0.5 * gap;
  out.at = std::clamp(0.5 * (wants_low + wants_high), low + out.half, std::max(low + out.half, high - out.half));
  return true;
}

// Where one vertex comes to. `size`: of coordinates, for rounding.
Vec3 moved(const Vec3& from, const Vec3& to, double limit, std::span<const std::pair<const Divider*, double>> planes, double size) {
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
      if (const double lack = p->half * (1 + spare) - side * (p->normal.dot(x) - p->at); lack > 0.5 * spare * p->half) x += side * lack * p->normal, inside = false;
    if (inside) break;
  }
  within();
  double share = 1;
  for (const auto& [p, side] : planes) {
    if (!(p->half > 1e-13 * size)) return from;
    const double before = side * (p->normal.dot(from) - p->at) - p->half, after = side * (p->normal.dot(x) - p->at) - p->half;
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
    for (std::size_t s = begin; s < end; ++s)
      for (std::size_t i = s * stretch; i < std::min(d.pairs.size(), (s + 1) * stretch); ++i) {
        const auto& [t, o] = d.pairs[i];
        if (!boxes[t].meets(boxes[o]) || planes_of.part(t, o, way[t] + way[o] + d.gap, way[t] + way[o] + d.gap)) continue;
        const int count = parts_apart(d.triangles[t], d.triangles[o], parts);
        for (int k = 0; k < count; ++k) {
          Divider one{parts[k].first, parts[k].second, Vec3::Zero(), 0, 0};
          if (divide(d, at, d.gap, count == 2, one)) found[s].push_back(one);
        }
      }
  });
  std::vector<std::size_t> first(at.size() + 1, 0);
  const auto each = [&](const auto& take) {
    for (const auto& some : found)
      for (const Divider& p : some) {
        for (int k = 0; k < p.a.size; ++k) take(p.a.v[k], p, 1.0);
        for (int k = 0; k < p.b.size; ++k) take(p.b.v[k], p, -1.0);
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
      at[v] = moved(at[v], d.to[v], d.limit[v], {planes.data() + first[v], first[v + 1] - first[v]}, at[v].cwiseAbs().maxCoeff());
    }
  });
  std::size_t planes_found = 0;
  for (const auto& some : found) planes_found += some.size();
  return planes_found;
}

}  // namespace geo
