// Points that carry strain, in blocks: each block has its own short list of nodes, so that what one thread works on
// stays in its cache, and sums are made in an order that no thread or vector width changes.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "kerf/material.h"
#include "kerf/parallel.h"
#include "mechanics/discretisation/shape_functions.h"

namespace geo {

struct MaterialPoint {
  Vec3 position = Vec3::Zero();
  double volume = 0;
  Rung rung = Rung::rigid;
  std::uint8_t growth = 0;     ///< how often its support was widened by a fifth
  bool blinded = false;        ///< a face hides a node within its support
  std::uint16_t material = 0;  ///< that of the nodes that it sees
  double reach = 0;            ///< no node within its support is farther away, nor is any part of a way to one
  double measured = 0;         ///< its volume before all were scaled to sum to that of the nodes
};

/// Points of a block with the same material, from a multiple of eight to the next or a later one. `alone`: no points of
/// others stand among them.
struct MaterialRun {
  std::uint32_t begin = 0, end = 0;
  std::uint16_t material = 0;
  bool alone = true;
};

/// Points near each other and the rows of their shape functions.
struct PointBlock {
  std::vector<std::uint32_t> nodes;  ///< of all its points, ascending
  std::vector<MaterialPoint> points;
  std::vector<std::uint32_t> first;  ///< per point: its first entry; one more at the end
  std::vector<std::uint16_t> to;     ///< entries: places in `nodes`
  std::vector<double> gradient;      ///< three an entry
  std::vector<float> rounded;        ///< the same
  // The same for products, four points side by side: places of their nodes in `nodes`, as all of them have them, an
  // even number; of two of these 24 numbers, x of the first for four points, x of the second, then y, then z, in
  // multiples of the point's unit, such that they still sum to zero.
  std::vector<std::uint32_t> four_first;  ///< per four points: the first of their nodes; one more at the end
  std::vector<std::uint16_t> four_to;
  std::vector<std::int16_t> packed;
  std::vector<float> unit;        ///< per point, a multiple of eight of them
  Box3 box;                       ///< of the points
  std::vector<MaterialRun> runs;  ///< in order; where eight points have several materials, one run for each of these

  /// Where a point's row comes from: its own, or that of a point of another block.
  struct Source {
    const PointBlock* block = nullptr;
    std::size_t point = 0;
    const ShapeRow* row = nullptr;
  };

  PointBlock() = default;
  PointBlock(std::vector<MaterialPoint> points, std::span<const Source> sources);
  PointBlock(std::vector<MaterialPoint> points, std::span<const ShapeRow> rows);
  /// A row that it was made of.
  ShapeRow row(std::size_t point) const;
  /// Gives points the materials of nodes.
  void set_materials(const Materials& materials);
  /// False where a point has another material than the run that it stands in. What is no point, or sees nothing, is of
  /// any run.
  bool is_of(const MaterialRun& run, std::size_t point) const {
    return point >= points.size() || points[point].material == run.material || first[point] == first[point + 1];
  }
  friend bool operator==(const PointBlock& a, const PointBlock& b);

 private:
  void pack(std::size_t four);
  void copy_packed(std::size_t four, const Source& from, const std::vector<std::uint16_t>& to_here);
};

/// What a cut did to points.
struct PointChanges {
  std::vector<std::uint32_t> kept;  ///< per point there is now, its number before, or ~0u; empty where all are the same
  std::vector<std::uint32_t> blocks;  ///< per block there was, the number of the one with the same points now, or ~0u
  std::vector<char> nodes;  ///< per node: 1 where points with it came, went or have another row, or are in other blocks
};

class MaterialPoints {
 public:
  std::vector<PointBlock> blocks;

  /// After blocks have changed.
  void connect(std::size_t nodes);
  /// After connect().
  void set_materials(const Materials& materials);
  std::size_t size() const { return first_.empty() ? 0 : first_.back(); }
  /// Number of a block's first point.
  std::size_t first(std::size_t block) const { return first_[block]; }

  /// A nodal field at a block's nodes, four numbers each, from its first node's value on: differences lose nothing
  /// where a body is far from where it was. `values` is made longer where it is too short.
  void values(std::size_t block, const std::vector<Vec3>& u, std::vector<double>& values) const;
  /// ∇u at the points of a block, in order.
  std::vector<Mat3> gradients(std::size_t block, const std::vector<Vec3>& u) const;
  /// The sum of what blocks have for a node, in their order: `width` numbers a node of a block, from width ·
  /// part(block) on.
  template <std::size_t width, class Number>
  std::array<double, width> sum(const Number* parts, std::size_t node) const {
    std::array<double, width> sum{};
    for (auto k = begin_[node]; k < begin_[node + 1]; ++k)
      for (std::size_t c = 0; c < width; ++c) sum[c] += double(parts[width * incoming_[k] + c]);
    return sum;
  }
  std::size_t part(std::size_t block) const { return part_[block]; }
  std::size_t parts() const { return part_.back(); }

 private:
  std::vector<std::size_t> first_, part_;        // per block and one more: points, nodes
  std::vector<std::uint32_t> begin_, incoming_;  // per node: which parts of blocks are its
};

}  // namespace geo
