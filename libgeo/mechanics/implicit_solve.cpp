// Newton's direction: conjugate gradients with products in single precision and sums in double.
#include <algorithm>
#include <cmath>
#include <numeric>

#include "mechanics/ground.h"
#include "mechanics/implicit_step.h"
#include "mechanics/product_lanes.h"

namespace geo {

// The stiffness of points at u_, after evaluate(u_).
void ImplicitStep::linearise() {
  StiffnessConstants constants = stiffness_constants(s_.material_);
  constants.viscous = float(s_.material_.viscosity / dt_);
  parallel_for(modes_.size(), 1, [&](std::size_t begin, std::size_t end) {
    Columns<float> relaxed;
    for (std::size_t b = begin; b < end; ++b) {
      if (!relaxed_.empty()) {
        relaxed.resize(s_.points_.blocks[b].points.size());
        for (std::size_t i = 0; i < s_.points_.blocks[b].points.size(); ++i)
          for (int c = 0; c < 3; ++c) Eigen::Map<Eigen::Vector3f>(&relaxed.column[c][4 * i]) = relaxed_[s_.points_.first(b) + i].col(c).cast<float>();
      }
      stiffness_modes(constants, gradient_[b], relaxed_.empty() ? nullptr : &relaxed, weight_[b], modes_[b]);
    }
  });
}

// What nodes have besides, at u_, and both levels of the preconditioner.
void ImplicitStep::precondition() {
  each_node([&](std::size_t i) {
    local_[i] = s_.mass_[i] / (dt_ * dt_) * Mat3::Identity();
    if (env_.ground) {
      const Mat3 nn = env_.ground_normal * env_.ground_normal.transpose();
      if (depth(env_, i, s_.position_[i] + u_[i]) > 0) local_[i] += s_.mass_[i] * env_.ground_stiffness * nn;
      if (drag_[i] > 0) local_[i] += drag_[i] * (Mat3::Identity() - nn);
    }
  });
  if (coarse_ && env_.contact.empty()) return;  // not much has turned since
  const Material& m = s_.material_;
  const float shear = float(m.mu() + m.viscosity / dt_ / 2), bulk = float(m.lambda() + m.volume_term);
  std::vector<Mat3> blocks = local_;
  for (const Potential* p : env_.contact) p->blocks(blocks);
  if (!coarse_) {
    std::vector<Vec3> at(n_);
    for (std::size_t i = 0; i < n_; ++i) at[i] = s_.position_[i] + u_[i];
    coarse_.emplace(s_.groups_, at, env_.fixed);
    coarse_->factor(s_.points_, modes_, weight_, shear, bulk, s_.point_stride(), blocks);
  }
  if (s_.penalty_) {
    std::vector<double> penalty(n_, 0);
    s_.penalty_->add_diagonal(s_.rows_, penalty);
    each_node([&](std::size_t i) { blocks[i] += penalty[i] * Mat3::Identity(); });
  }
  patches_.emplace(s_.patches_, modes_, shear, bulk, blocks, env_.fixed);
}

void ImplicitStep::elastic_product(const std::vector<Vec3>& p, std::vector<float>& parts) const {
  const MaterialPoints& points = s_.points_;
  parts.resize(4 * points.parts());
  parallel_for(modes_.size(), 1, [&](std::size_t begin, std::size_t end) {
    std::vector<float> values;
    for (std::size_t b = begin; b < end; ++b) {
      const PointBlock& block = points.blocks[b];
      if (block.nodes.empty()) continue;
      values.resize(4 * block.nodes.size());
      const Vec3 base = p[block.nodes[0]];
      for (std::size_t k = 0; k < block.nodes.size(); ++k) {
        const Vec3 from = p[block.nodes[k]] - base;
        for (std::size_t c = 0; c < 3; ++c) values[4 * k + c] = float(from[static_cast<Eigen::Index>(c)]);
      }
      float* const out = &parts[4 * points.part(b)];
      std::fill(out, out + 4 * block.nodes.size(), 0.0f);
      multiply_stiffness(block, modes_[b], values.data(), out);
    }
  });
}

void ImplicitStep::multiply(const std::vector<Vec3>& p, std::vector<Vec3>& out) {
  elastic_product(p, parts_);
  out.resize(n_);
  s_.points_.gather(parts_.data(), 4, [&](std::size_t j, const double* sum) { out[j] = Vec3(sum[0], sum[1], sum[2]) + local_[j] * p[j]; });
  if (s_.penalty_) s_.penalty_->add(s_.rows_, p, &out);
  for (const Potential* c : env_.contact) c->multiply(p, out);
  if (!env_.fixed.empty())
    for (std::size_t i = 0; i < n_; ++i)
      if (env_.fixed[i]) out[i].setZero();
}

double ImplicitStep::dot(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  constexpr std::size_t share = 2048;
  std::vector<double> sums((a.size() + share - 1) / share, 0);
  parallel_for(sums.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k)
      for (std::size_t i = k * share; i < std::min(a.size(), (k + 1) * share); ++i) sums[k] += a[i].dot(b[i]);
  });
  return std::accumulate(sums.begin(), sums.end(), 0.0);
}

// Of the nodes' spacing.
double ImplicitStep::most(const std::vector<Vec3>& moved) const {
  double most = 0;
  for (std::size_t i = 0; i < n_; ++i) most = std::max(most, moved[i].squaredNorm() / (s_.spacing_[i] * s_.spacing_[i]));
  return std::sqrt(most);
}

// Until what is left is a seventh in the norm that counts, or what the preconditioner would still add is `small`.
int ImplicitStep::solve(const std::vector<Vec3>& force, std::vector<Vec3>& x, double small) {
  std::vector<Vec3> r = force, z(n_), p(n_), hp;
  each_node([&](std::size_t i) { x[i].setZero(); });
  patches_->apply(r, z);
  coarse_->add(r, z);
  p = z;
  double rz = dot(r, z);
  const double enough = 0.02 * rz;
  int k = 0;
  for (; k < 500 && rz > enough && !(k > 0 && small > 0 && most(z) < small); ++k) {
    multiply(p, hp);
    const double curvature = dot(p, hp);
    if (!(curvature > 0)) break;
    const double alpha = rz / curvature;
    each_node([&](std::size_t i) { x[i] += alpha * p[i], r[i] -= alpha * hp[i]; });
    patches_->apply(r, z);
    coarse_->add(r, z);
    const double next = dot(r, z), beta = next / rz;
    each_node([&](std::size_t i) { p[i] = z[i] + beta * p[i]; });
    rz = next;
  }
  return k;
}

std::vector<Vec3> ImplicitStep::product(const std::vector<Vec3>& u, const std::vector<Vec3>& p) {
  evaluate(u, nullptr);
  u_ = u;
  linearise();
  std::vector<Vec3> out(n_);
  elastic_product(p, parts_);
  s_.points_.gather(parts_.data(), 4, [&](std::size_t j, const double* sum) { out[j] = Vec3(sum[0], sum[1], sum[2]); });
  if (s_.penalty_) s_.penalty_->add(s_.rows_, p, &out);
  return out;
}

}  // namespace geo
