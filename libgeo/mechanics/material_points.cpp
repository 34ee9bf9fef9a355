#include "mechanics/material_points.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/parallel.h"
#include "mechanics/point_lanes.h"

namespace geo {
namespace {

// A nodal field at a block's nodes, four numbers each, from the first node's value on: differences lose nothing where a
// body is far from where it was.
std::vector<double> local_values(const PointBlock& block, const std::vector<Vec3>& u) {
  std::vector<double> values(4 * block.nodes.size(), 0);
  for (std::size_t k = 0; k < block.nodes.size(); ++k) Eigen::Map<Vec3>{&values[4 * k]} = u[block.nodes[k]] - u[block.nodes[0]];
  return values;
}

std::vector<Mat3> matrices(const Columns<double>& columns, std::size_t count) {
  std::vector<Mat3> all(count);
  for (std::size_t i = 0; i < count; ++i)
    for (int c = 0; c < 3; ++c) all[i].col(c) = Eigen::Map<const Vec3>(&columns.column[c][4 * i]);
  return all;
}

}  // namespace

PointBlock::PointBlock(std::vector<MaterialPoint> all, std::span<const ShapeRow> rows) : points(std::move(all)) {
  for (const ShapeRow& row : rows) nodes.insert(nodes.end(), row.to.begin(), row.to.end());
  std::sort(nodes.begin(), nodes.end());
  nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
  if (nodes.size() > 65536) throw InputError("more than 65536 nodes share a block of material points; choose a smaller support");
  first.push_back(0);
  for (const ShapeRow& row : rows) {
    for (std::size_t q = 0; q < row.to.size(); ++q) {
      to.push_back(static_cast<std::uint16_t>(std::lower_bound(nodes.begin(), nodes.end(), row.to[q]) - nodes.begin()));
      gradient.insert(gradient.end(), row.gradient[q].begin(), row.gradient[q].end());
    }
    first.push_back(static_cast<std::uint32_t>(to.size()));
  }
  rounded.assign(gradient.begin(), gradient.end());
  rounded.push_back(0);  // entries are read by fours
  pack();
  for (const MaterialPoint& p : points) box.add(p.position);
}

// What rounding leaves of one entry is the next one's, so that a field that is constant has no gradient.
void PointBlock::pack() {
  constexpr double full = 32766;
  packed.assign(4 * (to.size() + 1), 0), unit.assign((points.size() + 7) / 8 * 8, 0);  // entries are read by twos
  for (std::size_t i = 0; i < points.size(); ++i) {
    double most = 0;
    for (std::size_t k = 3 * first[i]; k < 3 * first[i + 1]; ++k) most = std::max(most, std::abs(gradient[k]));
    for (std::size_t q = first[i]; q < first[i + 1]; ++q) packed[4 * q + 3] = static_cast<std::int16_t>(to[q]);
    if (!(most > 0)) continue;
    unit[i] = float(most / full);
    Vec3 sum = Vec3::Zero(), taken = Vec3::Zero();
    for (std::size_t q = first[i]; q < first[i + 1]; ++q)
      for (std::size_t c = 0; c < 3; ++c) {
        const auto k = static_cast<Eigen::Index>(c);
        sum[k] += full / most * gradient[3 * q + c];
        const double whole = std::nearbyint(sum[k]) - taken[k];
        packed[4 * q + c] = static_cast<std::int16_t>(whole), taken[k] += whole;
      }
  }
}

ShapeRow PointBlock::row(std::size_t point) const {
  ShapeRow row;
  for (std::size_t q = first[point]; q < first[point + 1]; ++q) {
    row.to.push_back(nodes[to[q]]);
    row.gradient.push_back(Eigen::Map<const Vec3>(&gradient[3 * q]));
  }
  return row;
}

bool operator==(const PointBlock& a, const PointBlock& b) {
  const auto same = [](const MaterialPoint& p, const MaterialPoint& q) {
    return p.position == q.position && p.volume == q.volume && p.rung == q.rung && p.growth == q.growth && p.blinded == q.blinded && p.reach == q.reach;
  };
  return a.nodes == b.nodes && a.first == b.first && a.to == b.to && a.gradient == b.gradient && std::equal(a.points.begin(), a.points.end(), b.points.begin(), b.points.end(), same);
}

void MaterialPoints::connect(std::size_t nodes) {
  first_.assign(1, 0), part_.assign(1, 0), begin_.assign(nodes + 1, 0);
  for (const PointBlock& b : blocks) {
    first_.push_back(first_.back() + b.points.size()), part_.push_back(part_.back() + b.nodes.size());
    for (const auto j : b.nodes) ++begin_[j + 1];
  }
  for (std::size_t j = 0; j < nodes; ++j) begin_[j + 1] += begin_[j];
  incoming_.resize(part_.back());
  std::vector<std::uint32_t> at(begin_.begin(), begin_.end() - 1);
  for (std::size_t b = 0; b < blocks.size(); ++b)
    for (std::size_t k = 0; k < blocks[b].nodes.size(); ++k) incoming_[at[blocks[b].nodes[k]]++] = static_cast<std::uint32_t>(part_[b] + k);
}

std::vector<Mat3> MaterialPoints::gradients(std::size_t block, const std::vector<Vec3>& u) const {
  const PointBlock& b = blocks[block];
  Columns<double> columns;
  point_gradients(b, local_values(b, u).data(), columns);
  return matrices(columns, b.points.size());
}

void MaterialPoints::transform(const std::vector<Vec3>& u, const std::function<void(std::size_t, std::span<Mat3>)>& work, std::vector<Vec3>* out) const {
  std::vector<double> parts(out ? 4 * this->parts() : 0);
  parallel_for(blocks.size(), 1, [&](std::size_t begin, std::size_t end) {
    Columns<double> columns;
    for (std::size_t k = begin; k < end; ++k) {
      const PointBlock& b = blocks[k];
      point_gradients(b, local_values(b, u).data(), columns);
      std::vector<Mat3> all = matrices(columns, b.points.size());
      work(k, all);
      if (!out) continue;
      for (std::size_t i = 0; i < all.size(); ++i)
        for (int c = 0; c < 3; ++c) Eigen::Map<Vec3>(&columns.column[c][4 * i]) = all[i].col(c);
      point_divergence(b, columns, &parts[4 * part_[k]]);
    }
  });
  if (!out) return;
  out->resize(begin_.size() - 1);
  gather(parts.data(), 4, [&](std::size_t j, const double* sum) { (*out)[j] = {sum[0], sum[1], sum[2]}; });
}

}  // namespace geo
