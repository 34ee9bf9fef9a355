// Boxes with what is known of the material in them: the triangles that may meet them and, exactly, the side of one
// point.
#pragma once

#include <span>
#include <vector>

#include "geometry/bvh.h"
#include "kerf/mesh.h"
#include "sampling/lattice.h"

namespace geo {

/// A cell, the rows of all triangles that may meet its closed box, and whether `probe`, a point of the box, is strictly
/// inside. Without triangles the whole box is on the probe's side.
struct Region {
  Cell cell;
  Vec3 probe = Vec3::Zero();
  bool inside = false;
  std::vector<std::uint32_t> rows;
  bool cut() const { return !rows.empty(); }
};

/// A closed surface, asked from coarse cells to fine ones: each answer costs a walk from a point whose side is known,
/// past the few triangles of one cell. Thread-safe.
class RegionTree {
 public:
  /// `solid` is closed; its triangles are copied.
  explicit RegionTree(const TriangleMesh& solid);

  /// A region for a cell that holds the whole surface.
  Region root(const Lattice& lattice, const Cell& cell) const;
  /// A region for any cell: as one that is come to from the root.
  Region at(const Lattice& lattice, const Cell& cell) const;
  /// Calls each(Region&&) for the parts of a region that hold material, in Morton order.
  template <class Each>
  void divide(const Lattice& lattice, const Region& region, const Each& each) const {
    const std::int32_t half = 1 << (region.cell.level - 1);
    const auto& c = region.cell.corner;
    for (int k = 0; k < 8; ++k)
      if (Region part = child(lattice, region,
                              {{c[0] + (k & 1 ? half : 0), c[1] + (k & 2 ? half : 0), c[2] + (k & 4 ? half : 0)},
                               region.cell.level - 1});
          part.cut() || part.inside)
        each(std::move(part));
  }
  /// Whether a point of the region's box is strictly inside the surface: exact.
  bool inside(const Region& region, const Vec3& p) const;
  /// The same for points of its box, one after the other; cheap where many are asked. `answers` has one entry a point.
  void inside(const Region& region, std::span<const Vec3> points, std::span<char> answers) const;

  const TriangleBvh& tree() const { return tree_; }
  const std::array<Vec3, 3>& corners(std::uint32_t row) const { return corners_[row]; }
  /// Outward unit normal; zero for a triangle without area.
  const Vec3& normal(std::uint32_t row) const { return normals_[row]; }

 private:
  Region child(const Lattice& lattice, const Region& region, const Cell& cell) const;
  std::vector<std::array<Vec3, 3>> corners_;
  std::vector<Vec3> normals_;
  TriangleBvh tree_;
};

/// False only where box and triangle are certainly apart (filtered predicates).
bool may_meet(const Box3& box, const Vec3& a, const Vec3& b, const Vec3& c);

}  // namespace geo
