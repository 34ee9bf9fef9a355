// Essential boundary conditions on the material in boxes: a boundary-corrected basis near them
// (Kantorovich and Krylov 1958; Rvachev and Sheiko 1995).
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "kerf/body.h"
#include "kerf/material.h"
#include "mechanics/discretisation/material_points.h"

namespace geo {

/// Replaces the shape gradients of material points in and near held boxes, and restores them.
///
/// Moving least squares do not interpolate: with the nodes in a box held, the material in it still
/// moves, and the solid acts as if the box ended a node spacing farther in. Here the field near a
/// box is u = ū + w Σ φ_j (u_j − ū(x_j)) over the nodes outside. ū is the rigid motion of the box.
/// w rises from 0 on the box to 1 at a node spacing from it.
class HeldMaterial {
 public:
  /// Sets the boxes. Returns false if they are the same as before; else call restore(), apply().
  bool set_boxes(std::span<const HeldBox> boxes);
  /// Whether apply() may replace the shape gradients of a point at x. `reach`: reach_of(nodes).
  bool is_near(const Vec3& x, double reach) const;
  /// The first box that holds x, if it moves like a rigid body.
  std::optional<std::uint32_t> rigid_box_at(const Vec3& x) const;
  /// The nodes at these positions that a box holds, ascending.
  std::vector<std::uint32_t> nodes_in(std::uint32_t box, const std::vector<Vec3>& position) const;
  /// Farthest from a box that a point is replaced, model units: supports of points may be widened.
  static double reach_of(const NodeSet& nodes);
  /// Puts back the shape gradients of the plain basis. Keeps results of apply() for the next one.
  void restore(MaterialPoints& points);
  /// Replaces blocks of points near boxes. Precondition: `points` have the plain basis, numbered or
  /// not. `component`: per node, of the visibility graph. `changes`: of the points since restore();
  /// null: none. Its `valued` points are used up. The result depends on body, boxes and components
  /// alone. Returns whether any block is replaced; then the points are to be numbered.
  bool apply(const Body& body, const std::vector<std::uint32_t>& component, PointChanges* changes,
             MaterialPoints& points);

 private:
  // The first box that holds x, or ~0u.
  std::uint32_t box_holding(const Vec3& x) const;
  /// Four nodes of a box and a component. Their displacements give the rigid motion ū as
  /// Σ λ_a(x) u_a, with λ = coordinates · (1, x).
  struct Anchors {
    std::uint32_t box, component;
    std::array<std::uint32_t, 4> node;
    Eigen::Matrix4d coordinates;
    friend bool operator==(const Anchors&, const Anchors&) = default;
  };
  struct Replaced {
    std::uint32_t block;
    PointBlock plain, held;
    std::size_t first_point = 0;
  };
  struct Shapes;

  class Former;
  // A block near a box: the source of each point, and the points to compute anew, ascending.
  struct Near {
    std::uint32_t block = 0;
    std::size_t first_point = 0;
    std::vector<PointBlock::Source> sources;
    bool has_former = false;  // some sources are what replaced points before
    std::vector<std::uint32_t> stale;
  };
  struct Candidate;

  std::vector<Anchors> anchors_of(const Body& body, const std::vector<std::uint32_t>& component) const;
  std::vector<Candidate> candidates_in(const Near& near, double reach, const MaterialPoints& points,
                                       PointChanges* changes) const;
  void replace(const Body& body, const std::vector<std::uint32_t>& component, std::span<const Near> blocks,
               PointChanges* changes, MaterialPoints& points);

  std::vector<HeldBox> boxes_;
  std::vector<std::uint32_t> box_of_node_;  // per node: the first box that holds it, or ~0u
  std::vector<std::uint32_t> component_;    // per node, as of the last apply()
  std::vector<Anchors> anchors_;            // by box, then by component
  std::vector<Replaced> replaced_;          // ascending; between restore() and apply() `plain` is empty
};

}  // namespace geo
