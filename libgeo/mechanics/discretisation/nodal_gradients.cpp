// Moment matrices A_i = Σ_j w_ij x_ij x_ijᵀ are inverted by their eigenvalues (pseudo-inverse), so
// nodes on a plane or line keep the gradient along it. The mode penalty is differentiated by the
// chain rule through ∇u_i.
#include "mechanics/discretisation/nodal_gradients.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "geometry/nearest_rotation.h"
#include "kerf/parallel.h"
#include "mechanics/discretisation/kernel.h"
#include "mechanics/terms/weighted_sums.h"

namespace geo {
namespace {

// Directions in which the neighbours extend less than a thirtieth of the largest extent (1e-3 of
// its square) carry no gradient: it would divide the noise of contact by next to nothing. A chain
// of nodes in a flap between two cuts is such a star (docs/decisions/101).
constexpr double least_spread = 1e-3;

NodalGradientOperator::Node build(std::uint32_t i, const NodeSet& nodes, const VisibilityGraph& graph) {
  NodalGradientOperator::Node node;
  Mat3 moment = Mat3::Zero();
  std::vector<double> weights;
  const double scale = nodes.radius[i];
  double sum = 0;
  for (const auto& n : graph.neighbors(nodes, NodeId(i))) {
    const double h = std::max(nodes.radius[i], nodes.radius[n.to.index()]);
    const double w = kernel(n.distance / h, 1.0);  // the moment matrix cancels the kernel's scale
    if (w <= 0) continue;
    const Vec3 x = nodes.position[n.to.index()] - nodes.position[i];
    node.neighbors.push_back(n.to.value);
    node.offset.push_back(x);
    weights.push_back(w);
    sum += w;
    moment += w / (scale * scale) * x * x.transpose();
  }
  // Pseudo-inverse: where neighbours hardly extend, there is no gradient.
  const Eigen::SelfAdjointEigenSolver<Mat3> eigen(moment);
  const Vec3 values = eigen.eigenvalues();
  Vec3 inverse = Vec3::Zero();
  int rank = 0;
  for (int k = 0; k < 3; ++k)
    if (values[k] > least_spread * values[2] && values[k] > 0) {
      inverse[k] = 1 / values[k];
      ++rank;
    }
  node.quality = rank == 3                                ? MomentQuality::good
                 : rank > 0 && node.neighbors.size() >= 2 ? MomentQuality::poor
                                                          : MomentQuality::singular;
  if (node.quality == MomentQuality::singular) inverse.setZero();
  const Mat3 pseudo_inverse = eigen.eigenvectors() * inverse.asDiagonal() * eigen.eigenvectors().transpose();
  for (std::size_t q = 0; q < node.neighbors.size(); ++q) {
    node.gradient.push_back(weights[q] / (scale * scale) * (pseudo_inverse * node.offset[q]));
    node.own_gradient -= node.gradient.back();
    node.normalised_weight.push_back(weights[q] / sum / node.offset[q].squaredNorm());
  }
  return node;
}

}  // namespace

void NodalGradientOperator::update(const NodeSet& nodes, const VisibilityGraph& graph,
                                   std::span<const NodeId> updated) {
  nodes_.resize(nodes.size());
  parallel_for(updated.size(), 64, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) nodes_[updated[k].index()] = build(updated[k].value, nodes, graph);
  });
}

void NodalGradientOperator::set_rotations(const std::vector<Mat3>& rotation) {
  undetermined_.assign(rotation.empty() ? 0 : size(), Mat3::Zero());
  for (std::size_t i = 0; i < undetermined_.size(); ++i) {
    const Node& node = nodes_[i];
    if (node.quality == MomentQuality::good) continue;
    Mat3 rest = Mat3::Identity();  // 1 − Σ x gᵀ
    for (std::size_t q = 0; q < node.neighbors.size(); ++q) rest -= node.offset[q] * node.gradient[q].transpose();
    undetermined_[i] = (rotation[i] - Mat3::Identity()) * rest;
  }
}

Mat3 NodalGradientOperator::gradient(std::size_t i, const std::vector<Vec3>& u) const {
  Mat3 g = Mat3::Zero();
  const Node& node = nodes_[i];
  for (std::size_t q = 0; q < node.neighbors.size(); ++q)
    g += (u[node.neighbors[q]] - u[i]) * node.gradient[q].transpose();
  return g;
}

double NodalGradientOperator::amplification(std::size_t i, const Vec3& arm) const {
  const Node& node = nodes_[i];
  double sum = std::abs(node.own_gradient.dot(arm));
  for (const Vec3& g : node.gradient) sum += std::abs(g.dot(arm));
  return sum;
}

Mat3 NodalGradientOperator::rotation(std::size_t i, const std::vector<Vec3>& u) const {
  // Share of State::rotation where neighbours do not span space, of the trace of Σ ŵ x xᵀ, which is
  // 1: as in debris.cpp.
  constexpr double memory = 1e-3;
  const Node& node = nodes_[i];
  Mat3 spread = node.quality == MomentQuality::good ? Mat3(Mat3::Zero()) : Mat3(memory * Mat3::Identity());
  for (std::size_t q = 0; q < node.neighbors.size(); ++q)
    spread += node.normalised_weight[q] * node.offset[q] * node.offset[q].transpose();
  return nearest_rotation((Mat3::Identity() + displacement_gradient(i, u)) * spread).rotation;
}

std::vector<PaddedMat3> NodalGradientOperator::padded_gradients(const std::vector<Vec3>& u) const {
  const std::vector<PaddedVec3> values = padded(u);
  std::vector<PaddedMat3> g(size());
  parallel_for(size(), 128, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      g[i] = mls_gradient(nodes_[i].neighbors, nodes_[i].gradient.data(), values.data(), static_cast<std::uint32_t>(i));
      if (undetermined_.empty()) continue;
      for (int c = 0; c < 3; ++c) Eigen::Map<Vec3>(g[i].at[c]) += undetermined_[i].col(c);
    }
  });
  return g;
}

std::vector<Mat3> NodalGradientOperator::gradients(const std::vector<Vec3>& u) const {
  const auto padded = padded_gradients(u);
  std::vector<Mat3> g(padded.size());
  for (std::size_t i = 0; i < g.size(); ++i)
    for (int c = 0; c < 3; ++c) g[i].col(c) = Eigen::Map<const Vec3>(padded[i].at[c]);
  return g;
}

ShapeGradients NodalGradientOperator::shape_gradients(std::size_t i) const {
  const Node& node = nodes_[i];
  ShapeGradients shape{.nodes = node.neighbors, .gradient = node.gradient, .bent = {}};
  const auto at = std::lower_bound(shape.nodes.begin(), shape.nodes.end(), i) - shape.nodes.begin();
  shape.nodes.insert(shape.nodes.begin() + at, static_cast<std::uint32_t>(i));
  shape.gradient.insert(shape.gradient.begin() + at, node.own_gradient);
  return shape;
}

ModePenalty::ModePenalty(const NodalGradientOperator& gradients, std::vector<double> weight)
    : weight_(std::move(weight)), occurrences_(gradients.size()) {
  for (std::uint32_t i = 0; i < gradients.size(); ++i)
    for (std::uint32_t q = 0; q < gradients[i].neighbors.size(); ++q)
      occurrences_[gradients[i].neighbors[q]].push_back({i, q});
}

double ModePenalty::add(const NodalGradientOperator& gradients, const std::vector<Vec3>& u,
                        std::vector<Vec3>* derivative) const {
  const std::size_t n = weight_.size();
  std::vector<double> energy(n, 0);
  std::vector<std::vector<Vec3>> by_residual(n);  // per node and neighbour: derivative by the residual r
  std::vector<Mat3> by_gradient(n);               // per node: derivative by ∇u_i
  parallel_for(n, 64, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const auto& node = gradients[i];
      const Mat3 gradient = gradients.gradient(i, u);
      by_gradient[i].setZero();
      for (std::size_t q = 0; q < node.neighbors.size(); ++q) {
        const Vec3 r = u[node.neighbors[q]] - u[i] - gradient * node.offset[q];
        const double w = weight_[i] * node.normalised_weight[q];
        energy[i] += 0.5 * w * r.squaredNorm();
        if (derivative) {
          by_residual[i].push_back(w * r);
          by_gradient[i] -= w * r * node.offset[q].transpose();
        }
      }
    }
  });
  double sum = 0;
  for (const double e : energy) sum += e;
  if (!derivative) return sum;
  parallel_for(n, 128, [&](std::size_t begin, std::size_t end) {
    for (std::size_t j = begin; j < end; ++j) {
      Vec3 f = by_gradient[j] * gradients[j].own_gradient;
      for (const Vec3& p : by_residual[j]) f -= p;
      for (const auto& [i, q] : occurrences_[j]) f += by_gradient[i] * gradients[i].gradient[q] + by_residual[i][q];
      (*derivative)[j] += f;
    }
  });
  return sum;
}

void ModePenalty::add_diagonal(const NodalGradientOperator& gradients, std::vector<double>& diagonal) const {
  for (std::size_t j = 0; j < weight_.size(); ++j) {
    for (const double s : gradients[j].normalised_weight) diagonal[j] += weight_[j] * s;
    for (const auto& [i, q] : occurrences_[j]) diagonal[j] += weight_[i] * gradients[i].normalised_weight[q];
  }
}

}  // namespace geo
