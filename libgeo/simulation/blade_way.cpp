// Nodes and blade move linearly within a step: u(s) = u_after − (1 − s) (u_after − u_before). So
// the mapped edge moves without jumps from the end of one step to the end of the next.
#include "simulation/blade_way.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "geometry/distance.h"
#include "geometry/resolution.h"
#include "kerf/parallel.h"
#include "kerf/pieces.h"
#include "mechanics/solver/solid_discretisation.h"
#include "simulation/front_anchor.h"

namespace geo {
namespace {

// Bound on the cuts of one blade in a time step. Beyond it, a cut moves the edge by more than
// Blade::limit.
constexpr double most_cuts = 64;

// A way through the material is longer than the way past its nodes in the world where the material
// is compressed. Where it is longer by more than this, the map jumps, and more cuts do not make it
// smooth.
constexpr double most_compression = 2;

// The points of a blade at a pose, as a box.
Box3 box_about(const Blade& blade, const Pose& pose) {
  Box3 box;
  for (const Vec3& p : blade.points) box.add(pose * p);
  return box;
}

// Displacements as far as the body resolves them: the solver leaves noise in a body at rest.
std::vector<Vec3> resolved(std::vector<Vec3> displacement, const Body& body) {
  const Resolution resolution(body.surface.extent().diagonal());
  for (Vec3& u : displacement) u = resolution.rounded(u);
  return displacement;
}

// The time at a fraction of a step, s.
double time_at(const MovedBody& moved, double fraction) {
  return fraction == 1 ? moved.end : moved.begin + fraction * (moved.end - moved.begin);
}

// The distance of x from what segment k of a front sweeps.
double distance_from_strip(const Vec3& x, std::span<const FrontState::Point> points, std::span<const Vec3> to,
                           std::size_t k) {
  const Vec3 &p = points[k].position, &q = points[k + 1].position;
  return std::min((closest_point_on_triangle(x, p, q, to[k]) - x).norm(),
                  (closest_point_on_triangle(x, q, to[k + 1], to[k]) - x).norm());
}

// A side along the edge from a to b, or b to a: whether it has the two in this order.
bool has_in_order(const Complex& surface, FaceId f, VertexId a, VertexId b) {
  const auto& v = surface.face(f).v;
  for (std::size_t k = 0; k < 3; ++k)
    if (v[k] == a && v[(k + 1) % 3] == b) return true;
  return false;
}

// The way of a place of the blade in a step, in the world.
struct PlaceWay {
  Vec3 from, to;
  double length() const { return (to - from).norm(); }
};

// Places on the segments of a blade whose ends are `outside` the body before and after a step: at
// most `spacing` apart, and at most 64 of a segment.
std::vector<PlaceWay> ways_outside(const MovedBody& moved, const Blade& blade, const std::vector<std::uint8_t>& outside,
                                   double spacing) {
  const Pose from = blade.motion.at(moved.begin), to = blade.motion.at(moved.end);
  const std::size_t n = blade.points.size();
  std::vector<PlaceWay> ways;
  for (std::size_t i = 0; i + 1 < n + (blade.closed ? 1 : 0); ++i) {
    if (!outside[i] || !outside[(i + 1) % n]) continue;
    const double length = (blade.points[(i + 1) % n] - blade.points[i]).norm();
    const int parts = static_cast<int>(std::clamp(std::ceil(length / spacing), 1.0, 64.0));
    for (int k = 0; k <= parts; ++k) {
      const Vec3 p = blade.points[i] + double(k) / parts * (blade.points[(i + 1) % n] - blade.points[i]);
      ways.push_back({from * p, to * p});
    }
  }
  return ways;
}

// The longest of those ways that lead through the body. Looks at steps of `most`.
double longest_way_through(const MovedBody& moved, const Blade& blade, std::span<const PlaceWay> ways, double most) {
  Box3 swept;
  for (const PlaceWay& w : ways) {
    swept.add(w.from);
    swept.add(w.to);
  }
  const MapAt after(moved, blade, 1, swept);
  InverseDeformation::VertexCache memory;
  double longest = 0;
  for (const PlaceWay& w : ways) {
    const double steps = std::min(std::ceil(w.length() / most), most_cuts);
    for (int k = 0; k <= steps && w.length() > longest; ++k)
      if (after.map().to_material(w.from + k / steps * (w.to - w.from), memory).in_support) longest = w.length();
  }
  return longest;
}

// A bound of what number_of_cuts() measures, without the map.
double longest_way(const MovedBody& moved, const Blade& blade) {
  const Pose from = blade.motion.at(moved.begin), to = blade.motion.at(moved.end);
  double of_blade = 0;
  for (const Vec3& p : blade.points) of_blade = std::max(of_blade, (to * p - from * p).norm());
  return most_compression * (of_blade + moved.way.longest());
}

}  // namespace

NodeWay::NodeWay(const std::vector<Vec3>& before, const std::vector<Vec3>& after) {
  way_.reserve(before.size());
  for (std::size_t i = 0; i < before.size(); ++i) way_.push_back(after[i] - before[i]);
}

void NodeWay::add_nodes(std::span<const NodeId> donors) {
  if (way_.empty()) return;
  for (const NodeId d : donors) way_.push_back(Vec3(way_[d.index()]));
}

double NodeWay::longest() const {
  double longest = 0;
  for (const Vec3& way : way_) longest = std::max(longest, way.squaredNorm());
  return std::sqrt(longest);
}

std::vector<Vec3> NodeWay::at(const std::vector<Vec3>& after, double fraction) const {
  std::vector<Vec3> u = after;
  for (std::size_t i = 0; i < u.size(); ++i) u[i] -= (1 - fraction) * way_[i];
  return u;
}

MapAt::MapAt(const MovedBody& moved, const Blade& blade, double fraction)
    : MapAt(moved, blade, fraction, box_about(blade, blade.motion.at(time_at(moved, fraction)))) {}

MapAt::MapAt(const MovedBody& moved, const Blade& blade, double fraction, const Box3& box)
    : pose_(blade.motion.at(time_at(moved, fraction))),
      displacement_(resolved(moved.way.at(moved.motion.displacement, fraction), moved.body)),
      gradient_(lazy_gradients(SolidDiscretisation::of(moved.solid), displacement_)),
      map_(moved.body, displacement_, gradient_, box) {}

int number_of_cuts(const MovedBody& moved, const Blade& blade, std::span<const EdgeFront> fronts) {
  const auto& spacing = moved.body.nodes.spacing;
  const double finest = *std::min_element(spacing.begin(), spacing.end()), most = blade.limit * finest;
  if (longest_way(moved, blade) <= most) return 1;
  const MapAt before(moved, blade, 0), after(moved, blade, 1);
  std::vector<double> ways(blade.points.size(), 0);
  std::vector<std::uint8_t> outside(ways.size(), 0);  // before and after
  parallel_for(ways.size(), 4, [&](std::size_t begin, std::size_t end) {
    InverseDeformation::VertexCache before_memory, after_memory;
    for (std::size_t i = begin; i < end; ++i) {
      const std::optional<Vec3> place = place_on(fronts, double(i));
      const Vec3 from = before.pose() * blade.points[i], to = after.pose() * blade.points[i];
      const auto a = before.map().to_material(from, before_memory, place ? &*place : nullptr);
      const auto b = after.map().to_material(to, after_memory, &a.position);
      outside[i] = !a.in_support && !b.in_support;
      if (outside[i]) continue;
      if (!a.in_support || !b.in_support) {
        ways[i] = (to - from).norm();
        continue;
      }
      const double past = (to - from - moved.way.of(a.nearest)).norm(), through = (b.position - a.position).norm();
      ways[i] = through <= most_compression * past ? through : past;
    }
  });
  const auto cuts = [&](double way) { return std::clamp(std::ceil(way / most), 1.0, most_cuts); };
  const double farthest = *std::max_element(ways.begin(), ways.end());
  std::vector<PlaceWay> others = ways_outside(moved, blade, outside, finest);
  std::erase_if(others, [&](const PlaceWay& w) { return cuts(w.length()) <= cuts(farthest); });
  if (others.empty()) return static_cast<int>(cuts(farthest));
  return static_cast<int>(cuts(std::max(farthest, longest_way_through(moved, blade, others, most))));
}

double sheet_deviation(const Body& body, const MapAt& half, const Blade& blade, const EdgeFront& from,
                       std::span<const Vec3> to, const FrontAnchor& anchor) {
  const auto& points = from.front.points;
  std::vector<double> distances(points.size(), 0);
  parallel_for(points.size() - 1, 8, [&](std::size_t begin, std::size_t end) {
    InverseDeformation::VertexCache memory;
    for (std::size_t k = begin; k < end; ++k) {
      const bool stands = points[k].position == to[k] || points[k + 1].position == to[k + 1];
      if (!points[k].id.valid() || !points[k + 1].id.valid() || stands) continue;
      const double at = 0.5 * (from.at[k] + from.at[k + 1]);
      const Vec3 before = 0.5 * (points[k].position + points[k + 1].position);
      const auto place = half.map().to_material(half.pose() * place_on(blade, at), memory, &before);
      if (!place.in_support) continue;
      const double spacing = body.nodes.spacing[place.nearest.index()];
      const Vec3 swept = anchor.corrected(at, place.position, spacing);
      // A point that was inserted has no segment of its own: beside it the edge passes over the
      // next strip.
      double distance = std::numeric_limits<double>::infinity();
      for (std::size_t j = 0; j + 1 < points.size(); ++j)
        distance = std::min(distance, distance_from_strip(swept, points, to, j));
      distances[k] = distance / spacing;
    }
  });
  return *std::max_element(distances.begin(), distances.end());
}

double sheet_turning(const Complex& surface, std::span<const FaceId> faces, double lowest) {
  double largest = 0;
  for (const FaceId f : faces) {
    if (!surface.alive(f)) continue;
    const auto t = surface.corners(f);
    if (height_of(t) < lowest) continue;
    const Vec3 n = (t[1] - t[0]).cross(t[2] - t[0]).normalized();
    for (std::size_t k = 0; k < 3; ++k) {
      const VertexId a = surface.face(f).v[k], b = surface.face(f).v[(k + 1) % 3];
      for (const FaceId g : surface.faces_around(a, b)) {
        if (g == f || surface.face(g).crack != surface.face(f).crack) continue;
        const auto s = surface.corners(g);
        if (height_of(s) < lowest) continue;
        const Vec3 m = (s[1] - s[0]).cross(s[2] - s[0]).normalized() * (has_in_order(surface, g, b, a) ? 1 : -1);
        largest = std::max(largest, std::acos(std::clamp(n.dot(m), -1.0, 1.0)) * 180 / std::numbers::pi);
      }
    }
  }
  return largest;
}

std::size_t count_crumbs(const Body& body) {
  const Pieces pieces = find_pieces(body.surface);
  double total = 0;
  for (const double v : pieces.volume) total += v;
  const double least = 0.1 * total / double(std::max<std::size_t>(1, body.nodes.size()));
  return static_cast<std::size_t>(
      std::count_if(pieces.volume.begin(), pieces.volume.end(), [&](double v) { return v < least; }));
}

}  // namespace geo
