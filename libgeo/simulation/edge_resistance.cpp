// Vertices are those of the segments of a front that lie in the material: its points, and its
// contacts with the mesh between them, each with half of the segments beside it.
#include "simulation/edge_resistance.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "body/locate.h"
#include "geometry/distance.h"
#include "mechanics/solver/solid_discretisation.h"
#include "simulation/edge_retreat.h"
#include "simulation/existing_cuts.h"

namespace geo {
namespace {

// A vertex of a front: its place in a segment, and the length that belongs to it.
struct FrontVertex {
  VertexId id;
  std::size_t segment;
  double share;   // of the way from the segment's first point to its second
  double length;  // model units
};

// The vertices of a front in the material. A point between two segments is there twice.
std::vector<FrontVertex> vertices_of(const FrontState& front) {
  std::vector<FrontVertex> result;
  for (std::size_t s = 0; s < front.segments.size(); ++s) {
    const auto& points = front.segments[s];
    const double whole = points.size() > 1 ? (points.back().position - points.front().position).norm() : 0;
    for (std::size_t k = 0; k < points.size() && whole > 0; ++k) {
      if (!points[k].id.valid()) continue;
      double length = 0;
      for (const std::size_t other : {k - 1, k + 1})
        if (other < points.size() && points[other].id.valid())
          length += 0.5 * (points[other].position - points[k].position).norm();
      const double share = (points[k].position - points.front().position).norm() / whole;
      if (length > 0) result.push_back({.id = points[k].id, .segment = s, .share = share, .length = length});
    }
  }
  return result;
}

// A vertex of the surface at a vertex of a crack's front; on one of its sides, where it has two.
SurfaceVertexId surface_vertex_at(const Complex& surface, VertexId id, std::int32_t crack) {
  for (const FaceId f : surface.faces_at(id)) {
    if (surface.face(f).crack != crack) continue;
    for (int k = 0; k < 3; ++k) {
      const SurfaceVertexId v = surface.surface_vertex({f, 0}, k);
      if (surface.site(v) == id) return v;
    }
  }
  return {};
}

bool lies_below_skin(const Complex& surface, const Vec3& place, double depth) {
  return is_inside(surface, place) && distance_from_crack(surface, 0, place, 2 * depth) > depth;
}

// The place of the skin that a place in air is over, within a node spacing: its nearest place, if
// the way there is along its normal, to 45 degrees.
std::optional<SurfacePoint> skin_below(const Body& body, const Vec3& place) {
  std::vector<FaceId> near;
  body.surface.faces_near(Box3{place, place}.grown(body.finest_spacing), near);
  std::optional<SurfacePoint> result;
  double least = body.finest_spacing;
  for (const FaceId f : near) {
    if (body.surface.face(f).crack != 0) continue;
    const auto [a, b, c] = body.surface.corners(f);
    const Vec3 on = closest_point_on_triangle(place, a, b, c), normal = (b - a).cross(c - a).normalized();
    const double distance = (place - on).norm();
    if (distance >= least || normal.dot(place - on) < std::sqrt(0.5) * distance) continue;
    least = distance;
    const Vec3 weight = barycentric(on, a, b, c);
    SurfacePoint& point = result.emplace(SurfacePoint{.vertex = {}, .weight = {}, .size = 3});
    for (int k = 0; k < 3; ++k) {
      point.vertex[k] = static_cast<std::uint32_t>(body.surface.surface_vertex({f, 0}, k).index());
      point.weight[k] = weight[k];
    }
  }
  return result;
}

// The nodes that carry a place of the surface, each once, with weights of sum 1: (1 − q²)³ with the
// distance q in 1.5 support radii. Those of Eq. 1 have gradients, through which a force on a line
// folds soft material between the nodes. Empty where no node is that near.
std::vector<NodeWeight> carriers(const SurfaceWeights& weights, const SurfacePoint& on, const NodeSet& nodes) {
  Vec3 place = Vec3::Zero();
  std::vector<std::uint32_t> near;
  for (int k = 0; k < on.size; ++k) {
    place += on.weight[k] * weights.rest(on.vertex[k]);
    for (const NodeWeight& e : weights.stencil(on.vertex[k])) near.push_back(e.node);
  }
  std::sort(near.begin(), near.end());
  near.erase(std::unique(near.begin(), near.end()), near.end());
  std::vector<NodeWeight> result;
  double sum = 0;
  for (const std::uint32_t n : near) {
    const double q = (nodes.position[n] - place).norm() / (1.5 * nodes.radius[n]);
    if (q >= 1) continue;
    result.push_back({n, std::pow(1 - q * q, 3)});
    sum += result.back().weight;
  }
  for (NodeWeight& e : result) e.weight /= sum;
  return result;
}

// Longest part of a front in air that is judged by its middle, in node spacings.
constexpr double longest_part = 0.5;

int parts_of(double length, double spacing) {
  return std::max(1, static_cast<int>(std::ceil(length / (longest_part * spacing))));
}

// Whether a front at these places would be in the material, in the middle of a part.
bool any_inside(const Complex& surface, const FrontBehindEdge& front, std::span<const Vec3> places) {
  for (std::size_t i = 0; i + 1 < places.size(); ++i) {
    const double spacing = nearest(front.run, front.edge.at[i]).spacing;
    const int parts = parts_of((places[i + 1] - places[i]).norm(), spacing);
    for (int k = 0; k < parts; ++k)
      if (is_inside(surface, places[i] + (k + 0.5) / parts * (places[i + 1] - places[i]))) return true;
  }
  return false;
}

}  // namespace

double edge_lead(double resistance, double young, double spacing) {
  return std::clamp(4 * resistance / young, resolved_by_front * spacing, 0.5 * spacing);
}

void stay_behind(const Body& body, const Solid& solid, double resistance, const FrontBehindEdge& front,
                 std::vector<Vec3>& to) {
  constexpr double shallowest_entry = 2 * resolved_by_front;  // a front is half as uneven
  const auto& points = front.edge.front.points;
  const bool is_in_air = !has_contact(front.edge.front);
  if (is_in_air && !any_inside(body.surface, front, to)) return;
  bool enters = !is_in_air;
  for (std::size_t i = 0; i < to.size(); ++i) {
    const EdgePoint& p = nearest(front.run, front.edge.at[i]);
    const Vec3& from = points[i].position;
    const double young =
        p.node.valid() ? solid.materials().of(p.node.index()).young : std::numeric_limits<double>::infinity();
    const double way = (to[i] - from).norm(), lead = edge_lead(resistance, young, p.spacing);
    const bool goes_on = way > lead + resolved_by_front * p.spacing;
    to[i] = goes_on ? Vec3(from + (1 - lead / way) * (to[i] - from)) : from;
    enters = enters || lies_below_skin(body.surface, to[i], shallowest_entry * p.spacing);
  }
  if (!enters)
    for (std::size_t i = 0; i < to.size(); ++i) to[i] = points[i].position;
}

// A front, its blade, and the body in a time step.
struct EdgeResistance::FrontInStep {
  std::size_t blade;
  const EdgeFront& edge;
  const TimeStep& step;
  const Body& body;
  const SolidDiscretisation& solid;
  const State& motion;
  double young(std::size_t node) const { return solid.materials.of(node).young; }
};

bool EdgeResistance::any_at(double time) const {
  return std::any_of(scene_.blades.begin(), scene_.blades.end(),
                     [&](const Blade& b) { return b.resistance > 0 && b.active(time); });
}

void EdgeResistance::begin_step(const TimeStep& step, const Body& body, const Solid& solid, const RunState& state,
                                const SurfaceWeights& weights) {
  springs_.clear();
  weights_ = &weights;
  for (std::size_t b = 0; b < scene_.blades.size(); ++b) {
    if (!(scene_.blades[b].resistance > 0) || !scene_.blades[b].active(step.begin)) continue;
    for (const EdgeFront& edge : state.fronts[b])
      if (!edge.is_left) {
        const FrontInStep at{.blade = b,
                             .edge = edge,
                             .step = step,
                             .body = body,
                             .solid = SolidDiscretisation::of(solid),
                             .motion = state.motion};
        has_contact(edge.front) ? add_front(at) : add_skin_below(at);
      }
  }
}

// A spring between a place of the surface and one on the blade, without directions or forces. It
// begins where the surface is; in the step, its place moves as the mean of its nodes.
EdgeResistance::Spring EdgeResistance::spring_at(const FrontInStep& at, const SurfacePoint& on,
                                                 const Vec3& place) const {
  const Blade& blade = scene_.blades[at.blade];
  const std::vector<Vec3>& u = at.motion.displacement;
  Spring s;
  s.blade = at.blade;
  s.nodes = carriers(*weights_, on, at.body.nodes);
  s.node = weights_->heaviest()[on.vertex[0]];
  s.rest = -weighted_sum(s.nodes, u);
  for (int k = 0; k < on.size; ++k)
    s.rest += on.weight[k] * weights_->placed(on.vertex[k], weights_->interpolate(on.vertex[k], u));
  s.begin = blade.motion.at(at.step.begin) * place;
  s.end = s.now = blade.motion.at(at.step.end) * place;
  if (!s.nodes.empty()) s.lead = edge_lead(blade.resistance, at.young(s.node), at.body.nodes.spacing[s.node]);
  return s;
}

void EdgeResistance::add_front(const FrontInStep& at) {
  const Blade& blade = scene_.blades[at.blade];
  const FrontState& front = at.edge.front;
  const Pose end = blade.motion.at(at.step.end);
  const std::vector<Vec3>& u = at.motion.displacement;
  for (const FrontVertex& v : vertices_of(front)) {
    const SurfaceVertexId vertex = surface_vertex_at(at.body.surface, v.id, front.crack);
    if (!vertex.valid()) continue;
    const std::size_t next = (v.segment + 1) % front.points.size();
    const Vec3 a = place_on(blade, at.edge.at[v.segment]), b = place_on(blade, at.edge.at[next]);
    const Vec3 along = (end.rotation * (b - a)).normalized();
    Spring s = spring_at(at, {.vertex = {static_cast<std::uint32_t>(vertex.index())}, .weight = {1}, .size = 1},
                         a + v.share * (b - a));
    if (!along.allFinite() || s.nodes.empty()) continue;
    s.across = Mat3::Identity() - along * along.transpose();
    const Vec3 ahead = s.stretch(weighted_sum(s.nodes, u));
    const Mat3 f = Mat3::Identity() + at.solid.mls.displacement_gradient(s.node, u);
    const Vec3 in_material = f.inverse() * ahead;
    if (!(ahead.norm() > 0) || !in_material.allFinite()) continue;
    const Vec3& from = at.body.surface.point(v.id);
    if (leads_back(at.body.surface, front, from, from + in_material, at.body.nodes.spacing[s.node])) continue;
    // A way in the world is another one in the material, whose area counts.
    s.limit = blade.resistance * v.length * in_material.norm() / ahead.norm();
    springs_.push_back(std::move(s));
  }
}

// Springs for the parts of a front in air that have skin below them.
void EdgeResistance::add_skin_below(const FrontInStep& at) {
  const Blade& blade = scene_.blades[at.blade];
  const auto& points = at.edge.front.points;
  for (std::size_t i = 0; i + 1 < points.size(); ++i) {
    const Vec3 &p = points[i].position, &q = points[i + 1].position;
    const Vec3 a = place_on(blade, at.edge.at[i]), b = place_on(blade, at.edge.at[i + 1]);
    const double length = (q - p).norm();
    const int parts = parts_of(length, at.body.finest_spacing);
    for (int k = 0; k < parts; ++k) {
      const double share = (k + 0.5) / parts;
      const auto below = skin_below(at.body, p + share * (q - p));
      if (!below) continue;
      Spring s = spring_at(at, *below, a + share * (b - a));
      if (s.nodes.empty()) continue;
      Vec3 corner[3];
      for (int c = 0; c < 3; ++c)
        corner[c] = weights_->placed(below->vertex[c], weights_->interpolate(below->vertex[c], at.motion.displacement));
      s.inward = -(corner[1] - corner[0]).cross(corner[2] - corner[0]).normalized();
      s.across = s.inward * s.inward.transpose();
      s.limit = blade.resistance * length / parts;
      if (s.inward.allFinite()) springs_.push_back(std::move(s));
    }
  }
}

void EdgeResistance::begin_substep(const std::vector<Vec3>& /*u*/, double /*from*/, double to) {
  for (Spring& s : springs_) s.now = s.begin + to * (s.end - s.begin);
}

Vec3 EdgeResistance::Spring::stretch(const Vec3& d) const {
  const Vec3 ahead = across * (now - rest - d);
  return ahead.dot(inward) < 0 ? Vec3(Vec3::Zero()) : ahead;
}

double EdgeResistance::energy(std::size_t k, const Vec3& d) const {
  const Spring& s = springs_[k];
  const double stretch = s.stretch(d).norm();
  return stretch < s.lead ? 0.5 * s.limit / s.lead * stretch * stretch : s.limit * (stretch - 0.5 * s.lead);
}

Vec3 EdgeResistance::force(const Spring& s, const Vec3& d) const {
  const Vec3 stretch = s.stretch(d);
  return s.limit / std::max(s.lead, stretch.norm()) * stretch;
}

Potential::Derivatives EdgeResistance::derivatives(std::size_t k, const Vec3& d) const {
  const Spring& s = springs_[k];
  const Vec3 stretch = s.stretch(d);
  const double length = stretch.norm();
  if (length == 0 && !s.inward.isZero(0)) return {.force = Vec3::Zero(), .hessian = Mat3::Zero()};
  Derivatives result{.force = force(s, d), .hessian = s.limit / std::max(s.lead, length) * s.across};
  if (length > s.lead) result.hessian -= s.limit / (length * length * length) * stretch * stretch.transpose();
  return result;
}

void EdgeResistance::end_step(const std::vector<Vec3>& u, double share, FrameStats& stats) const {
  stats.blade_force.resize(scene_.blades.size(), Vec3::Zero());
  for (const Spring& s : springs_) {
    const Vec3 on_body = force(s, weighted_sum(s.nodes, u));
    stats.blade_force[s.blade] -= share * on_body;
    stats.work += on_body.dot(s.end - s.begin);
  }
}

}  // namespace geo
