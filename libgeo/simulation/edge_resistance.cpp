// Vertices are those of the segments of a front that lie in the material: its points, and its
// contacts with the mesh between them, each with half of the segments beside it.
#include "simulation/edge_resistance.h"

#include <algorithm>

#include "mechanics/solver/solid_discretisation.h"
#include "simulation/edge_retreat.h"

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

}  // namespace

// A front, its blade, and the body in a time step.
struct EdgeResistance::FrontInStep {
  std::size_t blade;
  const EdgeFront& edge;
  const TimeStep& step;
  const Body& body;
  const SolidDiscretisation& solid;
  const State& motion;
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
      if (!edge.is_left)
        add_front({.blade = b,
                   .edge = edge,
                   .step = step,
                   .body = body,
                   .solid = SolidDiscretisation::of(solid),
                   .motion = state.motion});
  }
}

void EdgeResistance::add_front(const FrontInStep& at) {
  const Blade& blade = scene_.blades[at.blade];
  const FrontState& front = at.edge.front;
  const Pose begin = blade.motion.at(at.step.begin), end = blade.motion.at(at.step.end);
  const std::vector<Vec3>& u = at.motion.displacement;
  for (const FrontVertex& v : vertices_of(front)) {
    const SurfaceVertexId vertex = surface_vertex_at(at.body.surface, v.id, front.crack);
    if (!vertex.valid() || weights_->stencil(vertex.index()).empty()) continue;
    const std::size_t next = (v.segment + 1) % front.points.size();
    const Vec3 a = place_on(blade, at.edge.at[v.segment]), b = place_on(blade, at.edge.at[next]);
    const Vec3 along = (end.rotation * (b - a)).normalized();
    if (!along.allFinite()) continue;
    const Vec3 place = a + v.share * (b - a), rest = weights_->placed(vertex.index(), Vec3::Zero());
    const std::uint32_t node = weights_->heaviest()[vertex.index()];
    Spring s{.blade = at.blade,
             .vertex = static_cast<std::uint32_t>(vertex.index()),
             .rest = rest,
             .begin = begin * place,
             .end = end * place,
             .now = end * place,
             .across = Mat3::Identity() - along * along.transpose(),
             .limit = 0,
             .lead = edge_lead * at.body.nodes.spacing[node]};
    const Vec3 ahead = s.stretch(weights_->interpolate(vertex.index(), u));
    const Mat3 f = Mat3::Identity() + at.solid.mls.displacement_gradient(node, u);
    const Vec3 in_material = f.inverse() * ahead;
    if (!(ahead.norm() > 0) || !in_material.allFinite()) continue;
    const Vec3& from = at.body.surface.point(v.id);
    if (leads_back(at.body.surface, front, from, from + in_material, at.body.nodes.spacing[node])) continue;
    // A way in the world is another one in the material, whose area counts.
    s.limit = blade.resistance * v.length * in_material.norm() / ahead.norm();
    springs_.push_back(s);
  }
}

void EdgeResistance::begin_substep(const std::vector<Vec3>& /*u*/, double /*from*/, double to) {
  for (Spring& s : springs_) s.now = s.begin + to * (s.end - s.begin);
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
  Derivatives result{.force = force(s, d), .hessian = s.limit / std::max(s.lead, length) * s.across};
  if (length > s.lead) result.hessian -= s.limit / (length * length * length) * stretch * stretch.transpose();
  return result;
}

void EdgeResistance::end_step(const std::vector<Vec3>& u, double share, FrameStats& stats) const {
  stats.blade_force.resize(scene_.blades.size(), Vec3::Zero());
  for (const Spring& s : springs_) {
    const Vec3 on_body = force(s, weights_->interpolate(s.vertex, u));
    stats.blade_force[s.blade] -= share * on_body;
    stats.work += on_body.dot(s.end - s.begin);
  }
}

}  // namespace geo
