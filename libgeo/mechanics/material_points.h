// Points that carry strain, in blocks: each block has its own short list of nodes, so that what one thread works on stays
// in its cache, and sums are made in an order that no thread or vector width changes.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "base/parallel.h"
#include "mechanics/shape_functions.h"

namespace geo {

struct MaterialPoint {
  Vec3 position = Vec3::Zero();
  double volume = 0;
  Rung rung = Rung::rigid;
  std::uint8_t growth = 0;  ///< how often its support was widened by a fifth
  bool blinded = false;     ///< a face hides a node within its support
  double reach = 0;         ///< no node within its support is farther away, nor is any part of a way to one
  double measured = 0;      ///< its volume before all were scaled to sum to that of the nodes
};

/// Points near each other and the rows of their shape functions.
struct PointBlock {
  std::vector<std::uint32_t> nodes;  ///< of all its points, ascending
  std::vector<MaterialPoint> points;
  std::vector<std::uint32_t> first;  ///< per point: its first entry; one more at the end
  std::vector<std::uint16_t> to;     ///< entries: places in `nodes`
  std::vector<double> gradient;      ///< three an entry
  std::vector<float> rounded;        ///< the same
  std::vector<std::int16_t> packed;  ///< the same, in multiples of the point's unit, such that they still sum to zero, and `to`
  std::vector<float> unit;           ///< per point, a multiple of eight of them
  Box3 box;                          ///< of the points

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
  friend bool operator==(const PointBlock& a, const PointBlock& b);

 private:
  void pack(std::size_t point);
};

/// What a cut did to points.
struct PointChanges {
  std::vector<std::uint32_t> kept;    ///< per point there is now, its number before, or ~0u; empty where all are the same
  std::vector<std::uint32_t> blocks;  ///< per block there was, the number of the one with the same points now, or ~0u
  std::vector<char> nodes;            ///< per node: 1 where points with it came, went or have another row, or are in other blocks
};

class MaterialPoints {
 public:
  std::vector<PointBlock> blocks;

  /// After blocks have changed.
  void connect(std::size_t nodes);
  std::size_t size() const { return first_.empty() ? 0 : first_.back(); }
  /// Number of a block's first point.
  std::size_t first(std::size_t block) const { return first_[block]; }

  /// ∇u at the points of a block, in order.
  std::vector<Mat3> gradients(std::size_t block, const std::vector<Vec3>& u) const;
  /// Calls work(block, ∇u at its points) for each block, from any thread; work replaces each ∇u by a stress (times volume).
  /// out, one a node: Σ over points of stress · shape gradient; nothing where `out` is null.
  void transform(const std::vector<Vec3>& u, const std::function<void(std::size_t, std::span<Mat3>)>& work, std::vector<Vec3>* out) const;
  /// Sums what blocks have for each node, in the order of blocks: `width` numbers (8 at most) a node of a block, from
  /// width · part(block) on. Calls take(node, sums), from any thread.
  template <class Number, class Take>
  void gather(const Number* parts, std::size_t width, const Take& take) const;
  std::size_t part(std::size_t block) const { return part_[block]; }
  std::size_t parts() const { return part_.back(); }

 private:
  std::vector<std::size_t> first_, part_;        // per block and one more: points, nodes
  std::vector<std::uint32_t> begin_, incoming_;  // per node: which parts of blocks are its
};

template <class Number, class Take>
void MaterialPoints::gather(const Number* parts, std::size_t width, const Take& take) const {
  parallel_for(begin_.size() - 1, 1024, [&](std::size_t begin, std::size_t end) {
    for (std::size_t j = begin; j < end; ++j) {
      double sum[8] = {};
      for (auto k = begin_[j]; k < begin_[j + 1]; ++k)
        for (std::size_t c = 0; c < width; ++c) sum[c] += double(parts[width * incoming_[k] + c]);
      take(j, sum);
    }
  });
}

}  // namespace geo
