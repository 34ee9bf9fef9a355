// Weights as in contact/surface/surface_weights.h, for a point that need not be on the surface.
#include "simulation/pulls.h"

#include <algorithm>
#include <map>

#include "mechanics/discretisation/kernel.h"
#include "mechanics/terms/contact_law.h"

namespace geo {

NodeId nearest_original_node(const Body& body, const Vec3& x) {
  NodeId nearest(0u);
  for (std::uint32_t i = 1; i < body.original_nodes; ++i)
    if (squared_distance(body.nodes.position[i], x) < squared_distance(body.nodes.position[nearest.index()], x))
      nearest = NodeId(i);
  return nearest;
}

std::vector<NodeWeight> point_weights(const Body& body, const Solid& solid, NodeId node, const Vec3& x) {
  const NodeSet& nodes = body.nodes;
  std::vector<std::pair<NodeId, double>> carriers{{node, 0}};
  for (const auto& neighbor : body.graph.neighbors(nodes, node)) carriers.push_back({neighbor.to, 0});
  double total = 0;
  for (auto& [i, w] : carriers)
    total += w = kernel((nodes.position[i.index()] - x).norm() / nodes.radius[i.index()], 1.0);
  if (!(total > 0)) {
    carriers.resize(1);
    carriers[0].second = total = 1;
  }
  std::map<NodeId, double> sum;
  std::vector<std::pair<NodeId, Vec3>> gradient;
  for (const auto& [i, w] : carriers) {
    if (!(w > 0)) continue;
    sum[i] += w / total;
    gradient.clear();
    solid.gradient_stencil(i, gradient);
    for (const auto& [j, g] : gradient) sum[j] += w / total * g.dot(x - nodes.position[i.index()]);
  }
  std::vector<NodeWeight> weights;
  for (const auto& [i, w] : sum)
    if (w != 0) weights.push_back({i.value, w});
  return weights;
}

void PullPotential::begin_step(const std::vector<Pull>& pulls, const Body& body, const Solid& solid, double time,
                               double end) {
  springs_.clear();
  weights_.resize(pulls.size());
  for (std::size_t p = 0; p < pulls.size(); ++p) {
    const Pull& pull = pulls[p];
    if (!pull.motion.active(time) || !pull.motion.active(end)) continue;
    if (weights_[p].empty())
      weights_[p] = point_weights(body, solid, pull.node ? NodeId(*pull.node) : nearest_original_node(body, pull.point),
                                  pull.point);
    const Vec3 from = pull.motion.at(time).position, to = pull.motion.at(end).position;
    springs_.push_back(
        {.pull = p, .point = pull.point, .begin = from, .end = to, .now = to, .stiffness = pull.stiffness});
  }
}

void PullPotential::begin_substep(const std::vector<Vec3>& /*u*/, double /*from*/, double to) {
  for (Spring& s : springs_) s.now = s.begin + to * (s.end - s.begin);
}

double PullPotential::energy(std::size_t k, const Vec3& d) const {
  return penalty_energy(springs_[k].stiffness, springs_[k].stretch(d).squaredNorm());
}

Potential::Derivatives PullPotential::derivatives(std::size_t k, const Vec3& d) const {
  const Spring& s = springs_[k];
  return {-s.stiffness * s.stretch(d), s.stiffness * Mat3::Identity()};
}

void PullPotential::apply_impulse(const std::vector<Vec3>& u, double h, const std::vector<double>& inverse_mass,
                                  std::vector<Vec3>& velocity) {
  for (std::size_t k = 0; k < springs_.size(); ++k)
    add_impulse(stencil(k), -h * springs_[k].stiffness * springs_[k].stretch(weighted_sum(stencil(k), u)), inverse_mass,
                velocity);
}

std::vector<Vec3> PullPotential::reaction(const std::vector<Vec3>& u, std::size_t pulls) const {
  std::vector<Vec3> force(pulls, Vec3::Zero());
  for (std::size_t k = 0; k < springs_.size(); ++k)
    force[springs_[k].pull] = springs_[k].stiffness * springs_[k].stretch(weighted_sum(stencil(k), u));
  return force;
}

double PullPotential::work(const std::vector<Vec3>& u) const {
  double work = 0;
  for (std::size_t k = 0; k < springs_.size(); ++k) {
    const Spring& s = springs_[k];
    work -= s.stiffness * s.stretch(weighted_sum(stencil(k), u)).dot(s.end - s.begin);
  }
  return work;
}

}  // namespace geo
