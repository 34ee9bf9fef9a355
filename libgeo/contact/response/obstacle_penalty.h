// A rigid obstacle: a penalty on each vertex of the surface that is inside it, with Coulomb
// friction (§ 3.3, between objects).
#pragma once

#include <memory>

#include "contact/response/rigid_shape.h"
#include "contact/surface/surface_weights.h"
#include "mechanics/terms/potential.h"

namespace geo {

struct ObstaclePenaltyOptions {
  double pressure =
      1e6;  ///< Pa for a metre of depth: a body that presses with p stands p / pressure deep, in model units
  double friction = 0.5;  ///< Coulomb's coefficient
};

/// ½ pressure area depth² at each surface vertex, area being a third of its triangles' at rest,
/// depth how far it is inside. Friction acts on the way beside the obstacle since the step began,
/// with the normal and the normal force of that moment: that is the derivative of a convex
/// potential (Li et al. 2020, § 5). Vertices act on nodes by the weights of Eq. 1.
class ObstaclePenalty : public Potential {
 public:
  /// Moves from one pose to the other during the step, its turn even.
  ObstaclePenalty(std::shared_ptr<const RigidShape> shape, const ObstaclePenaltyOptions& options,
                  const Eigen::Isometry3d& from, const Eigen::Isometry3d& to);

  /// Where a body is when a step begins.
  struct Watched {
    const std::vector<Vec3>& u;          ///< displacements of its nodes
    std::span<const Vec3> at;            ///< its surface vertices; empty: found from u, where they may be near
    std::span<const std::uint8_t> near;  ///< then: nodes that carry surface that may be
  };
  /// Which vertices may reach the obstacle in that step (those nearer than `reach`), and their
  /// weights, which must outlive it. `slow`: a way along the obstacle, model units, below which
  /// friction is smooth. `firmness`: per node, of what its surface is pressed with, times the
  /// pressure; empty: 1.
  void watch(const Body& body, const SurfaceWeights& weights, const Watched& watched, double reach, double slow,
             std::span<const double> firmness = {});

  bool empty() const { return rows_.empty(); }  ///< no vertex may reach it

  /// A step's first part begins at the displacements of watch().
  void begin_substep(const std::vector<Vec3>& u, double from, double to) override;
  std::size_t size() const override { return rows_.size(); }
  Stencil stencil(std::size_t k) const override { return rows_[k].weights; }
  /// A vertex follows its master's node, that node's neighbours and theirs.
  bool within_components() const override { return true; }
  double activation_distance(std::size_t k) const override { return rows_[k].reach; }
  double energy(std::size_t k, const Vec3& d) const override;
  Derivatives derivatives(std::size_t k, const Vec3& d) override { return pushed(rows_[k], d); }
  double stiffness_bound(std::size_t k) const override { return rows_[k].stiffness; }
  /// Pushes vertex by vertex, and takes away as much of its velocity along the obstacle as friction
  /// can.
  void apply_impulse(const std::vector<Vec3>& u, double h, const std::vector<double>& inverse_mass,
                     std::vector<Vec3>& velocity) override;

  struct Reaction {
    Vec3 force = Vec3::Zero();   ///< N
    Vec3 torque = Vec3::Zero();  ///< N m, about the obstacle's origin
  };
  /// What the body did to the obstacle, mean over the step that ended at displacements u.
  Reaction reaction(const std::vector<Vec3>& u) const;
  /// Deepest vertex inside, at displacements u; 0: none.
  double depth(const std::vector<Vec3>& u) const;

 private:
  struct Row {
    std::span<const SurfaceWeights::Entry> weights;
    Vec3 rest = Vec3::Zero(), way = Vec3::Zero();  // way: when it was watched
    double stiffness = 0;                          // N/m
    double spread = 0;                             // of its weights
    Vec3 start = Vec3::Zero();                     // where the vertex was
    double outside = 0;                            // how far outside then
    double reach = 0;                              // how far nodes may go before it can be inside
    double pressed = 0;                            // N, then
    Vec3 normal = Vec3::Zero();                    // world, then
    Vec3 stuck = Vec3::Zero();                     // where it would be had it stuck to the obstacle
  };
  static Vec3 at(const Row& row, const std::vector<Vec3>& values) { return weighted_sum(row.weights, values); }
  Derivatives pushed(const Row& row, const Vec3& way) const;
  Eigen::Isometry3d pose(double share) const;
  /// In world coordinates; distance 0 where the row is outside.
  RigidShape::Field inside(const Row& row, const Vec3& y) const;
  /// The way beside the obstacle of a vertex that is at y now, and the force of friction over it,
  /// N/m.
  static Vec3 slide(const Row& row, const Vec3& y);
  double drag(const Row& row, const Vec3& slide) const;
  void add_reaction(const std::vector<Vec3>& u, Reaction& to) const;
  /// Calls take(row number, its way) for each row, from any thread.
  template <class Take>
  void each_way(const std::vector<Vec3>& u, const Take& take) const;

  std::shared_ptr<const RigidShape> shape_;
  ObstaclePenaltyOptions options_;
  Eigen::Isometry3d from_, to_, now_;        // now_: at the end of this part of the step
  double slow_ = 0, begun_ = 0, ended_ = 0;  // shares of the step
  Reaction sum_;                             // of the parts before this one, times their shares
  bool impulses_ = false;                    // sum_ is of impulses, this part's included
  std::vector<Row> rows_;
};

}  // namespace geo
