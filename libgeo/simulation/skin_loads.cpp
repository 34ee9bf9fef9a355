// Vertices that a box holds are those of skin triangles with all corners in it. They are found
// again after each crack step, which divides triangles and vertices.
#include "simulation/skin_loads.h"

#include <map>
#include <string>

#include "kerf/error.h"
#include "mechanics/terms/contact_law.h"

namespace geo {
namespace {

// Thickness of the layer of material that a support is as stiff as, in node spacings.
constexpr double support_layer = 0.01;

bool is_inside(const Vec3& x, const Vec3& lo, const Vec3& hi) {
  return (x.array() >= lo.array()).all() && (x.array() <= hi.array()).all();
}

}  // namespace

SkinLoads::SkinLoads(const Scene& scene, const Body& body) : scene_(scene) {
  if (!any()) return;
  find_all(body);
  std::vector<char> has_skin(scene.loads.size() + scene.supports.size(), 0);
  for (const Term& t : terms_) has_skin[t.load] = 1;
  for (std::size_t l = 0; l < has_skin.size(); ++l) {
    if (has_skin[l]) continue;
    const bool is_load = l < scene.loads.size();
    throw InputError(std::string(is_load ? "load " : "support ") +
                     std::to_string(is_load ? l + 1 : l + 1 - scene.loads.size()) +
                     ": its box holds no whole triangle of the skin; make the box larger, or the model's triangles "
                     "smaller");
  }
}

void SkinLoads::find_terms(const Body& body, const Vec3& lo, const Vec3& hi, std::size_t load,
                           std::vector<Term>& terms) {
  std::vector<FaceId> near;
  Box3 box{lo, lo};
  box.add(hi);
  body.surface.faces_near(box, near);
  std::map<std::uint32_t, double> area;
  for (const FaceId face : near) {
    if (body.surface.face(face).crack != 0) continue;
    const auto [a, b, c] = body.surface.corners(face);
    if (!is_inside(a, lo, hi) || !is_inside(b, lo, hi) || !is_inside(c, lo, hi)) continue;
    for (int k = 0; k < 3; ++k)
      area[body.surface.surface_vertex({face, 0}, k).index()] += (b - a).cross(c - a).norm() / 6;
  }
  for (const auto& [vertex, a] : area)
    terms.push_back({.load = load, .vertex = vertex, .area = a, .stiffness = 0, .before = Vec3::Zero()});
}

void SkinLoads::find_all(const Body& body) {
  terms_.clear();
  std::size_t load = 0;
  for (const Load& t : scene_.loads) find_terms(body, t.lo, t.hi, load++, terms_);
  for (const Support& s : scene_.supports) find_terms(body, s.lo, s.hi, load++, terms_);
  crack_steps_ = body.crack_steps;
}

SkinLoads::Action SkinLoads::load_in(const Load& load, const TimeStep& step) const {
  const double end = load.share(step.end);
  return {.is_support = false,
          .acts = end > 0,
          .begin = load.share(step.begin) * load.traction,
          .end = end * load.traction,
          .now = end * load.traction};
}

SkinLoads::Action SkinLoads::support_in(const Support& support, const TimeStep& step) const {
  if (support.motion.keys.empty()) return {.is_support = true, .acts = support.active(step.end)};
  const Vec3 end = support.motion.at(step.end).position;
  return {.is_support = true,
          .acts = support.active(step.end),
          .begin = support.motion.at(step.begin).position,
          .end = end,
          .now = end};
}

void SkinLoads::begin_step(const TimeStep& step, const Body& body, const Solid& solid, const SurfaceWeights& weights) {
  weights_ = &weights;
  if (crack_steps_ != body.crack_steps) find_all(body);
  actions_.clear();
  for (const Load& t : scene_.loads) actions_.push_back(load_in(t, step));
  for (const Support& s : scene_.supports) actions_.push_back(support_in(s, step));
  acting_.clear();
  for (const Term& t : terms_) {
    if (!actions_[t.load].acts || weights.stencil(t.vertex).empty()) continue;
    acting_.push_back(t);
    if (!actions_[t.load].is_support) continue;
    const std::uint32_t node = weights.heaviest()[t.vertex];
    acting_.back().stiffness = t.area * solid.materials().of(node).young / (support_layer * body.nodes.spacing[node]);
  }
}

Vec3 SkinLoads::displacement(const Term& term, const std::vector<Vec3>& u) const {
  return weighted_sum(weights_->stencil(term.vertex), u);
}

void SkinLoads::begin_substep(const std::vector<Vec3>& u, double from, double to) {
  for (Action& l : actions_) l.now = l.begin + to * (l.end - l.begin);
  if (from > 0) return;
  for (Term& t : acting_) t.before = displacement(t, u);
}

// On the vertex, at its displacement d by all its nodes.
Vec3 SkinLoads::force(const Term& term, const Vec3& d) const {
  const Action& load = actions_[term.load];
  if (!load.is_support) return term.area * load.now;
  Vec3 on_axes = Vec3::Zero();
  for (int axis = 0; axis < 3; ++axis)
    if (axes_of(term.load)[axis]) on_axes[axis] = term.stiffness * (load.now[axis] - d[axis]);
  return on_axes;
}

double SkinLoads::energy(std::size_t k, const Vec3& d) const {
  const Term& t = acting_[k];
  const Vec3 pull = force(t, d);
  if (!actions_[t.load].is_support) return -pull.dot(d);
  return pull.squaredNorm() / (2 * t.stiffness);
}

Potential::Derivatives SkinLoads::derivatives(std::size_t k, const Vec3& d) const {
  const Term& t = acting_[k];
  Derivatives result{.force = force(t, d), .hessian = Mat3::Zero()};
  if (!actions_[t.load].is_support) return result;
  for (int axis = 0; axis < 3; ++axis)
    if (axes_of(t.load)[axis]) result.hessian(axis, axis) = t.stiffness;
  return result;
}

void SkinLoads::apply_impulse(const std::vector<Vec3>& u, double h, const std::vector<double>& inverse_mass,
                              std::vector<Vec3>& velocity) {
  for (const Term& t : acting_)
    add_impulse(weights_->stencil(t.vertex), h * force(t, displacement(t, u)), inverse_mass, velocity);
}

void SkinLoads::end_step(const std::vector<Vec3>& u, double share, FrameStats& stats) const {
  stats.support_force.resize(scene_.supports.size(), Vec3::Zero());
  for (const Term& t : acting_) {
    const Action& load = actions_[t.load];
    const Vec3 now = displacement(t, u), on_body = force(t, now);
    if (!load.is_support) {
      stats.work += on_body.dot(now - t.before);
      continue;
    }
    stats.work += on_body.dot(load.end - load.begin);
    stats.support_force[t.load - scene_.loads.size()] -= share * on_body;
  }
}

}  // namespace geo
