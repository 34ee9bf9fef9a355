// Each vertex has half-space constraints ± (n · x − d) ≥ gap / 2. Its target is projected on them
// in turn. The straight move to the result is cut at the first plane that it would cross.
#include "contact/motion/separating_planes.h"

#include <algorithm>
#include <cmath>

#include "contact/detection/candidate_axes.h"
#include "contact/detection/simplex.h"
#include "contact/detection/triangle_planes.h"
#include "kerf/parallel.h"

namespace geo {
namespace {

struct SeparatingPlane {
  Simplex a, b;
  Vec3 normal;      // unit, from b to a
  double at, half;  // n · x ≥ at + half for a, n · x ≤ at − half for b
};

using PlaneSide = std::pair<const SeparatingPlane*, double>;  // 1: the side of a, −1: of b

// How far the two sub-simplices may approach each other: max limit over a + max limit over b.
double approach_of(const PlaneSeparatedMotion& m, const SimplexPair& pair) {
  double a = 0, b = 0;
  for (int k = 0; k < pair.a.size; ++k) a = std::max(a, m.limit[pair.a.v[k]]);
  for (int k = 0; k < pair.b.size; ++k) b = std::max(b, m.limit[pair.b.v[k]]);
  return a + b;
}

// Places the plane between the sub-simplices of `out`. Returns false if an axis separates them by
// more than they may approach, plus the gap. `adjacent`: their triangles have a common vertex.
bool place_plane(const PlaneSeparatedMotion& m, const std::vector<Vec3>& at, bool adjacent, const CandidateAxes& axes,
                 std::size_t lane, SeparatingPlane& out) {
  const double reach = approach_of(m, {out.a, out.b}) + m.gap;
  // The difference of closest points is used only if no other axis separates by the gap.
  int chosen = CandidateAxes::between_centroids;
  for (int k = 0; k < CandidateAxes::between_closest; ++k) {
    if (axes.start_separation[k][lane] > reach) return false;
    if (axes.start_separation[k][lane] > axes.start_separation[chosen][lane]) chosen = k;
  }
  if (adjacent || axes.start_separation[chosen][lane] < m.gap) {
    chosen = CandidateAxes::between_closest;
    if (axes.start_separation[chosen][lane] > reach) return false;
  }
  out.normal = {axes.normal[chosen][0][lane], axes.normal[chosen][1][lane], axes.normal[chosen][2][lane]};
  double low = -std::numeric_limits<double>::infinity(), high = -low, wanted_low = low, wanted_high = high;
  for (int k = 0; k < out.a.size; ++k) {
    high = std::min(high, out.normal.dot(at[out.a.v[k]]));
    wanted_high = std::min(wanted_high, out.normal.dot(m.to[out.a.v[k]]));
  }
  for (int k = 0; k < out.b.size; ++k) {
    low = std::max(low, out.normal.dot(at[out.b.v[k]]));
    wanted_low = std::max(wanted_low, out.normal.dot(m.to[out.b.v[k]]));
  }
  const double free = high - low;
  // Adjacent triangles may become thinner as the body is squeezed, but never flat. Sheets in
  // contact keep their distance.
  const double gap = free > m.gap ? m.gap : adjacent ? 0.5 * free : free;
  out.half = 0.5 * gap;
  out.at = std::clamp(0.5 * (wanted_low + wanted_high), low + out.half, std::max(low + out.half, high - out.half));
  return true;
}

// The end of one vertex' move: its wanted position projected on its planes, as far as it may go.
// `size`: of coordinates, for rounding.
Vec3 moved_vertex(const Vec3& from, const Vec3& to, double limit, std::span<const PlaneSide> planes, double size) {
  Vec3 x = to;
  const auto limit_move = [&] {
    if (const Vec3 move = x - from; move.norm() > limit) x = from + limit / move.norm() * move;
  };
  limit_move();
  constexpr int max_rounds = 8;    // over all planes; a move that still crosses one is cut there
  constexpr double margin = 0.02;  // of half a gap: projections end beyond planes, not on them
  for (int round = 0; round < max_rounds; ++round) {
    bool inside = true;
    for (const auto& [p, side] : planes)
      if (const double lack = p->half * (1 + margin) - side * (p->normal.dot(x) - p->at);
          lack > 0.5 * margin * p->half) {
        x += side * lack * p->normal;
        inside = false;
      }
    if (inside) break;
  }
  limit_move();
  double share = 1;  // of the move, up to the first plane
  for (const auto& [p, side] : planes) {
    if (!(p->half > 1e-13 * size)) return from;  // the gap is of the order of rounding
    const double before = side * (p->normal.dot(from) - p->at) - p->half,
                 after = side * (p->normal.dot(x) - p->at) - p->half;
    if (after < 0) share = std::min(share, std::max(0.0, before) / (std::max(0.0, before) - after));
  }
  return share == 1 ? x : Vec3(from + share * (x - from));
}

constexpr std::size_t chunk = 1024;

// The planes of all pairs, in chunks of pairs.
std::vector<std::vector<SeparatingPlane>> find_planes(const PlaneSeparatedMotion& m, const std::vector<Vec3>& at) {
  std::vector<std::vector<SeparatingPlane>> found((m.pairs.size() + chunk - 1) / chunk);
  std::vector<Box3> boxes(m.triangles.size());
  std::vector<double> farthest(m.triangles.size(), 0);  // move of a vertex
  const TrianglePlanes triangle_planes(m.triangles, at, at);
  parallel_for(boxes.size(), 1024, [&](std::size_t begin, std::size_t end) {
    for (std::size_t t = begin; t < end; ++t) {
      for (const auto v : m.triangles[t]) {
        boxes[t].add(at[v]);
        farthest[t] = std::max(farthest[t], m.limit[v]);
      }
      boxes[t] = boxes[t].grown(farthest[t] + 0.5 * m.gap);
    }
  });
  parallel_for(found.size(), 1, [&](std::size_t begin, std::size_t end) {
    std::pair<Simplex, Simplex> parts[2];
    for (std::size_t c = begin; c < end; ++c) {
      // Numbers: 4 · pair + 2 · which of its pairs of sub-simplices + whether the triangles are
      // adjacent.
      const auto add_plane = [&](std::size_t number, const CandidateAxes& axes, std::size_t lane) {
        const auto& [t, o] = m.pairs[number / 4];
        const bool adjacent = number % 2 != 0;
        disjoint_subsimplices(m.triangles[t], m.triangles[o], parts);
        const auto& [a, b] = parts[number / 2 % 2];
        SeparatingPlane plane{.a = a, .b = b, .normal = Vec3::Zero(), .at = 0, .half = 0};
        if (place_plane(m, at, adjacent, axes, lane, plane)) found[c].push_back(plane);
      };
      CandidateAxisBatch<decltype(add_plane)> batch(at, at, false, add_plane);
      for (std::size_t i = c * chunk; i < std::min(m.pairs.size(), (c + 1) * chunk); ++i) {
        const auto& [t, o] = m.pairs[i];
        const double reach = farthest[t] + farthest[o] + m.gap;
        if (!boxes[t].meets(boxes[o]) || triangle_planes.separates(t, o, reach, reach)) continue;
        std::pair<Simplex, Simplex> own[2];
        const int count = disjoint_subsimplices(m.triangles[t], m.triangles[o], own);
        for (int k = 0; k < count; ++k) {
          const SimplexPair pair{own[k].first, own[k].second};
          const double approach = approach_of(m, pair);
          if (approach > 0 && centroid_separation(pair, at, at).start <= approach + m.gap)
            batch.add(pair, 4 * i + 2 * static_cast<std::size_t>(k) + (count == 2));
        }
      }
      batch.finish();
    }
  });
  return found;
}

}  // namespace

std::size_t move_between_planes(const PlaneSeparatedMotion& m, std::vector<Vec3>& at) {
  const auto found = find_planes(m, at);
  // The planes of each vertex that may move.
  std::vector<std::size_t> first(at.size() + 1, 0);
  const auto for_each_side = [&](const auto& visit) {
    for (const auto& some : found)
      for (const SeparatingPlane& p : some) {
        for (int k = 0; k < p.a.size; ++k)
          if (m.limit[p.a.v[k]] > 0) visit(p.a.v[k], p, 1.0);
        for (int k = 0; k < p.b.size; ++k)
          if (m.limit[p.b.v[k]] > 0) visit(p.b.v[k], p, -1.0);
      }
  };
  for_each_side([&](std::uint32_t v, const SeparatingPlane&, double) { ++first[v + 1]; });
  for (std::size_t v = 0; v < at.size(); ++v) first[v + 1] += first[v];
  std::vector<PlaneSide> planes(first.back());
  std::vector<std::size_t> next(first.begin(), first.end() - 1);
  for_each_side([&](std::uint32_t v, const SeparatingPlane& p, double side) { planes[next[v]++] = {&p, side}; });
  parallel_for(at.size(), 256, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v) {
      if (!(m.limit[v] > 0)) continue;
      at[v] = moved_vertex(at[v], m.to[v], m.limit[v], {planes.data() + first[v], first[v + 1] - first[v]},
                           at[v].cwiseAbs().maxCoeff());
    }
  });
  std::size_t count = 0;
  for (const auto& some : found) count += some.size();
  return count;
}

}  // namespace geo
