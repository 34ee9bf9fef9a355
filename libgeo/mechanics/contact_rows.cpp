#include "mechanics/contact_rows.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/parallel.h"

namespace geo {

ContactRows::ContactRows(std::span<Potential* const> potentials, std::size_t nodes) : potentials_(potentials), first_share_(nodes + 1, 0) {
  for (const Potential* p : potentials_)
    p->each_row([&](std::span<const NodeWeight> entries, const Mat3&) { entries_.push_back(entries); });
  curvature_.assign(entries_.size(), Mat3::Zero());
}

std::vector<std::pair<std::uint32_t, std::uint32_t>> ContactRows::couples(std::span<const std::uint32_t> part) const {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs;
  for (const auto row : entries_)
    for (const auto& e : row)
      if (const std::pair pair(part[row[0].node], part[e.node]); pair.first != pair.second && (pairs.empty() || pair != pairs.back())) pairs.push_back(pair);
  return pairs;
}

void ContactRows::read() {
  active_.clear(), first_own_.assign(1, 0);
  std::uint32_t row = 0;
  for (const Potential* p : potentials_)
    p->each_row([&](std::span<const NodeWeight>, const Mat3& curvature) {
      curvature_[row] = curvature;
      if (!curvature.isZero(0)) active_.push_back(row), first_own_.push_back(first_own_.back() + entries_[row].size());
      ++row;
    });
  // Runs of rows count their nodes each, then know where each node's shares from them go.
  constexpr std::size_t most_runs = 8, rows_a_run = 256;
  const std::size_t nodes = first_share_.size() - 1, runs = std::clamp<std::size_t>(active_.size() / rows_a_run, 1, most_runs);
  const auto begin_of = [&](std::size_t run) { return active_.size() * run / runs; };
  std::vector<std::vector<std::size_t>> next(runs);
  own_.resize(first_own_.back());
  parallel_for(runs, 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t run = begin; run < end; ++run) {
      next[run].assign(nodes, 0);
      for (std::size_t a = begin_of(run); a < begin_of(run + 1); ++a) {
        Share* to = own_.data() + first_own_[a];
        for (const auto& e : entries_[active_[a]]) *to++ = {e.node, static_cast<float>(e.weight)}, ++next[run][e.node];
      }
    }
  });
  std::size_t at = 0;
  for (std::size_t n = 0; n < nodes; ++n) {
    first_share_[n] = at;
    for (auto& of_run : next) at += std::exchange(of_run[n], at);
  }
  first_share_[nodes] = at;
  shares_.resize(at);
  parallel_for(runs, 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t run = begin; run < end; ++run)
      for (std::size_t a = begin_of(run); a < begin_of(run + 1); ++a)
        for (auto k = first_own_[a]; k < first_own_[a + 1]; ++k) shares_[next[run][own_[k].of]++] = {static_cast<std::uint32_t>(a), own_[k].weight};
  });
}

void ContactRows::multiply(const std::vector<Vec3>& p) {
  pull_.resize(active_.size());
  parallel_for(active_.size(), 64, [&](std::size_t begin, std::size_t end) {
    for (std::size_t a = begin; a < end; ++a) {
      Vec3 way = Vec3::Zero();
      for (auto k = first_own_[a]; k < first_own_[a + 1]; ++k) way += double(own_[k].weight) * p[own_[k].of];
      pull_[a] << (curvature_[active_[a]] * way).cast<float>(), 0;
    }
  });
}

void ContactRows::add_blocks(std::vector<Mat3>& out) const {
  constexpr float together = 0.2f;  // of a row's weights, in what solves for a node with its neighbours
  parallel_for(out.size(), 64, [&](std::size_t begin, std::size_t end) {
    for (std::size_t n = begin; n < end; ++n)
      for (auto i = first_share_[n]; i < first_share_[n + 1]; ++i) {
        const float weight = std::abs(shares_[i].weight);
        out[n] += double(weight * std::max(weight, together)) * curvature_[active_[shares_[i].of]];
      }
  });
}

}  // namespace geo
