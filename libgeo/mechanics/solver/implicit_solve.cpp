// Newton's direction: conjugate gradients with products in single precision and sums in double.
#include <algorithm>
#include <cmath>
#include <numeric>

#include "mechanics/discretisation/stiffness_product_lanes.h"
#include "mechanics/solver/ground.h"
#include "mechanics/solver/implicit_step.h"

namespace geo {

// The stiffness of points of parts at work, at u_, after evaluate(u_).
void ImplicitStep::linearise() {
  std::vector<StiffnessConstants> constants;
  for (const Material& m : s_.materials_.all())
    constants.push_back(stiffness_constants(m)), constants.back().viscous = float(m.viscosity / dt_);
  const auto blocks = parts_.blocks();
  parallel_for(blocks.size(), 1, [&](std::size_t begin, std::size_t end) {
    PointMatrices<float> relaxed;
    StiffnessModes aside;
    for (std::size_t k = begin; k < end; ++k) {
      const std::size_t b = blocks[k];
      if (!relaxed_.empty()) {
        relaxed.resize(s_.points_.blocks[b].points.size());
        for (int c = 0; c < 3; ++c)
          std::copy(relaxed_[b].column[c].begin(), relaxed_[b].column[c].end(), relaxed.column[c].begin());
      }
      modes_[b].resize(weight_[b].size());
      for (const MaterialRange& run : s_.points_.blocks[b].material_ranges) {
        const PointMatrices<float>* const own =
            relaxed_.empty() || !(s_.materials_[run.material].yield > 0) ? nullptr : &relaxed;
        StiffnessModes& to = run.uniform ? modes_[b] : aside;
        to.resize(weight_[b].size());
        stiffness_modes(constants[run.material], {run.begin, run.end}, gradient_[b], own, weight_[b], to);
        for (std::size_t i = run.begin; i < run.end && !run.uniform; ++i)
          if (s_.points_.blocks[b].belongs_to(run, i)) modes_[b].copy_point(aside, i);
      }
    }
  });
}

// What nodes have besides, at u_, and both levels of the preconditioner.
void ImplicitStep::precondition() {
  parts_.each_node([&](std::size_t i) {
    local_[i] = s_.mass_[i] / (dt_ * dt_) * Mat3::Identity();
    if (env_.ground) {
      const Mat3 nn = env_.ground_normal * env_.ground_normal.transpose();
      if (depth(env_, i, s_.position_[i] + u_[i]) > 0) local_[i] += s_.mass_[i] * env_.ground_stiffness * nn;
      if (drag_[i] > 0) local_[i] += drag_[i] * (Mat3::Identity() - nn);
    }
  });
  if (coarse_ && env_.contact.empty()) return;  // not much has turned since
  std::vector<Mat3> blocks = local_;
  contact_.add_diagonal_blocks(blocks);
  const auto make_coarse = [&] {
    if (coarse_) return;
    std::vector<Vec3> at(n_);
    for (std::size_t i = 0; i < n_; ++i) at[i] = s_.position_[i] + u_[i];
    coarse_.emplace(s_.groups_, at, env_.fixed);
    coarse_->factor(s_.points_, modes_, weight_, moduli_, s_.point_stride(), blocks);
  };
  if (s_.penalty_) {
    make_coarse();  // which knows nothing of it
    std::vector<double> penalty(n_, 0);
    s_.penalty_->add_diagonal(s_.rows_, penalty);
    for (std::size_t i = 0; i < n_; ++i) blocks[i] += penalty[i] * Mat3::Identity();
  }
  parallel_invoke(make_coarse, [&] {
    if (!patches_) {
      patches_.emplace(s_.patches_, s_.materials_, moduli_, modes_, blocks, env_.fixed, s_.inverses_);
      return;
    }
    std::vector<std::uint32_t> changed;
    for (std::size_t i = 0; i < n_; ++i)
      if (blocks[i] != blocks_[i])
        for (const auto& place : s_.patches_.patches_of(i)) changed.push_back(place.patch);
    std::sort(changed.begin(), changed.end());
    changed.erase(std::unique(changed.begin(), changed.end()), changed.end());
    patches_->renew(changed, blocks, env_.fixed);
  });
  blocks_ = std::move(blocks);
}

// Adds nothing: writes what blocks with points of parts at work have for their nodes.
void ImplicitStep::elastic_product(const std::vector<Vec3>& p) {
  const MaterialPoints& points = s_.points_;
  product_.resize(4 * points.scatter_size());
  const auto blocks = parts_.blocks();
  parallel_for(blocks.size(), 1, [&](std::size_t begin, std::size_t end) {
    std::vector<float> values;
    for (std::size_t at = begin; at < end; ++at) {
      const std::size_t b = blocks[at];
      const PointBlock& block = points.blocks[b];
      values.resize(4 * block.nodes.size());
      const Vec3 base = p[block.nodes[0]];
      for (std::size_t k = 0; k < block.nodes.size(); ++k) {
        const Vec3 from = p[block.nodes[k]] - base;
        for (std::size_t c = 0; c < 3; ++c) values[4 * k + c] = float(from[static_cast<Eigen::Index>(c)]);
      }
      float* const out = &product_[4 * points.scatter_offset(b)];
      std::fill(out, out + 4 * block.nodes.size(), 0.0f);
      multiply_stiffness(block, modes_[b], values.data(), out);
    }
  });
}

// out = K p, and for each part at work p · K p.
void ImplicitStep::multiply(const std::vector<Vec3>& p, std::vector<Vec3>& out, std::vector<double>& curvature) {
  elastic_product(p);
  contact_.multiply_hessian(p);
  const auto sum = [&](std::size_t i) -> Vec3 {
    return elastic_at(i) + local_[i] * p[i] + contact_.hessian_product_at(i);
  };
  if (s_.penalty_) {
    parts_.each_node([&](std::size_t i) { out[i] = sum(i); });
    s_.penalty_->add(s_.rows_, p, &out);
  }
  parts_.sums(curvature, 0.0, [&](std::size_t i) {
    if (is_fixed(env_, i))
      out[i].setZero();
    else if (!s_.penalty_)
      out[i] = sum(i);
    return p[i].dot(out[i]);
  });
}

// For each part at work, until what the preconditioner would still add is less than half the
// accuracy, after one iteration at least, or, where Newton will go on anyhow, until less than a
// quarter (√0.05) is left in the norm that counts, whose square is r · z. Of a step's first
// direction no more than 0.55 (√0.3) of that may be left, however little is to add, or what comes
// to rest would never quite do so. `left`: that addition, over the nodes' spacing.
int ImplicitStep::solve(const std::vector<Vec3>& force, bool first, std::vector<Vec3>& x,
                        const std::vector<double>& moved, std::vector<double>& left) {
  const std::vector<char> all = parts_.chosen();
  std::vector<char> working = all;
  std::vector<Vec3> r(n_), z(n_), p(n_, Vec3::Zero()), hp(n_);
  std::vector<double> rz, next, curvature, along(parts_.count()), begun, far(parts_.count(), 0);
  const auto improve = [&](std::vector<double>& product) {
    parallel_invoke([&] { coarse_->solve(r, parts_); }, [&] { patches_->solve(r, parts_.patches()); });
    parts_.sums_and_most(product, left, [&](std::size_t i) {
      z[i] = patches_->at(i) + coarse_->at(i);
      return std::pair(r[i].dot(z[i]), squared_in_spacings(z, i));
    });
    take_roots(left);
  };
  parts_.each_node([&](std::size_t i) { x[i].setZero(), r[i] = force[i]; });
  improve(rz);
  parts_.each_node([&](std::size_t i) { p[i] = z[i]; });
  begun = rz;
  int k = 0;
  for (; k < 500; ++k) {
    for (std::size_t q = 0; q < working.size(); ++q) {
      const bool far_from_done = far[q] * (far[q] + moved[q]) > trusted(), reduced = rz[q] <= 0.05 * begun[q],
                 little = k > 0 && left[q] < 0.5 * accuracy_;
      if (working[q] && (!(rz[q] > 0) || (little && (!first || rz[q] <= 0.3 * begun[q])) || (reduced && far_from_done)))
        working[q] = 0;
    }
    if (std::find(working.begin(), working.end(), 1) == working.end()) break;
    parts_.choose(working);
    multiply(p, hp, curvature);
    for (std::size_t q = 0; q < working.size(); ++q) {
      if (working[q] && !(curvature[q] > 0)) working[q] = 0;
      along[q] = working[q] ? rz[q] / curvature[q] : 0;
    }
    parts_.choose(working);
    parts_.most(far, [&](std::size_t i) {
      const double alpha = along[parts_.of(i)];
      x[i] += alpha * p[i], r[i] -= alpha * hp[i];
      return squared_in_spacings(x, i);
    });
    take_roots(far);
    improve(next);
    parts_.each_node([&](std::size_t i) { p[i] = z[i] + next[parts_.of(i)] / rz[parts_.of(i)] * p[i]; });
    for (std::size_t q = 0; q < working.size(); ++q)
      if (working[q]) rz[q] = next[q];
  }
  parts_.choose(all);
  return k;
}

// Of the nodes' spacing, for each part at work.
void ImplicitStep::most(const std::vector<Vec3>& moved, std::vector<double>& most) const {
  parts_.most(most, [&](std::size_t i) { return squared_in_spacings(moved, i); });
  take_roots(most);
}

void ImplicitStep::take_roots(std::vector<double>& squares) const {
  for (std::size_t p = 0; p < squares.size(); ++p)
    if (parts_.chosen()[p]) squares[p] = std::sqrt(squares[p]);
}

std::vector<Vec3> ImplicitStep::product(const std::vector<Vec3>& u, const std::vector<Vec3>& p) {
  std::vector<double> value;
  std::vector<Vec3> out(n_);
  evaluate(u, value, &out);
  linearise();
  elastic_product(p);
  parts_.each_node([&](std::size_t i) { out[i] = elastic_at(i); });
  if (s_.penalty_) s_.penalty_->add(s_.rows_, p, &out);
  return out;
}

}  // namespace geo
