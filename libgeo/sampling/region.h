// Regions of a solid: boxes with the triangles that may meet them and, exactly, the side of one
// point.
#pragma once

#include <span>
#include <vector>

#include "geometry/bvh.h"
#include "kerf/mesh.h"
#include "sampling/lattice.h"

namespace geo {

/// A cell, the triangles that may meet its closed box, and whether `probe`, a point of the box, is
/// strictly inside the solid. Without triangles the whole box is on the side of the probe.
struct Region {
  Cell cell;
  Vec3 probe = Vec3::Zero();
  bool inside = false;
  std::vector<std::uint32_t> triangles;  ///< indices into the solid's triangles
  /// May the surface cut the cell?
  bool cut() const { return !triangles.empty(); }
};

/// Point location in a closed surface from coarse cells to fine ones. Each answer costs a walk from
/// a point whose side is known past the few triangles of one cell. Thread-safe.
class RegionTree {
 public:
  /// `solid` is closed; its triangles are copied.
  explicit RegionTree(const TriangleMesh& solid);

  /// The region of a cell that contains the whole surface.
  Region root(const Lattice& lattice, const Cell& cell) const;
  /// The region of any cell: equal to that reached from the root by divide().
  Region at(const Lattice& lattice, const Cell& cell) const;
  /// Calls each(Region&&) for each of the eight parts of a region that holds material, in Morton
  /// order.
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
  /// The same for many points of its box, at less cost a point. `answers` has one entry a point.
  void inside(const Region& region, std::span<const Vec3> points, std::span<char> answers) const;

  /// The tree over the solid's triangles.
  const TriangleBvh& tree() const { return tree_; }
  /// Corners of a triangle.
  const std::array<Vec3, 3>& corners(std::uint32_t triangle) const { return corners_[triangle]; }
  /// Outward unit normal of a triangle; zero where it has no area.
  const Vec3& normal(std::uint32_t triangle) const { return normals_[triangle]; }

 private:
  Region child(const Lattice& lattice, const Region& region, const Cell& cell) const;
  std::vector<std::array<Vec3, 3>> corners_;
  std::vector<Vec3> normals_;
  TriangleBvh tree_;
};

/// False only where box and triangle are certainly apart (filtered predicates).
bool may_meet(const Box3& box, const Vec3& a, const Vec3& b, const Vec3& c);

}  // namespace geo
