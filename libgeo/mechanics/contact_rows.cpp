#include "mechanics/contact_rows.h"

#include <algorithm>
#include <cmath>

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
  active_.clear();
  std::fill(first_share_.begin(), first_share_.end(), 0);
  std::uint32_t row = 0;
  for (const Potential* p : potentials_)
    p->each_row([&](std::span<const NodeWeight>, const Mat3& curvature) {
      curvature_[row] = curvature;
      if (!curvature.isZero(0)) {
        active_.push_back(row);
        for (const auto& e : entries_[row]) ++first_share_[e.node + 1];
      }
      ++row;
    });
  for (std::size_t n = 0; n + 1 < first_share_.size(); ++n) first_share_[n + 1] += first_share_[n];
  shares_.resize(first_share_.back());
  std::vector<std::size_t> next(first_share_.begin(), first_share_.end() - 1);
  for (std::uint32_t a = 0; a < active_.size(); ++a)
    for (const auto& e : entries_[active_[a]]) shares_[next[e.node]++] = {a, static_cast<float>(e.weight)};
}

void ContactRows::add_product(const std::vector<Vec3>& p, std::vector<Vec3>& out) const {
  if (active_.empty()) return;
  std::vector<Vec3> pull(active_.size());
  parallel_for(active_.size(), 64, [&](std::size_t begin, std::size_t end) {
    for (std::size_t a = begin; a < end; ++a) pull[a] = curvature_[active_[a]] * weighed(entries_[active_[a]], p);
  });
  parallel_for(p.size(), 256, [&](std::size_t begin, std::size_t end) {
    for (std::size_t n = begin; n < end; ++n) {
      Vec3 sum = Vec3::Zero();
      for (auto i = first_share_[n]; i < first_share_[n + 1]; ++i) sum += shares_[i].weight * pull[shares_[i].active];
      out[n] += sum;
    }
  });
}

void ContactRows::add_blocks(std::vector<Mat3>& out) const {
  constexpr double together = 0.2;  // of a row's weights, in what solves for a node with its neighbours
  for (const auto r : active_)
    for (const auto& e : entries_[r]) out[e.node] += std::abs(e.weight) * std::max(std::abs(e.weight), together) * curvature_[r];
}

}  // namespace geo
