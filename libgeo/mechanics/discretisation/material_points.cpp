// Shape gradients of a point are stored as 16-bit multiples of its quantum, their largest
// coordinate over 32766. Error diffusion over the nodes keeps their sum at zero.
#include "mechanics/discretisation/material_points.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>

#include "kerf/error.h"
#include "kerf/parallel.h"
#include "mechanics/discretisation/point_lanes.h"

namespace geo {
namespace {

std::vector<Mat3> to_matrices(const PointMatrices<double>& columns, std::size_t count) {
  std::vector<Mat3> all(count);
  for (std::size_t i = 0; i < count; ++i)
    for (int c = 0; c < 3; ++c) all[i].col(c) = Eigen::Map<const Vec3>(&columns.column[c][4 * i]);
  return all;
}

// The source of a quad's first point, if the quad's points come from one quad of another block.
std::optional<PointBlock::Source> source_quad(std::span<const PointBlock::Source> sources, std::size_t quad) {
  if (4 * quad + 4 > sources.size()) return {};
  const PointBlock::Source& from = sources[4 * quad];
  for (std::size_t k = 0; k < 4; ++k)
    if (const auto& s = sources[4 * quad + k];
        s.shape || s.block != from.block || s.point != from.point + k || from.point % 4 != 0)
      return {};
  return from;
}

// Consecutive points of one block are one run.
std::vector<PointBlock::SourceRun> runs_of(std::span<const PointBlock::Source> sources) {
  std::vector<PointBlock::SourceRun> runs;
  for (const PointBlock::Source& s : sources)
    if (!s.shape && !runs.empty() && !runs.back().shape && runs.back().block == s.block &&
        runs.back().point + runs.back().count == s.point)
      ++runs.back().count;
    else
      runs.push_back({s, 1});
  return runs;
}

std::vector<PointBlock::Source> sources_of(std::span<const ShapeGradients> shapes) {
  std::vector<PointBlock::Source> sources;
  for (const ShapeGradients& shape : shapes) sources.push_back({nullptr, 0, &shape});
  return sources;
}

}  // namespace

PointBlock::PointBlock(std::vector<MaterialPoint> all, std::span<const ShapeGradients> shapes)
    : PointBlock(std::move(all), sources_of(shapes)) {}

PointBlock::PointBlock(std::vector<MaterialPoint> all, std::span<const Source> sources) : points(std::move(all)) {
  const std::vector<SourceRun> runs = runs_of(sources);
  thread_local std::vector<std::uint16_t> place;  // per node of the block: its index in `nodes`; as large as all nodes
  LocalNodes local_nodes = list_nodes(runs, place);
  std::size_t entries = 0;
  for (const SourceRun& run : runs) entries += run.entries();
  entry_begin.reserve(points.size() + 1);
  entry_node.reserve(entries);
  entry_bent.reserve(entries);
  entry_gradient.reserve(3 * entries);
  entry_gradient_single.reserve(3 * entries + 1);
  entry_begin.push_back(0);
  for (const SourceRun& run : runs)
    if (run.shape)
      append(*run.shape, place);
    else
      append(run, local_nodes[run.block]);
  node_share.assign(nodes.size(), 0);
  for (std::size_t p = 0; p < points.size(); ++p)
    for (auto e = entry_begin[p]; points[p].quality != MomentQuality::singular && e < entry_begin[p + 1]; ++e)
      node_share[entry_node[e]] += 1.0 / (entry_begin[p + 1] - entry_begin[p]);
  entry_gradient_single.push_back(0);  // vector loads of an entry read four numbers
  quantum.assign((points.size() + 7) / 8 * 8, 0);
  quad_begin.assign(1, 0);
  for (std::size_t quad = 0; 4 * quad < quantum.size(); ++quad) {
    if (const auto from = source_quad(sources, quad))
      copy_quad(quad, *from, local_nodes[from->block]);
    else
      quantise(quad);
    quad_begin.push_back(static_cast<std::uint32_t>(quad_node.size()));
  }
  for (const MaterialPoint& p : points) box.add(p.position);
}

// Lists the nodes of all points, and sets the place of each.
PointBlock::LocalNodes PointBlock::list_nodes(std::span<const SourceRun> runs, std::vector<std::uint16_t>& place) {
  LocalNodes local_nodes;
  std::span<const std::uint32_t> last;
  for (const SourceRun& run : runs)
    if (run.shape) {  // points side by side share most nodes
      const auto& own = run.shape->nodes;
      std::set_difference(own.begin(), own.end(), last.begin(), last.end(), std::back_inserter(nodes));
      last = own;
    } else {
      auto& used = local_nodes[run.block];
      used.resize(run.block->nodes.size(), 0);
      for (auto q = run.begin(); q < run.end(); ++q) used[run.block->entry_node[q]] = 1;
    }
  for (const auto& [block, used] : local_nodes)
    for (std::size_t k = 0; k < used.size(); ++k)
      if (used[k]) nodes.push_back(block->nodes[k]);
  std::sort(nodes.begin(), nodes.end());
  nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
  if (nodes.size() > 65536)
    throw InputError("more than 65536 nodes share a block of material points; choose a smaller support");
  if (!nodes.empty() && place.size() <= nodes.back()) place.resize(nodes.back() + 1);
  for (std::size_t k = 0; k < nodes.size(); ++k) place[nodes[k]] = static_cast<std::uint16_t>(k);
  for (auto& [block, local] : local_nodes)
    for (std::size_t k = 0; k < local.size(); ++k)
      if (local[k]) local[k] = place[block->nodes[k]];
  return local_nodes;
}

void PointBlock::append(const ShapeGradients& shape, std::span<const std::uint16_t> place) {
  for (const auto j : shape.nodes) entry_node.push_back(place[j]);
  for (const Vec3& g : shape.gradient) {
    entry_gradient.insert(entry_gradient.end(), g.begin(), g.end());
    entry_gradient_single.insert(entry_gradient_single.end(), g.begin(), g.end());
  }
  entry_bent.insert(entry_bent.end(), shape.bent.begin(), shape.bent.end());
  entry_bent.resize(entry_node.size(), 0);
  entry_begin.push_back(static_cast<std::uint32_t>(entry_node.size()));
}

void PointBlock::append(const SourceRun& run, std::span<const std::uint16_t> local_node) {
  const PointBlock& from = *run.block;
  const auto begin = run.begin(), end = run.end(), before = static_cast<std::uint32_t>(entry_node.size());
  const auto copy = [&](const auto& of, auto& to, std::size_t width) {
    to.insert(to.end(), of.data() + width * begin, of.data() + width * end);
  };
  copy(from.entry_gradient, entry_gradient, 3);
  copy(from.entry_gradient_single, entry_gradient_single, 3);
  copy(from.entry_bent, entry_bent, 1);
  entry_node.resize(before + end - begin);
  for (auto q = begin; q < end; ++q) entry_node[before + q - begin] = local_node[from.entry_node[q]];
  for (std::size_t i = run.point; i < run.point + run.count; ++i)
    entry_begin.push_back(before + from.entry_begin[i + 1] - begin);
}

// Error diffusion: the rounding error of a node's gradient is carried to the next node, so that the
// integers sum to zero and a constant field has no gradient.
void PointBlock::quantise(std::size_t quad) {
  constexpr double largest = 32766;  // 16 bits, with a margin of one for the carried error
  struct Cursor {
    std::uint32_t entry = 0, end = 0;
    double scale = 0;
    Vec3 sum = Vec3::Zero(), emitted = Vec3::Zero();  // of scaled gradients, of integers so far
  };
  std::array<Cursor, 4> cursors;
  for (std::size_t k = 0; k < 4 && 4 * quad + k < points.size(); ++k) {
    const std::size_t point = 4 * quad + k;
    double size = 0;
    for (std::size_t q = 3 * entry_begin[point]; q < 3 * entry_begin[point + 1]; ++q)
      size = std::max(size, std::abs(entry_gradient[q]));
    if (size > 0) {
      cursors[k] = {.entry = entry_begin[point], .end = entry_begin[point + 1], .scale = largest / size};
      quantum[point] = float(size / largest);
    }
  }
  constexpr std::uint32_t none = 1 << 16;
  const auto next = [&](const Cursor& r) { return r.entry < r.end ? std::uint32_t(entry_node[r.entry]) : none; };
  for (std::uint32_t node;
       (node = std::min({next(cursors[0]), next(cursors[1]), next(cursors[2]), next(cursors[3])})) != none;) {
    const std::size_t begin = 12 * (quad_node.size() / 2 * 2) + 4 * (quad_node.size() % 2);
    quad_node.push_back(static_cast<std::uint16_t>(node));
    quad_gradient.resize(12 * ((quad_node.size() + 1) / 2 * 2), 0);
    for (std::size_t k = 0; k < 4; ++k) {
      Cursor& r = cursors[k];
      if (next(r) != node) continue;
      for (std::size_t c = 0; c < 3; ++c) {
        const auto i = static_cast<Eigen::Index>(c);
        r.sum[i] += r.scale * entry_gradient[3 * r.entry + c];
        const double integer = std::nearbyint(r.sum[i]) - r.emitted[i];
        quad_gradient[begin + 8 * c + k] = static_cast<std::int16_t>(integer);
        r.emitted[i] += integer;
      }
      ++r.entry;
    }
  }
  if (quad_node.size() % 2) quad_node.push_back(quad_node.back());
}

void PointBlock::copy_quad(std::size_t quad, const Source& from, const std::vector<std::uint16_t>& local_node) {
  const PointBlock& b = *from.block;
  const auto begin = b.quad_begin[from.point / 4], end = b.quad_begin[from.point / 4 + 1];
  for (auto k = begin; k < end; ++k) quad_node.push_back(local_node[b.quad_node[k]]);
  quad_gradient.insert(quad_gradient.end(), b.quad_gradient.begin() + 12 * std::ptrdiff_t(begin),
                       b.quad_gradient.begin() + 12 * std::ptrdiff_t(end));
  std::copy_n(&b.quantum[from.point], 4, &quantum[4 * quad]);
}

ShapeGradients PointBlock::shape_gradients(std::size_t point) const {
  ShapeGradients shape;
  for (std::size_t q = entry_begin[point]; q < entry_begin[point + 1]; ++q) {
    shape.nodes.push_back(nodes[entry_node[q]]);
    shape.gradient.push_back(Eigen::Map<const Vec3>(&entry_gradient[3 * q]));
    shape.bent.push_back(entry_bent[q]);
  }
  return shape;
}

void PointBlock::set_materials(const Materials& materials) {
  const auto padded = static_cast<std::uint32_t>(quantum.size());
  material_ranges.assign(1, {.begin = 0, .end = padded});
  if (materials.count() == 1) return;
  material_ranges.clear();
  std::vector<std::uint16_t> present;
  for (std::uint32_t begin = 0; begin < padded; begin += 8) {
    present.clear();
    for (std::size_t i = begin; i < std::min<std::size_t>(begin + 8, points.size()); ++i) {
      const bool has_nodes = entry_begin[i] < entry_begin[i + 1];
      points[i].material = has_nodes ? materials.index(nodes[entry_node[entry_begin[i]]]) : std::uint16_t(0);
      if (has_nodes) present.push_back(points[i].material);
    }
    std::sort(present.begin(), present.end());
    present.erase(std::unique(present.begin(), present.end()), present.end());
    const bool extensible = !material_ranges.empty() && material_ranges.back().uniform;
    if (present.empty()) present.push_back(extensible ? material_ranges.back().material : std::uint16_t(0));
    if (present.size() == 1 && extensible && material_ranges.back().material == present[0])
      material_ranges.back().end = begin + 8;
    else
      for (const auto material : present)
        material_ranges.push_back(
            {.begin = begin, .end = begin + 8, .material = material, .uniform = present.size() == 1});
  }
}

bool operator==(const PointBlock& a, const PointBlock& b) {
  const auto same = [](const MaterialPoint& p, const MaterialPoint& q) {
    return p.position == q.position && p.volume == q.volume && p.quality == q.quality && p.widenings == q.widenings &&
           p.occluded == q.occluded && p.material == q.material && p.influence_radius == q.influence_radius &&
           p.unscaled_volume == q.unscaled_volume;
  };
  return a.nodes == b.nodes && a.entry_begin == b.entry_begin && a.entry_node == b.entry_node &&
         a.entry_gradient == b.entry_gradient && a.entry_bent == b.entry_bent && a.quad_begin == b.quad_begin &&
         a.quad_node == b.quad_node && a.quad_gradient == b.quad_gradient && a.quantum == b.quantum &&
         std::equal(a.points.begin(), a.points.end(), b.points.begin(), b.points.end(), same);
}

std::vector<double> MaterialPoints::shares(std::size_t nodes) const {
  std::vector<double> share(nodes, 0);
  for (const PointBlock& block : blocks)
    for (std::size_t k = 0; k < block.nodes.size(); ++k) share[block.nodes[k]] += block.node_share[k];
  return share;
}

void MaterialPoints::number_points(std::size_t nodes) {
  first_.assign(1, 0);
  scatter_begin_.assign(1, 0);
  slot_begin_.assign(nodes + 1, 0);
  for (const PointBlock& b : blocks) {
    first_.push_back(first_.back() + b.points.size());
    scatter_begin_.push_back(scatter_begin_.back() + b.nodes.size());
    for (const auto j : b.nodes) ++slot_begin_[j + 1];
  }
  for (std::size_t j = 0; j < nodes; ++j) slot_begin_[j + 1] += slot_begin_[j];
  slot_.resize(scatter_begin_.back());
  std::vector<std::uint32_t> next(slot_begin_.begin(), slot_begin_.end() - 1);
  for (std::size_t b = 0; b < blocks.size(); ++b)
    for (std::size_t k = 0; k < blocks[b].nodes.size(); ++k)
      slot_[next[blocks[b].nodes[k]]++] = static_cast<std::uint32_t>(scatter_begin_[b] + k);
}

void MaterialPoints::set_materials(const Materials& materials) {
  parallel_for(blocks.size(), 16, [&](std::size_t begin, std::size_t end) {
    for (std::size_t b = begin; b < end; ++b) blocks[b].set_materials(materials);
  });
}

void MaterialPoints::gather(std::size_t block, const std::vector<Vec3>& u, std::vector<double>& values) const {
  const auto& nodes = blocks[block].nodes;
  if (values.size() < 4 * nodes.size()) values.resize(4 * nodes.size());
  for (std::size_t k = 0; k < nodes.size(); ++k)
    Eigen::Map<Eigen::Vector4d>{&values[4 * k]} << u[nodes[k]] - u[nodes[0]], 0;
}

std::vector<Mat3> MaterialPoints::gradients(std::size_t block, const std::vector<Vec3>& u) const {
  const PointBlock& b = blocks[block];
  PointMatrices<double> columns;
  std::vector<double> values;
  gather(block, u, values);
  point_gradients(b, values.data(), columns);
  return to_matrices(columns, b.points.size());
}

}  // namespace geo
