// planes, crossing, bricks: grids of boxes along the axis. radial, glass: spokes and rings around a
// hub, extruded. voronoi, wood: Voronoi cells of blue-noise sites; for wood, lengths along the
// grain are divided by its ratio before, and multiplied after.
#include "score/patterns.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <string>
#include <utility>

#include <Eigen/LU>

#include "base/elementary.h"
#include "base/random.h"
#include "kerf/error.h"
#include "score/voronoi.h"
#include "score/walls.h"

namespace geo {
namespace {

constexpr double turn = 6.283185307179586;

Vec3 axis_of(const Box3& box, const PatternOptions& o) {
  if (o.axis) return *o.axis;
  int axis = 2;
  const Vec3 size = box.hi - box.lo;
  if (o.pattern == Pattern::radial || o.pattern == Pattern::glass)
    size.minCoeff(&axis);
  else if (o.pattern != Pattern::curves)
    size.maxCoeff(&axis);
  return Vec3::Unit(axis);
}

// Walls must end outside of the model; a larger margin only makes them larger.
Box3 widened(const Box3& box) { return box.grown(0.25 * box.diagonal()); }

// The ends of `count` intervals of [low, high], randomly uneven; the outer ones extend beyond by
// the margin.
std::vector<double> interval_ends(double low, double high, int count, double unevenness, double margin,
                                  Random& random) {
  std::vector<double> at{low - margin};
  const double step = (high - low) / count;
  for (int i = 1; i < count; ++i) at.push_back(low + step * (i + unevenness * random.uniform(-0.5, 0.5)));
  at.push_back(high + margin);
  return at;
}

// The numbers of intervals along each axis that make about `cells` boxes of equal edges.
std::array<int, 3> divisions(const Vec3& size, int cells) {
  const double edge = cube_root(size.prod() / cells);
  std::array<int, 3> n;
  for (int k = 0; k < 3; ++k) n[std::size_t(k)] = std::max(1, int(std::lround(size[k] / edge)));
  return n;
}

TriangleMesh planes(const Box3& box, int cells, const PatternOptions& o) {
  const Mat3 frame = frame_along(axis_of(box, o));
  const Box3 along = box_along(box, frame);
  Random random(o.seed);
  const bool crossing = o.pattern == Pattern::crossing;
  const auto n = crossing ? divisions(along.hi - along.lo, cells) : std::array<int, 3>{1, 1, cells};
  std::array<std::vector<double>, 3> at;
  for (std::size_t k = 0; k < 3; ++k)
    at[k] = interval_ends(along.lo[int(k)], along.hi[int(k)], n[k], 0.3, along.diagonal(), random);
  return grid_walls(
      at, [&](int i, int j, int k) { return (i * n[1] + j) * n[2] + k; }, frame);
}

TriangleMesh bricks(const Box3& box, int cells, const PatternOptions& o) {
  // A brick is 2 × 2 half cells: twice as long as wide, as wide as high. Courses are shifted by
  // half a brick along both axes.
  const Mat3 frame = frame_along(axis_of(box, o));
  const Box3 along = box_along(box, frame);
  const Vec3 size = along.hi - along.lo;
  const double height = cube_root(size.prod() / (2.0 * cells));
  const Vec3 half(height, 0.5 * height, height);
  Random random(o.seed);
  std::array<std::vector<double>, 3> at;
  for (std::size_t k = 0; k < 3; ++k) {
    const int axis = int(k);
    const int n = int(std::ceil(size[axis] / half[axis])) + 2;
    const double first = along.lo[axis] - half[axis] * random.uniform(1, 2);
    for (int i = 0; i <= n + 1; ++i) at[k].push_back(first + half[axis] * i);
    at[k].front() -= size.norm();
    at[k].back() += size.norm();
  }
  const int columns = int(at[0].size()), rows = int(at[1].size());
  return grid_walls(
      at, [&](int i, int j, int k) { return (k * rows + (j + k % 2) / 2) * columns + (i + k % 2) / 2; }, frame);
}

// Spokes around a hub, and rings for glass.
TriangleMesh wheel(const Box3& box, int cells, const PatternOptions& o) {
  const Mat3 frame = frame_along(axis_of(box, o));
  const Box3 along = box_along(box, frame);
  const Vec3 hub = frame.transpose() * o.impact.value_or(box.center());
  Random random(o.seed);
  double reach = 0;
  for (int corner = 0; corner < 4; ++corner)
    reach = std::max(
        reach, Vec2((corner & 1 ? along.hi : along.lo).x() - hub.x(), (corner & 2 ? along.hi : along.lo).y() - hub.y())
                   .norm());
  const bool rings = o.pattern == Pattern::glass;
  // glass: spokes · rings = cells. A larger factor than 2.5: more spokes, fewer rings.
  const int spokes = std::max(2, rings ? int(std::lround(std::sqrt(2.5 * cells))) : cells);
  const int circles = rings ? std::max(1, int(std::lround(double(cells) / spokes))) : 1;
  std::vector<Vec2> points{{hub.x(), hub.y()}};
  std::vector<std::array<std::uint32_t, 2>> segments;
  const auto at = [&](int spoke, int circle) {
    return circle == 0 ? 0u : static_cast<std::uint32_t>(1 + spoke % spokes * circles + circle - 1);
  };
  std::vector<double> angle;
  for (int s = 0; s < spokes; ++s) angle.push_back(turn / spokes * (s + 0.5 * random.uniform(-0.5, 0.5)));
  for (int s = 0; s < spokes; ++s)
    for (int c = 1; c <= circles; ++c) {
      // Rings are denser near the hub: radii grow as (c / circles)^1.6; a larger power: denser. The
      // last one is outside: no chord of it comes near the model.
      const double uneven = rings && c < circles ? 0.25 * random.uniform(-1, 1) : 0;
      const double radius = c == circles ? 3 * reach + box.diagonal() : reach * std::pow((c + uneven) / circles, 1.6);
      const double a = angle[std::size_t(s)] + (c < circles ? turn / spokes * 0.15 * random.uniform(-1, 1) : 0);
      points.push_back(points[0] + radius * Vec2(cosine(a), sine(a)));
      segments.push_back({at(s, c - 1), at(s, c)});
      if (c < circles) segments.push_back({at(s, c), at(s + 1, c)});
    }
  const double margin = 0.25 * box.diagonal();
  return raised_walls(points, segments, along.lo.z() - margin, along.hi.z() + margin, frame);
}

TriangleMesh cells_of_sites(const TriangleBvh& skin, int cells, const PatternOptions& o,
                            const std::function<void()>& pause) {
  Mat3 stretch = Mat3::Identity();
  if (o.pattern == Pattern::wood) {
    const Vec3 axis = axis_of(skin.box(), o).normalized();
    stretch -= (1 - 1 / o.grain) * axis * axis.transpose();
  }
  const auto sites = sample_sites(skin, cells, stretch, o, pause);
  if (sites.size() < 2) return {};
  TriangleMesh walls = voronoi_walls(sites, box_along(widened(skin.box()), stretch.transpose()), pause);
  const Mat3 back = stretch.inverse();
  for (Vec3& p : walls.vertices) p = back * p;
  return walls;
}

TriangleMesh swept_curves(const Box3& box, const PatternOptions& o) {
  const Mat3 frame = frame_along(axis_of(box, o));
  const Box3 along = box_along(widened(box), frame);
  // Curves that meet in a point share it, as closed ones do their first: their walls meet there
  // also where the insertion displaces points.
  std::vector<Vec2> points;
  std::vector<std::array<std::uint32_t, 2>> segments;
  std::map<std::pair<double, double>, std::uint32_t> index;
  std::set<std::pair<std::uint32_t, std::uint32_t>> known;
  for (const auto& curve : o.curves) {
    std::uint32_t last = ~0u;
    for (const Vec3& p : curve) {
      const Vec3 q = frame.transpose() * p;
      const auto [entry, fresh] = index.try_emplace({q.x(), q.y()}, static_cast<std::uint32_t>(points.size()));
      if (fresh) points.push_back({q.x(), q.y()});
      const std::uint32_t at = entry->second;
      if (last != ~0u && last != at && known.insert(std::minmax(last, at)).second) segments.push_back({last, at});
      last = at;
    }
  }
  // Walls end beyond the box: edges of walls in its faces would have points displaced.
  const TriangleMesh walls =
      raised_walls(points, segments, along.lo.z() - 0.1 * box.diagonal(), along.hi.z() + 0.1 * box.diagonal(), frame);
  return divided_by_each_other({walls}, widened(box));
}

}  // namespace

Pattern pattern_named(std::string_view name) {
  std::string all;
  for (std::size_t i = 0; i < pattern_names.size(); ++i) {
    if (name == pattern_names[i]) return Pattern(i);
    all += std::string(i ? ", " : "") + pattern_names[i];
  }
  throw InputError("there is no pattern of this name; give one of " + all);
}

Density relative_density(const TriangleBvh& skin, const Density& density) {
  if (!density) return {};
  const auto checked = [density](const Vec3& p) {
    const double value = density(p);
    if (!(value >= 0 && value <= std::numeric_limits<double>::max()))
      throw InputError("the density is below 0 or not finite at a point; give numbers of at least 0");
    return value;
  };
  constexpr int probes = 4096;
  Random random(0);
  double largest = 0;
  // A hundred tries a point: a model that fills a hundredth of its box has them all.
  for (int tries = 0, found = 0; found < probes && tries < 100 * probes; ++tries) {
    Vec3 p;
    for (int k = 0; k < 3; ++k) p[k] = random.uniform(skin.box().lo[k], skin.box().hi[k]);
    if (!skin.inside(p)) continue;
    ++found;
    largest = std::max(largest, checked(p));
  }
  if (!(largest > 0))
    throw InputError("the density is 0 everywhere inside the model; give it a value above 0 somewhere");
  return [checked, largest](const Vec3& p) { return std::min(1.0, checked(p) / largest); };
}

std::vector<Vec3> sample_sites(const TriangleBvh& skin, int count, const Mat3& stretch, const PatternOptions& o,
                               const std::function<void()>& pause) {
  Random random(o.seed);
  const Box3& box = skin.box();
  const double diagonal = box.diagonal();
  // Spacing of sites at p, relative to that far from the impact c of radius r:
  // 1 − (1 − closest) · exp(−(|p − c| / (2 r))²). Smaller `closest`: finer cells at the impact.
  constexpr double closest = 0.15;
  const auto spacing = [&](const Vec3& p) {
    return o.impact ? 1 - (1 - closest) * std::exp(-std::pow((p - *o.impact).norm() / (2 * o.cluster * diagonal), 2))
                    : 1.0;
  };
  std::vector<Vec3> sites;
  const auto candidate = [&](Vec3& p) {
    for (int tries = 0; tries < 100000; ++tries) {
      if (pause && tries % 256 == 0) pause();
      for (int k = 0; k < 3; ++k) p[k] = random.uniform(box.lo[k], box.hi[k]);
      // Density is spacing⁻³; candidates are accepted in proportion to it, with 1 at the impact.
      const bool accepted = !o.impact || random.uniform() * std::pow(spacing(p), 3) < closest * closest * closest;
      if (accepted && skin.inside(p) && (!o.density || random.uniform() < o.density(p))) return true;
    }
    return false;
  };
  while (int(sites.size()) < count) {
    Vec3 best = Vec3::Zero(), p;
    double farthest = -1;
    for (int tries = 0; tries < 10; ++tries) {
      if (!candidate(p))
        throw InputError(o.density ? "no place for Voronoi sites is found; is the density high in a tiny part alone?"
                                   : "no place for Voronoi sites is found inside; is the model thinner than rounding?");
      const Vec3 q = stretch * p;
      double nearest = std::numeric_limits<double>::infinity();
      for (const Vec3& s : sites) nearest = std::min(nearest, (q - s).norm());
      nearest /= spacing(p);
      if (o.density) nearest *= cube_root(o.density(p));
      if (nearest > farthest) {
        farthest = nearest;
        best = q;
      }
    }
    sites.push_back(best);
  }
  return sites;
}

TriangleMesh pattern_walls(const TriangleBvh& skin, int cells, const PatternOptions& o,
                           const std::function<void()>& pause) {
  const Box3& box = skin.box();
  switch (o.pattern) {
    case Pattern::planes:
    case Pattern::crossing:
      return planes(box, cells, o);
    case Pattern::voronoi:
    case Pattern::wood:
      return cells_of_sites(skin, cells, o, pause);
    case Pattern::radial:
    case Pattern::glass:
      return wheel(box, cells, o);
    case Pattern::bricks:
      return bricks(box, cells, o);
    case Pattern::curves:
      return swept_curves(box, o);
    case Pattern::sheets:
      return divided_by_each_other(o.sheets, widened(box));
  }
  return {};
}

}  // namespace geo
