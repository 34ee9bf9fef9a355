// A thread bears tension alone. Its Hessian has the term across the thread, too, which is positive
// where the thread is stretched.
#include "simulation/stitches.h"

#include <algorithm>
#include <map>

#include "kerf/error.h"
#include "mechanics/terms/contact_law.h"
#include "simulation/pulls.h"

namespace geo {
namespace {

std::vector<NodeWeight> weights_of(const Stitch::End& end, const Body& body, const Solid& solid) {
  const NodeId node = end.node ? NodeId(*end.node) : nearest_original_node(body, end.point);
  if (node.index() >= body.nodes.size()) throw InputError("a stitch holds a node that does not exist");
  return point_weights(body, solid, node, end.point);
}

// Weights of the first end less those of the second, ascending.
std::vector<NodeWeight> relative_weights(const Stitch& stitch, const Body& body, const Solid& solid) {
  std::map<std::uint32_t, double> sum;
  for (const NodeWeight& e : weights_of(stitch.ends[0], body, solid)) sum[e.node] += e.weight;
  for (const NodeWeight& e : weights_of(stitch.ends[1], body, solid)) sum[e.node] -= e.weight;
  std::vector<NodeWeight> weights;
  for (const auto& [node, weight] : sum)
    if (weight != 0) weights.push_back({node, weight});
  return weights;
}

}  // namespace

double distance_of_ends(const Stitch& stitch, const Body& body, const Solid& solid, const std::vector<Vec3>& u) {
  const std::vector<NodeWeight> weights = relative_weights(stitch, body, solid);
  return (stitch.ends[0].point - stitch.ends[1].point + weighted_sum(weights, u)).norm();
}

double StitchPotential::Thread::stretch(const Vec3& d) const { return std::max(0.0, (apart + d).norm() - now); }

Vec3 StitchPotential::Thread::force(const Vec3& d) const {
  const Vec3 r = apart + d;
  const double length = r.norm();
  return length > now ? Vec3(-stiffness * (1 - now / length) * r) : Vec3(Vec3::Zero());
}

void StitchPotential::begin_step(const std::vector<Stitch>& stitches, const Body& body, const Solid& solid, double time,
                                 double end) {
  threads_.clear();
  weights_.resize(stitches.size());
  for (std::size_t s = 0; s < stitches.size(); ++s) {
    const Stitch& stitch = stitches[s];
    if (!stitch.active(time, end)) continue;
    if (weights_[s].empty()) weights_[s] = relative_weights(stitch, body, solid);
    const Vec3 apart = stitch.ends[0].point - stitch.ends[1].point;
    Stitch known = stitch;
    if (!known.slack) known.slack = apart.norm();
    const double from = known.rest_length(time), to = known.rest_length(end);
    threads_.push_back(
        {.stitch = s, .apart = apart, .begin = from, .end = to, .now = to, .stiffness = stitch.stiffness});
  }
}

void StitchPotential::begin_substep(const std::vector<Vec3>& /*u*/, double /*from*/, double to) {
  for (Thread& t : threads_) t.now = t.begin + to * (t.end - t.begin);
}

double StitchPotential::energy(std::size_t k, const Vec3& d) const {
  const double stretch = threads_[k].stretch(d);
  return penalty_energy(threads_[k].stiffness, stretch * stretch);
}

// Where both ends are at one place and the rest length is zero, the thread is a spring.
Potential::Derivatives StitchPotential::derivatives(std::size_t k, const Vec3& d) const {
  const Thread& t = threads_[k];
  const Vec3 r = t.apart + d;
  const double length = r.norm();
  if (t.now <= 0) return {t.force(d), t.stiffness * Mat3::Identity()};
  if (length <= t.now) return {};
  const Mat3 along = r * r.transpose() / (length * length);
  return {t.force(d), t.stiffness * (along + (1 - t.now / length) * (Mat3::Identity() - along))};
}

void StitchPotential::apply_impulse(const std::vector<Vec3>& u, double h, const std::vector<double>& inverse_mass,
                                    std::vector<Vec3>& velocity) {
  for (std::size_t k = 0; k < threads_.size(); ++k)
    add_impulse(stencil(k), h * threads_[k].force(weighted_sum(stencil(k), u)), inverse_mass, velocity);
}

std::vector<double> StitchPotential::tension(const std::vector<Vec3>& u, std::size_t stitches) const {
  std::vector<double> tension(stitches, 0);
  for (std::size_t k = 0; k < threads_.size(); ++k)
    tension[threads_[k].stitch] = threads_[k].stiffness * threads_[k].stretch(weighted_sum(stencil(k), u));
  return tension;
}

double StitchPotential::work(const std::vector<Vec3>& u) const {
  double work = 0;
  for (std::size_t k = 0; k < threads_.size(); ++k) {
    const Thread& t = threads_[k];
    work += t.stiffness * t.stretch(weighted_sum(stencil(k), u)) * (t.begin - t.end);
  }
  return work;
}

}  // namespace geo
