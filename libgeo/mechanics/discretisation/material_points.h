// Material points, which carry strain, in blocks. A block has its own short list of nodes: its data
// fit a core's cache, and sums are made in an order that neither threads nor vector widths change.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <span>
#include <utility>
#include <vector>

#include "kerf/material.h"
#include "kerf/parallel.h"
#include "mechanics/discretisation/shape_functions.h"

namespace geo {

/// A point where strain energy is integrated.
struct MaterialPoint {
  Vec3 position = Vec3::Zero();
  double volume = 0;  ///< integration weight, model units³
  MomentQuality quality = MomentQuality::singular;
  std::uint8_t widenings = 0;   ///< how often its supports were widened by a fifth
  bool occluded = false;        ///< a face hides a node within its support
  std::uint16_t material = 0;   ///< index of the material of the nodes that it sees
  double influence_radius = 0;  ///< bounds the distance of all nodes in its support and of all paths to them
  double unscaled_volume = 0;   ///< its volume before the scaling to the nodes' total volume
};

/// Points of a block from `begin` up to `end`, multiples of eight, that contain points of one
/// material. `uniform`: they contain no points of another one.
struct MaterialRange {
  std::uint32_t begin = 0, end = 0;
  std::uint16_t material = 0;
  bool uniform = true;
};

/// Neighbouring points and the gradients of their shape functions. An entry is a pair of a point
/// and a node in its support; entries are stored by point.
struct PointBlock {
  std::vector<std::uint32_t> nodes;  ///< of all points, ascending
  std::vector<MaterialPoint> points;
  std::vector<std::uint32_t> entry_begin;    ///< per point: its first entry; one more at the end
  std::vector<std::uint16_t> entry_node;     ///< per entry: index into `nodes`
  std::vector<double> entry_gradient;        ///< per entry: three numbers, the shape gradient
  std::vector<float> entry_gradient_single;  ///< the same in single precision
  std::vector<std::uint8_t> entry_bent;      ///< per entry: 1 if the point sees the node round the front of a crack
  std::vector<double> node_share;            ///< per node: Σ 1 / n over the points that it supports, n their nodes
  // The same quantised to 16 bits, for stiffness–vector products, with points in quads (four points
  // side by side). A quad's nodes are the union of its points' nodes, padded to an even number.
  // Nodes come in pairs of 24 integers: x of the first node's gradient for four points, x of the
  // second's, then y, then z. They are multiples of the point's `quantum` and rounded such that
  // they still sum to zero over the nodes.
  std::vector<std::uint32_t> quad_begin;       ///< per quad: its first node; one more at the end
  std::vector<std::uint16_t> quad_node;        ///< per node of a quad: index into `nodes`
  std::vector<std::int16_t> quad_gradient;     ///< per node of a quad: 12 integers, as above
  std::vector<float> quantum;                  ///< per point, padded to a multiple of eight, 1/model unit
  Box3 box;                                    ///< of the points' positions
  std::vector<MaterialRange> material_ranges;  ///< in order; where eight points mix materials, one range for each

  /// Where a point's shape gradients come from: `shape`, or if that is null, a point of another
  /// block.
  struct Source {
    const PointBlock* block = nullptr;
    std::size_t point = 0;
    const ShapeGradients* shape = nullptr;
  };

  /// Consecutive points of a block, or one point with a `shape` of its own.
  struct SourceRun : Source {
    std::size_t count = 1;  ///< of points
    /// The first entry in the block.
    std::uint32_t begin() const { return block->entry_begin[point]; }
    /// The entry after the last.
    std::uint32_t end() const { return block->entry_begin[point + count]; }
    /// The number of entries.
    std::size_t entries() const { return shape ? shape->nodes.size() : end() - begin(); }
  };

  /// An empty block.
  PointBlock() = default;
  /// One source per point. Throws InputError if the block has more than 65536 nodes.
  PointBlock(std::vector<MaterialPoint> points, std::span<const Source> sources);
  /// Shape gradients per point.
  PointBlock(std::vector<MaterialPoint> points, std::span<const ShapeGradients> shapes);
  /// The shape gradients of a point, with global node indices.
  ShapeGradients shape_gradients(std::size_t point) const;
  /// Assigns to each point the material of its nodes, and finds the ranges of materials.
  void set_materials(const Materials& materials);
  /// True unless the point has another material than the range. Padding, and points without nodes,
  /// belong to any range.
  bool belongs_to(const MaterialRange& range, std::size_t point) const {
    return point >= points.size() || points[point].material == range.material ||
           entry_begin[point] == entry_begin[point + 1];
  }
  /// True if all but boxes and material ranges are equal.
  friend bool operator==(const PointBlock& a, const PointBlock& b);

 private:
  // Per source block: the indices in `nodes` of its nodes in use.
  using LocalNodes = std::map<const PointBlock*, std::vector<std::uint16_t>>;
  LocalNodes list_nodes(std::span<const SourceRun> runs, std::vector<std::uint16_t>& place);
  void append(const ShapeGradients& shape, std::span<const std::uint16_t> place);
  void append(const SourceRun& run, std::span<const std::uint16_t> local_node);
  void quantise(std::size_t quad);
  void copy_quad(std::size_t quad, const Source& from, const std::vector<std::uint16_t>& local_node);
};

/// The changes of points and blocks by a cut. ~0u stands for none.
struct PointChanges {
  std::vector<std::uint32_t> old_point;  ///< per point now: its old index; empty if points are the same
  std::vector<std::uint32_t> new_block;  ///< per old block: the index of the block that has the same points now
  std::vector<char> is_stale;            ///< per point now: 1 if it was computed anew
  std::vector<char> node_changed;        ///< per node: 1 if points or shape gradients with it, or their blocks, changed
  /// Some points computed anew: index, and shape functions with values. Ascending.
  std::vector<std::pair<std::uint32_t, ShapeGradients>> valued;
};

/// All material points of a body.
class MaterialPoints {
 public:
  std::vector<PointBlock> blocks;

  /// Numbers points and scatter slots. Call it after blocks have changed; `nodes`: the number of
  /// nodes of the body.
  void number_points(std::size_t nodes);
  /// Assigns materials to the points of all blocks. Precondition: number_points() was called.
  void set_materials(const Materials& materials);
  /// The number of points.
  std::size_t size() const { return first_.empty() ? 0 : first_.back(); }
  /// The index of a block's first point.
  std::size_t first_point(std::size_t block) const { return first_[block]; }

  /// Gathers a nodal field at a block's nodes, four numbers each, relative to the value at its
  /// first node: differences stay accurate if the body has moved far. `values` grows if it is too
  /// short.
  void gather(std::size_t block, const std::vector<Vec3>& u, std::vector<double>& values) const;
  /// Per node, of `nodes`: Σ 1 / n over the points that it supports, n the number of nodes of a
  /// point. All shares sum up to the number of points with strain.
  std::vector<double> shares(std::size_t nodes) const;
  /// ∇u at the points of a block, in order.
  std::vector<Mat3> gradients(std::size_t block, const std::vector<Vec3>& u) const;

  /// Each block scatters its nodal sums into slots of its own, one per node of the block, so that
  /// threads do not share any. The first slot of a block:
  std::size_t scatter_offset(std::size_t block) const { return scatter_begin_[block]; }
  /// The number of slots of all blocks.
  std::size_t scatter_size() const { return scatter_begin_.back(); }
  /// The sum at a node of all its slots, in the order of blocks. `slots`: `width` numbers per slot.
  template <std::size_t width, class Number>
  std::array<double, width> sum_at_node(const Number* slots, std::size_t node) const {
    std::array<double, width> sum{};
    for (auto k = slot_begin_[node]; k < slot_begin_[node + 1]; ++k)
      for (std::size_t c = 0; c < width; ++c) sum[c] += double(slots[width * slot_[k] + c]);
    return sum;
  }

 private:
  std::vector<std::size_t> first_, scatter_begin_;  // per block and one more: points, slots
  std::vector<std::uint32_t> slot_begin_, slot_;    // per node: its slots
};

}  // namespace geo
