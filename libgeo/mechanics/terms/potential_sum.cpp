// With w_k the stencil and H_k the Hessian of term k: at node i the force is −Σ_k w_ki ∂E_k/∂d, the
// product Σ_k w_ki H_k (Σ_j w_kj p_j). Only terms that have been active enter; the others have zero
// derivatives.
#include "mechanics/terms/potential_sum.h"

#include <algorithm>
#include <cmath>

#include "kerf/parallel.h"
#include "mechanics/terms/weighted_sums.h"

namespace geo {
namespace {

constexpr std::size_t terms_per_task = 64;  // smallest task worth a thread; of nodes, too

}  // namespace

PotentialSum::PotentialSum(std::span<Potential* const> potentials, const std::vector<Vec3>& u,
                           std::span<const std::uint8_t> asleep)
    : start_(u), asleep_(asleep) {
  for (Potential* p : potentials)
    for (std::size_t k = 0; k < p->size(); ++k) {
      const auto stencil = p->stencil(k);
      const auto awake =
          std::find_if(stencil.begin(), stencil.end(), [&](const NodeWeight& e) { return !is_asleep(e.node); });
      if (awake != stencil.end()) {
        if (!p->within_components()) coupling_.push_back(static_cast<std::uint32_t>(terms_.size()));
        terms_.push_back({.potential = p,
                          .index = static_cast<std::uint32_t>(k),
                          .first_node = awake->node,
                          .activation_distance = p->activation_distance(k)});
        stencils_.push_back(stencil);
      }
    }
  displacement_.assign(terms_.size(), Vec3::Zero());
  force_ = displacement_;
  hessian_.assign(terms_.size(), Hessian::Zero());
  matrix_of_.assign(terms_.size(), 0);
  idle_ = matrix_of_;
  product_.assign(terms_.size(), Eigen::Vector4f::Zero());
}

std::vector<std::pair<std::uint32_t, std::uint32_t>> PotentialSum::coupled_components(
    std::span<const std::uint32_t> component) const {
  // Chunks of terms collect their pairs in parallel.
  constexpr std::size_t chunk_size = 512;
  std::vector<std::vector<std::pair<std::uint32_t, std::uint32_t>>> of_chunk((coupling_.size() + chunk_size - 1) /
                                                                             chunk_size);
  parallel_for(of_chunk.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t c = begin; c < end; ++c)
      for (std::size_t j = c * chunk_size; j < std::min(coupling_.size(), (c + 1) * chunk_size); ++j) {
        const Stencil stencil = stencils_[coupling_[j]];
        const auto first = component[terms_[coupling_[j]].first_node];
        for (const auto& e : stencil)
          if (const std::pair pair(first, component[e.node]);
              !is_asleep(e.node) && pair.first != pair.second && (of_chunk[c].empty() || pair != of_chunk[c].back()))
            of_chunk[c].push_back(pair);
      }
  });
  std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs;
  for (const auto& some : of_chunk) pairs.insert(pairs.end(), some.begin(), some.end());
  return pairs;
}

std::vector<std::uint32_t> PotentialSum::terms_to_evaluate(std::span<const std::uint32_t> island,
                                                           const std::vector<char>& selected) const {
  std::vector<std::uint32_t> terms;
  for (std::uint32_t t = 0; t < terms_.size(); ++t)
    if (!idle_[t] && selected[island[terms_[t].first_node]]) terms.push_back(t);
  return terms;
}

void PotentialSum::add_energy(const std::vector<Vec3>& u, std::span<const std::uint32_t> island,
                              const std::vector<char>& selected, std::vector<double>& sum) {
  if (empty()) return;
  // The farthest that a node of each island has moved decides which terms can be active.
  std::vector<double> farthest(selected.size(), 0);
  for (std::size_t i = 0; i < u.size(); ++i)
    if (double& f = farthest[island[i]]; selected[island[i]]) f = std::max(f, (u[i] - start_[i]).squaredNorm());
  for (double& f : farthest) f = std::sqrt(f);
  for (std::size_t t = 0; t < terms_.size(); ++t)
    if (const auto i = island[terms_[t].first_node]; selected[i])
      idle_[t] = !matrix_of_[t] && farthest[i] < terms_[t].activation_distance;
  const auto terms = terms_to_evaluate(island, selected);
  std::vector<double> energy(terms.size());
  for_each_weighted_sum(
      terms.size(), u, [&](std::size_t k) { return stencils_[terms[k]]; },
      [&](std::size_t k, const Vec3& d) {
        const auto t = terms[k];
        displacement_[t] = d;
        energy[k] = terms_[t].potential->energy(terms_[t].index, d);
      });
  for (std::size_t k = 0; k < terms.size(); ++k) sum[island[terms_[terms[k]].first_node]] += energy[k];
}

void PotentialSum::update_derivatives(std::span<const std::uint32_t> island, const std::vector<char>& selected) {
  const auto terms = terms_to_evaluate(island, selected);
  parallel_for(terms.size(), terms_per_task, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      const auto t = terms[k];
      const auto derivatives = terms_[t].potential->derivatives(terms_[t].index, displacement_[t]);
      force_[t] = derivatives.force;
      hessian_[t].topRows<3>() = derivatives.hessian.cast<float>();
    }
  });
  update_matrices();
}

void PotentialSum::begin_iterate(std::span<const std::uint32_t> island, const std::vector<char>& selected,
                                 std::vector<double>& sum) {
  const auto terms = terms_to_evaluate(island, selected);
  std::vector<double> change(terms.size());
  parallel_for(terms.size(), terms_per_task, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k)
      change[k] = terms_[terms[k]].potential->begin_iterate(terms_[terms[k]].index, displacement_[terms[k]]);
  });
  for (std::size_t k = 0; k < terms.size(); ++k) sum[island[terms_[terms[k]].first_node]] += change[k];
}

// Newly active terms join the second matrix. When that is no longer small, the first one is rebuilt
// from all.
void PotentialSum::update_matrices() {
  constexpr std::size_t smallness = 8;  // the second matrix has at most 1/8 of the first one's stencils
  std::vector<std::uint32_t> terms;
  bool grown = false;
  for (std::uint32_t t = 0; t < terms_.size(); ++t) {
    if (matrix_of_[t] == 1) continue;
    if (matrix_of_[t] == 0 && force_[t].isZero(0) && hessian_[t].isZero(0)) continue;
    grown |= matrix_of_[t] == 0;
    matrix_of_[t] = 2;
    terms.push_back(t);
  }
  if (!grown) return;
  if (terms.size() * smallness <= matrices_[0].size()) {
    matrices_[1] = StencilMatrix(terms, stencils_, start_.size());
    return;
  }
  terms.clear();
  for (std::uint32_t t = 0; t < terms_.size(); ++t)
    if (matrix_of_[t]) {
      matrix_of_[t] = 1;
      terms.push_back(t);
    }
  matrices_[0] = StencilMatrix(terms, stencils_, start_.size());
  matrices_[1] = {};
}

void PotentialSum::mark_interrupted(std::vector<std::uint8_t>& interrupted) const {
  for (std::size_t t = 0; t < terms_.size(); ++t)
    if (matrix_of_[t] && !terms_[t].potential->is_smooth())
      for (const NodeWeight& e : stencils_[t]) interrupted[e.node] = 1;
}

std::vector<PotentialSum::LinearisedTerm> PotentialSum::linearised_terms() const {
  std::vector<LinearisedTerm> terms;
  for (std::uint32_t t = 0; t < terms_.size(); ++t)
    if (!idle_[t])
      terms.push_back({.id = t,
                       .potential = terms_[t].potential,
                       .index = terms_[t].index,
                       .stencil = stencils_[t],
                       .force = force_[t],
                       .hessian = hessian_[t].topRows<3>().cast<double>()});
  return terms;
}

Vec3 PotentialSum::force_at(std::size_t node) const {
  Vec3 sum = Vec3::Zero();
  for (const auto& matrix : matrices_) {
    const auto entries = matrix.stencils_of(node);
    if (entries.empty()) continue;
    const double* weights = matrix.weights_of(node);
    Vec3 sums[4] = {Vec3::Zero(), Vec3::Zero(), Vec3::Zero(), Vec3::Zero()};  // which do not wait for each other
    for (std::size_t k = 0; k < entries.size(); ++k) sums[k % 4] += weights[k] * force_[entries[k].index];
    sum += (sums[0] + sums[1]) + (sums[2] + sums[3]);
  }
  return sum;
}

void PotentialSum::multiply_hessian(const std::vector<Vec3>& p) {
  if (matrices_[0].size() == 0) return;
  single_precision_.resize(start_.size());
  parallel_for(start_.size(), 8192, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) single_precision_[i] << p[i].cast<float>(), 0;
  });
  for (const auto& matrix : matrices_)
    parallel_for(matrix.size(), terms_per_task, [&](std::size_t begin, std::size_t end) {
      for (std::size_t k = begin; k < end; ++k) {
        const Hessian& hessian = hessian_[matrix.stencil(k)];
        if (hessian.isZero(0)) {
          product_[matrix.stencil(k)].setZero();
          continue;
        }
        const Eigen::Vector4f d = weighted_sum_of(matrix.nodes_of(k), single_precision_);
        product_[matrix.stencil(k)] = d[0] * hessian.col(0) + d[1] * hessian.col(1) + d[2] * hessian.col(2);
      }
    });
}

void PotentialSum::add_diagonal_blocks(std::vector<Mat3>& blocks) const {
  // Block solves move a node with its neighbours: a stencil with weight w at a node counts as
  // |w| max(|w|, 0.2) instead of w². Measured in docs/decisions/047.
  constexpr float joint_weight = 0.2f;
  parallel_for(blocks.size(), terms_per_task, [&](std::size_t begin, std::size_t end) {
    for (std::size_t n = begin; n < end; ++n) {
      Hessian sum = Hessian::Zero();
      for (const auto& matrix : matrices_)
        for (const auto& entry : matrix.stencils_of(n)) {
          const float weight = std::abs(entry.weight);
          sum += weight * std::max(weight, joint_weight) * hessian_[entry.index];
        }
      blocks[n] += sum.topRows<3>().cast<double>();
    }
  });
}

}  // namespace geo
