// Nodes and blade move linearly within a step: u(s) = u_after − (1 − s) (u_after − u_before). So
// the mapped edge moves without jumps from the end of one step to the end of the next.
#include "simulation/blade_way.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "geometry/distance.h"
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

// The time at a fraction of a step, s.
double time_at(const MovedBody& moved, double fraction) {
  return fraction == 1 ? moved.end : moved.begin + fraction * (moved.end - moved.begin);
}

// The height of a triangle over its longest side.
double height(const std::array<Vec3, 3>& t) {
  double longest = 0;
  for (std::size_t k = 0; k < 3; ++k) longest = std::max(longest, (t[(k + 1) % 3] - t[k]).norm());
  return longest > 0 ? (t[1] - t[0]).cross(t[2] - t[0]).norm() / longest : 0;
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

// The longest way of those blade points `outside` the body before and after a step that pass
// through it. Looks at steps of `most`.
double longest_way_through(const MovedBody& moved, const Blade& blade, std::span<const std::size_t> outside,
                           double most) {
  const Pose from = blade.motion.at(moved.begin), to = blade.motion.at(moved.end);
  Box3 swept;
  for (const std::size_t i : outside) swept.add(from * blade.points[i]), swept.add(to * blade.points[i]);
  const MapAt after(moved, blade, 1, swept);
  InverseDeformation::VertexCache memory;
  double longest = 0;
  for (const std::size_t i : outside) {
    const Vec3 start = from * blade.points[i], way = to * blade.points[i] - start;
    const double steps = std::min(std::ceil(way.norm() / most), most_cuts);
    for (int k = 1; k < steps && way.norm() > longest; ++k)
      if (after.map().to_material(start + k / steps * way, memory).in_support) longest = way.norm();
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
      displacement_(moved.way.at(moved.motion.displacement, fraction)),
      gradient_(lazy_gradients(moved.solid.discretisation(), displacement_)),
      map_(moved.body, displacement_, gradient_, box) {}

int number_of_cuts(const MovedBody& moved, const Blade& blade, std::span<const EdgeFront> fronts) {
  const auto& spacing = moved.body.nodes.spacing;
  const double most = blade.limit * *std::min_element(spacing.begin(), spacing.end());
  if (longest_way(moved, blade) <= most) return 1;
  const MapAt before(moved, blade, 0), after(moved, blade, 1);
  std::vector<double> ways(blade.points.size(), 0);
  std::vector<double> ways_outside(ways.size(), 0);
  parallel_for(ways.size(), 4, [&](std::size_t begin, std::size_t end) {
    InverseDeformation::VertexCache before_memory, after_memory;
    for (std::size_t i = begin; i < end; ++i) {
      const std::optional<Vec3> place = place_on(fronts, double(i));
      const Vec3 from = before.pose() * blade.points[i], to = after.pose() * blade.points[i];
      const auto a = before.map().to_material(from, before_memory, place ? &*place : nullptr);
      const auto b = after.map().to_material(to, after_memory, &a.position);
      if (!a.in_support || !b.in_support) {
        (a.in_support || b.in_support ? ways : ways_outside)[i] = (to - from).norm();
        continue;
      }
      const double past = (to - from - moved.way.of(a.nearest)).norm(), through = (b.position - a.position).norm();
      ways[i] = through <= most_compression * past ? through : past;
    }
  });
  const auto cuts = [&](double way) { return std::clamp(std::ceil(way / most), 1.0, most_cuts); };
  const double farthest = *std::max_element(ways.begin(), ways.end());
  std::vector<std::size_t> outside;  // points that may need more cuts
  for (std::size_t i = 0; i < ways.size(); ++i)
    if (cuts(ways_outside[i]) > cuts(farthest)) outside.push_back(i);
  if (outside.empty()) return static_cast<int>(cuts(farthest));
  return static_cast<int>(cuts(std::max(farthest, longest_way_through(moved, blade, outside, most))));
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
    if (height(t) < lowest) continue;
    const Vec3 n = (t[1] - t[0]).cross(t[2] - t[0]).normalized();
    for (std::size_t k = 0; k < 3; ++k) {
      const VertexId a = surface.face(f).v[k], b = surface.face(f).v[(k + 1) % 3];
      for (const FaceId g : surface.faces_around(a, b)) {
        if (g == f || surface.face(g).crack != surface.face(f).crack) continue;
        const auto s = surface.corners(g);
        if (height(s) < lowest) continue;
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
