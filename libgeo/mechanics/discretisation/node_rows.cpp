#include "mechanics/discretisation/node_rows.h"

#include <Eigen/Eigenvalues>
#include <algorithm>

#include "kerf/parallel.h"
#include "mechanics/discretisation/kernel.h"
#include "mechanics/terms/weighted_sums.h"

namespace geo {
namespace {

NodeRows::Row build(std::uint32_t i, const NodeSet& nodes, const VisibilityGraph& graph) {
  NodeRows::Row row;
  Mat3 moment = Mat3::Zero();
  std::vector<double> weights;
  const double scale = nodes.radius[i];
  double sum = 0;
  for (const auto& n : graph.neighbors(nodes, NodeId(i))) {
    const double h = std::max(nodes.radius[i], nodes.radius[n.to.index()]);
    const double w = kernel(n.distance / h, 1.0);  // the moment matrix cancels the kernel's scale
    if (w <= 0) continue;
    const Vec3 x = nodes.position[n.to.index()] - nodes.position[i];
    row.to.push_back(n.to.value);
    row.x.push_back(x);
    weights.push_back(w);
    sum += w;
    moment += w / (scale * scale) * x * x.transpose();
  }
  // Directions in which the neighbours hardly spread carry no gradient: their part of the inverse
  // is left out.
  const Eigen::SelfAdjointEigenSolver<Mat3> eigen(moment);
  const Vec3 values = eigen.eigenvalues();
  Vec3 inverse = Vec3::Zero();
  int kept = 0;
  for (int k = 0; k < 3; ++k)
    if (values[k] > 1e-4 * values[2] && values[k] > 0) inverse[k] = 1 / values[k], ++kept;
  row.rung = kept == 3 ? Rung::full : kept > 0 && row.to.size() >= 2 ? Rung::regularised : Rung::rigid;
  if (row.rung == Rung::rigid) inverse.setZero();
  const Mat3 solve = eigen.eigenvectors() * inverse.asDiagonal() * eigen.eigenvectors().transpose();
  for (std::size_t q = 0; q < row.to.size(); ++q) {
    row.g.push_back(weights[q] / (scale * scale) * (solve * row.x[q]));
    row.g_self -= row.g.back();
    row.share.push_back(weights[q] / sum / row.x[q].squaredNorm());
  }
  return row;
}

}  // namespace

void NodeRows::update(const NodeSet& nodes, const VisibilityGraph& graph, std::span<const NodeId> updated) {
  rows_.resize(nodes.size());
  parallel_for(updated.size(), 64, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) rows_[updated[k].index()] = build(updated[k].value, nodes, graph);
  });
}

Mat3 NodeRows::gradient(std::size_t i, const std::vector<Vec3>& u) const {
  Mat3 g = Mat3::Zero();
  const Row& row = rows_[i];
  for (std::size_t q = 0; q < row.to.size(); ++q) g += (u[row.to[q]] - u[i]) * row.g[q].transpose();
  return g;
}

std::vector<FourColumns> NodeRows::columns(const std::vector<Vec3>& u) const {
  const std::vector<PaddedVec3> numbers = padded(u);
  std::vector<FourColumns> g(size());
  parallel_for(size(), 128, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      g[i] = row_gradient(rows_[i].to, rows_[i].g.data(), numbers.data(), static_cast<std::uint32_t>(i));
  });
  return g;
}

std::vector<Mat3> NodeRows::gradients(const std::vector<Vec3>& u) const {
  const auto columns = this->columns(u);
  std::vector<Mat3> g(columns.size());
  for (std::size_t i = 0; i < g.size(); ++i)
    for (int c = 0; c < 3; ++c) g[i].col(c) = Eigen::Map<const Vec3>(columns[i].at[c]);
  return g;
}

ShapeRow NodeRows::row(std::size_t i) const {
  const Row& from = rows_[i];
  ShapeRow row{from.to, from.g};
  const auto at = std::lower_bound(row.to.begin(), row.to.end(), i) - row.to.begin();
  row.to.insert(row.to.begin() + at, static_cast<std::uint32_t>(i));
  row.gradient.insert(row.gradient.begin() + at, from.g_self);
  return row;
}

ModePenalty::ModePenalty(const NodeRows& rows, std::vector<double> weight)
    : weight_(std::move(weight)), incoming_(rows.size()) {
  for (std::uint32_t i = 0; i < rows.size(); ++i)
    for (std::uint32_t q = 0; q < rows[i].to.size(); ++q) incoming_[rows[i].to[q]].push_back({i, q});
}

double ModePenalty::add(const NodeRows& rows, const std::vector<Vec3>& u, std::vector<Vec3>* out) const {
  const std::size_t n = weight_.size();
  std::vector<double> energy(n, 0);
  std::vector<std::vector<Vec3>> pull(n);
  std::vector<Mat3> through(n);  // what the residuals pull through ∇u
  parallel_for(n, 64, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const auto& row = rows[i];
      const Mat3 gradient = rows.gradient(i, u);
      through[i].setZero();
      for (std::size_t q = 0; q < row.to.size(); ++q) {
        const Vec3 r = u[row.to[q]] - u[i] - gradient * row.x[q];
        const double w = weight_[i] * row.share[q];
        energy[i] += 0.5 * w * r.squaredNorm();
        if (out) pull[i].push_back(w * r), through[i] -= w * r * row.x[q].transpose();
      }
    }
  });
  double sum = 0;
  for (const double e : energy) sum += e;
  if (!out) return sum;
  parallel_for(n, 128, [&](std::size_t begin, std::size_t end) {
    for (std::size_t j = begin; j < end; ++j) {
      Vec3 f = through[j] * rows[j].g_self;
      for (const Vec3& p : pull[j]) f -= p;
      for (const auto& [i, q] : incoming_[j]) f += through[i] * rows[i].g[q] + pull[i][q];
      (*out)[j] += f;
    }
  });
  return sum;
}

void ModePenalty::add_diagonal(const NodeRows& rows, std::vector<double>& out) const {
  for (std::size_t j = 0; j < weight_.size(); ++j) {
    for (const double s : rows[j].share) out[j] += weight_[j] * s;
    for (const auto& [i, q] : incoming_[j]) out[j] += weight_[i] * rows[i].share[q];
  }
}

}  // namespace geo
