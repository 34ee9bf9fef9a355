#include "mechanics/terms/contact_rows.h"

#include <algorithm>
#include <cmath>

#include "kerf/parallel.h"
#include "mechanics/terms/row_sums.h"

namespace geo {
namespace {

constexpr std::size_t few = 64;  // rows, or nodes, that a thread is worth

}  // namespace

ContactRows::ContactRows(std::span<Potential* const> potentials, const std::vector<Vec3>& u) : begun_(u) {
  for (Potential* p : potentials)
    for (std::size_t r = 0; r < p->size(); ++r)
      if (const auto entries = p->row(r); !entries.empty()) {
        if (!p->within_parts()) joining_.push_back(static_cast<std::uint32_t>(rows_.size()));
        rows_.push_back({p, static_cast<std::uint32_t>(r), entries[0].node, p->reach(r)}), entries_.push_back(entries);
      }
  way_.assign(rows_.size(), Vec3::Zero()), force_ = way_, curvature_.assign(rows_.size(), Curvature::Zero());
  listed_.assign(rows_.size(), 0), idle_ = listed_, pull_.assign(rows_.size(), Eigen::Vector4f::Zero());
}

std::vector<std::pair<std::uint32_t, std::uint32_t>> ContactRows::couples(std::span<const std::uint32_t> part) const {
  // Those of runs of rows one after another.
  constexpr std::size_t rows_a_run = 512;
  std::vector<std::vector<std::pair<std::uint32_t, std::uint32_t>>> of_run((joining_.size() + rows_a_run - 1) /
                                                                           rows_a_run);
  parallel_for(of_run.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k)
      for (std::size_t j = k * rows_a_run; j < std::min(joining_.size(), (k + 1) * rows_a_run); ++j)
        for (const auto& e : entries_[joining_[j]])
          if (const std::pair pair(part[entries_[joining_[j]][0].node], part[e.node]);
              pair.first != pair.second && (of_run[k].empty() || pair != of_run[k].back()))
            of_run[k].push_back(pair);
  });
  std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs;
  for (const auto& some : of_run) pairs.insert(pairs.end(), some.begin(), some.end());
  return pairs;
}

std::vector<std::uint32_t> ContactRows::rows_at_work(std::span<const std::uint32_t> part,
                                                     const std::vector<char>& chosen) const {
  std::vector<std::uint32_t> rows;
  for (std::uint32_t r = 0; r < rows_.size(); ++r)
    if (!idle_[r] && chosen[part[rows_[r].node]]) rows.push_back(r);
  return rows;
}

void ContactRows::add_energy(const std::vector<Vec3>& u, std::span<const std::uint32_t> part,
                             const std::vector<char>& chosen, std::vector<double>& sum) {
  if (empty()) return;
  std::vector<double> moved(chosen.size(), 0);
  for (std::size_t i = 0; i < u.size(); ++i)
    if (double& most = moved[part[i]]; chosen[part[i]]) most = std::max(most, (u[i] - begun_[i]).squaredNorm());
  for (double& most : moved) most = std::sqrt(most);
  for (std::size_t r = 0; r < rows_.size(); ++r)
    if (const auto p = part[rows_[r].node]; chosen[p]) idle_[r] = !listed_[r] && moved[p] < rows_[r].reach;
  const auto rows = rows_at_work(part, chosen);
  std::vector<double> energy(rows.size());
  each_row_sum(
      rows.size(), u, [&](std::size_t k) { return entries_[rows[k]]; },
      [&](std::size_t k, const Vec3& way) {
        const auto r = rows[k];
        way_[r] = way, energy[k] = rows_[r].of->energy(rows_[r].number, way);
      });
  for (std::size_t k = 0; k < rows.size(); ++k) sum[part[rows_[rows[k]].node]] += energy[k];
}

void ContactRows::push(std::span<const std::uint32_t> part, const std::vector<char>& chosen) {
  const auto rows = rows_at_work(part, chosen);
  parallel_for(rows.size(), few, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      const auto r = rows[k];
      const auto push = rows_[r].of->push(rows_[r].number, way_[r]);
      force_[r] = push.force, curvature_[r].topRows<3>() = push.curvature.cast<float>();
    }
  });
  list();
}

// Rows that do something for the first time join the second list; where that is no small one, there is one of all.
void ContactRows::list() {
  constexpr std::size_t small = 8;
  std::vector<std::uint32_t> rows;
  bool came = false;
  for (std::uint32_t r = 0; r < rows_.size(); ++r) {
    if (listed_[r] == 1) continue;
    if (listed_[r] == 0 && force_[r].isZero(0) && curvature_[r].isZero(0)) continue;
    came |= listed_[r] == 0, listed_[r] = 2;
    rows.push_back(r);
  }
  if (!came) return;
  if (rows.size() * small <= lists_[0].size()) {
    lists_[1] = RowLists(rows, entries_, begun_.size());
    return;
  }
  rows.clear();
  for (std::uint32_t r = 0; r < rows_.size(); ++r)
    if (listed_[r]) listed_[r] = 1, rows.push_back(r);
  lists_[0] = RowLists(rows, entries_, begun_.size()), lists_[1] = {};
}

Vec3 ContactRows::force_at(std::size_t node) const {
  Vec3 sum = Vec3::Zero();
  for (const auto& lists : lists_) {
    const auto shares = lists.of_node(node);
    for (std::size_t k = 0; k < shares.size(); ++k) sum += lists.weights_of_node(node)[k] * force_[shares[k].of];
  }
  return sum;
}

void ContactRows::multiply(const std::vector<Vec3>& p) {
  if (lists_[0].size() == 0) return;
  single_.resize(begun_.size());
  parallel_for(begun_.size(), 8192, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) single_[i] << p[i].cast<float>(), 0;
  });
  for (const auto& lists : lists_)
    parallel_for(lists.size(), few, [&](std::size_t begin, std::size_t end) {
      for (std::size_t k = begin; k < end; ++k) {
        const auto shares = lists.of_row(k);
        Eigen::Vector4f some[4] = {Eigen::Vector4f::Zero(), Eigen::Vector4f::Zero(), Eigen::Vector4f::Zero(),
                                   Eigen::Vector4f::Zero()};
        std::size_t at = 0;
        for (; at + 4 <= shares.size(); at += 4)
          for (std::size_t c = 0; c < 4; ++c) some[c] += shares[at + c].weight * single_[shares[at + c].of];
        for (; at < shares.size(); ++at) some[0] += shares[at].weight * single_[shares[at].of];
        const Eigen::Vector4f way = (some[0] + some[1]) + (some[2] + some[3]);
        const Curvature& curvature = curvature_[lists.row(k)];
        pull_[lists.row(k)] = way[0] * curvature.col(0) + way[1] * curvature.col(1) + way[2] * curvature.col(2);
      }
    });
}

void ContactRows::add_blocks(std::vector<Mat3>& out) const {
  constexpr float together = 0.2f;  // of a row's weights, in what solves for a node with its neighbours
  parallel_for(out.size(), few, [&](std::size_t begin, std::size_t end) {
    for (std::size_t n = begin; n < end; ++n) {
      Curvature sum = Curvature::Zero();
      for (const auto& lists : lists_)
        for (const auto& share : lists.of_node(n)) {
          const float weight = std::abs(share.weight);
          sum += weight * std::max(weight, together) * curvature_[share.of];
        }
      out[n] += sum.topRows<3>().cast<double>();
    }
  });
}

}  // namespace geo
