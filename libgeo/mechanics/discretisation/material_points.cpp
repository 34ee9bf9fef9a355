#include "mechanics/discretisation/material_points.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "kerf/error.h"
#include "kerf/parallel.h"
#include "mechanics/discretisation/point_lanes.h"

namespace geo {
namespace {

std::vector<Mat3> matrices(const Columns<double>& columns, std::size_t count) {
  std::vector<Mat3> all(count);
  for (std::size_t i = 0; i < count; ++i)
    for (int c = 0; c < 3; ++c) all[i].col(c) = Eigen::Map<const Vec3>(&columns.column[c][4 * i]);
  return all;
}

// Where four points that stand side by side come from, if they did so there.
std::optional<PointBlock::Source> whole_four(std::span<const PointBlock::Source> sources, std::size_t four) {
  if (4 * four + 4 > sources.size()) return {};
  const PointBlock::Source& from = sources[4 * four];
  for (std::size_t k = 0; k < 4; ++k)
    if (const auto& s = sources[4 * four + k];
        s.row || s.block != from.block || s.point != from.point + k || from.point % 4 != 0)
      return {};
  return from;
}

std::vector<PointBlock::Source> sources_of(std::span<const ShapeRow> rows) {
  std::vector<PointBlock::Source> sources;
  for (const ShapeRow& row : rows) sources.push_back({nullptr, 0, &row});
  return sources;
}

}  // namespace

PointBlock::PointBlock(std::vector<MaterialPoint> all, std::span<const ShapeRow> rows)
    : PointBlock(std::move(all), sources_of(rows)) {}

PointBlock::PointBlock(std::vector<MaterialPoint> all, std::span<const Source> sources) : points(std::move(all)) {
  // The nodes of all rows; then places in each block's list, and in the whole one, for those here.
  std::size_t entries = 0;
  std::map<const PointBlock*, std::vector<std::uint16_t>> place;
  for (const Source& s : sources)
    if (s.row) {
      nodes.insert(nodes.end(), s.row->to.begin(), s.row->to.end()), entries += s.row->to.size();
    } else {
      auto& used = place[s.block];
      used.resize(s.block->nodes.size(), 0);
      for (auto q = s.block->first[s.point]; q < s.block->first[s.point + 1]; ++q) used[s.block->to[q]] = 1;
      entries += s.block->first[s.point + 1] - s.block->first[s.point];
    }
  for (const auto& [block, used] : place)
    for (std::size_t k = 0; k < used.size(); ++k)
      if (used[k]) nodes.push_back(block->nodes[k]);
  std::sort(nodes.begin(), nodes.end());
  nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
  if (nodes.size() > 65536)
    throw InputError("more than 65536 nodes share a block of material points; choose a smaller support");
  const auto find = [&](std::uint32_t node) {
    return static_cast<std::uint16_t>(std::lower_bound(nodes.begin(), nodes.end(), node) - nodes.begin());
  };
  for (auto& [block, to_here] : place)
    for (std::size_t k = 0; k < to_here.size(); ++k) to_here[k] = find(block->nodes[k]);

  first.reserve(points.size() + 1), to.reserve(entries), gradient.reserve(3 * entries);
  first.push_back(0);
  for (const Source& s : sources) {
    if (s.row) {
      for (const auto j : s.row->to) to.push_back(find(j));
      for (const Vec3& g : s.row->gradient) gradient.insert(gradient.end(), g.begin(), g.end());
    } else {
      const auto& to_here = place[s.block];
      const auto begin = s.block->first[s.point], end = s.block->first[s.point + 1];
      for (auto q = begin; q < end; ++q) to.push_back(to_here[s.block->to[q]]);
      gradient.insert(gradient.end(), s.block->gradient.data() + 3 * begin, s.block->gradient.data() + 3 * end);
    }
    first.push_back(static_cast<std::uint32_t>(to.size()));
  }
  rounded.assign(gradient.begin(), gradient.end());
  rounded.push_back(0);  // entries are read by fours
  unit.assign((points.size() + 7) / 8 * 8, 0), four_first.assign(1, 0);
  for (std::size_t four = 0; 4 * four < unit.size(); ++four) {
    if (const auto from = whole_four(sources, four))
      copy_packed(four, *from, place[from->block]);
    else
      pack(four);
    four_first.push_back(static_cast<std::uint32_t>(four_to.size()));
  }
  for (const MaterialPoint& p : points) box.add(p.position);
}

// What rounding leaves of one entry is the next one's, so that a field that is constant has no gradient.
void PointBlock::pack(std::size_t four) {
  constexpr double full = 32766;
  struct Row {
    std::uint32_t at = 0, end = 0;
    double scale = 0;
    Vec3 sum = Vec3::Zero(), taken = Vec3::Zero();
  };
  std::array<Row, 4> rows;
  for (std::size_t k = 0; k < 4 && 4 * four + k < points.size(); ++k) {
    const std::size_t point = 4 * four + k;
    double most = 0;
    for (std::size_t q = 3 * first[point]; q < 3 * first[point + 1]; ++q) most = std::max(most, std::abs(gradient[q]));
    if (most > 0) rows[k] = {first[point], first[point + 1], full / most}, unit[point] = float(most / full);
  }
  constexpr std::uint32_t none = 1 << 16;
  const auto next = [&](const Row& r) { return r.at < r.end ? std::uint32_t(to[r.at]) : none; };
  for (std::uint32_t node; (node = std::min({next(rows[0]), next(rows[1]), next(rows[2]), next(rows[3])})) != none;) {
    const std::size_t begin = 12 * (four_to.size() / 2 * 2) + 4 * (four_to.size() % 2);
    four_to.push_back(static_cast<std::uint16_t>(node)), packed.resize(12 * ((four_to.size() + 1) / 2 * 2), 0);
    for (std::size_t k = 0; k < 4; ++k) {
      Row& r = rows[k];
      if (next(r) != node) continue;
      for (std::size_t c = 0; c < 3; ++c) {
        const auto i = static_cast<Eigen::Index>(c);
        r.sum[i] += r.scale * gradient[3 * r.at + c];
        const double whole = std::nearbyint(r.sum[i]) - r.taken[i];
        packed[begin + 8 * c + k] = static_cast<std::int16_t>(whole), r.taken[i] += whole;
      }
      ++r.at;
    }
  }
  if (four_to.size() % 2) four_to.push_back(four_to.back());
}

void PointBlock::copy_packed(std::size_t four, const Source& from, const std::vector<std::uint16_t>& to_here) {
  const PointBlock& b = *from.block;
  const auto begin = b.four_first[from.point / 4], end = b.four_first[from.point / 4 + 1];
  for (auto k = begin; k < end; ++k) four_to.push_back(to_here[b.four_to[k]]);
  packed.insert(packed.end(), b.packed.begin() + 12 * std::ptrdiff_t(begin),
                b.packed.begin() + 12 * std::ptrdiff_t(end));
  std::copy_n(&b.unit[from.point], 4, &unit[4 * four]);
}

ShapeRow PointBlock::row(std::size_t point) const {
  ShapeRow row;
  for (std::size_t q = first[point]; q < first[point + 1]; ++q) {
    row.to.push_back(nodes[to[q]]);
    row.gradient.push_back(Eigen::Map<const Vec3>(&gradient[3 * q]));
  }
  return row;
}

void PointBlock::set_materials(const Materials& materials) {
  const auto padded = static_cast<std::uint32_t>(unit.size());
  runs.assign(1, {0, padded});
  if (materials.count() == 1) return;
  runs.clear();
  std::vector<std::uint16_t> here;
  for (std::uint32_t begin = 0; begin < padded; begin += 8) {
    here.clear();
    for (std::size_t i = begin; i < std::min<std::size_t>(begin + 8, points.size()); ++i) {
      const bool sees = first[i] < first[i + 1];
      points[i].material = sees ? materials.number(nodes[to[first[i]]]) : std::uint16_t(0);
      if (sees) here.push_back(points[i].material);
    }
    std::sort(here.begin(), here.end());
    here.erase(std::unique(here.begin(), here.end()), here.end());
    const bool goes_on = !runs.empty() && runs.back().alone;
    if (here.empty()) here.push_back(goes_on ? runs.back().material : std::uint16_t(0));
    if (here.size() == 1 && goes_on && runs.back().material == here[0])
      runs.back().end = begin + 8;
    else
      for (const auto material : here) runs.push_back({begin, begin + 8, material, here.size() == 1});
  }
}

bool operator==(const PointBlock& a, const PointBlock& b) {
  const auto same = [](const MaterialPoint& p, const MaterialPoint& q) {
    return p.position == q.position && p.volume == q.volume && p.rung == q.rung && p.growth == q.growth &&
           p.blinded == q.blinded && p.material == q.material && p.reach == q.reach && p.measured == q.measured;
  };
  return a.nodes == b.nodes && a.first == b.first && a.to == b.to && a.gradient == b.gradient &&
         a.four_first == b.four_first && a.four_to == b.four_to && a.packed == b.packed && a.unit == b.unit &&
         std::equal(a.points.begin(), a.points.end(), b.points.begin(), b.points.end(), same);
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
    for (std::size_t k = 0; k < blocks[b].nodes.size(); ++k)
      incoming_[at[blocks[b].nodes[k]]++] = static_cast<std::uint32_t>(part_[b] + k);
}

void MaterialPoints::set_materials(const Materials& materials) {
  parallel_for(blocks.size(), 16, [&](std::size_t begin, std::size_t end) {
    for (std::size_t b = begin; b < end; ++b) blocks[b].set_materials(materials);
  });
}

void MaterialPoints::values(std::size_t block, const std::vector<Vec3>& u, std::vector<double>& values) const {
  const auto& nodes = blocks[block].nodes;
  if (values.size() < 4 * nodes.size()) values.resize(4 * nodes.size());
  for (std::size_t k = 0; k < nodes.size(); ++k)
    Eigen::Map<Eigen::Vector4d>{&values[4 * k]} << u[nodes[k]] - u[nodes[0]], 0;
}

std::vector<Mat3> MaterialPoints::gradients(std::size_t block, const std::vector<Vec3>& u) const {
  const PointBlock& b = blocks[block];
  Columns<double> columns;
  std::vector<double> at;
  values(block, u, at);
  point_gradients(b, at.data(), columns);
  return matrices(columns, b.points.size());
}

}  // namespace geo
