// Potential of a rigid obstacle: a penalty on surface vertices inside it, with Coulomb friction
// (§ 3.3, contact with rigid objects).
#pragma once

#include <Eigen/Geometry>
#include <memory>
#include <span>
#include <vector>

#include "contact/response/rigid_shape.h"
#include "contact/surface/surface_weights.h"
#include "kerf/potential.h"
#include "mechanics/terms/contact_law.h"

namespace geo {

/// Strength of an obstacle's penalty.
struct ObstaclePenaltyOptions {
  /// Pressure over depth, Pa/m: a body that presses with p stands p / pressure deep, in model
  /// units.
  double pressure = 1e6;
  double friction = 0.5;  ///< Coulomb's coefficient
};

/// The law of contact_law.h for every surface vertex inside the obstacle. Its stiffness is pressure
/// times a third of the area of its triangles at rest. Vertices act on nodes by the weights of Eq.
/// 1. Slip is relative to the obstacle's own motion; friction has the normal of the substep's
/// beginning.
class ObstaclePenalty : public Potential {
 public:
  /// The obstacle moves from one pose to the other during the step, at even speed.
  ObstaclePenalty(std::shared_ptr<const RigidShape> shape, const ObstaclePenaltyOptions& options,
                  const Eigen::Isometry3d& from, const Eigen::Isometry3d& to);

  /// Makes contacts of the vertices that may reach the obstacle in this step: those nearer than
  /// `reach`, model units. `weights` must outlive this. `surface`: targets of surface vertices when
  /// the step begins (surface_targets.h). `slip_regularisation`: model units. `pressure_factor`: of
  /// nodes, of the pressure on the surface that each carries; empty: 1.
  void find_contacts(const SurfaceWeights& weights, std::span<const Vec3> surface, double reach,
                     double slip_regularisation, std::span<const double> pressure_factor = {});
  /// Whether the obstacle moves in this step.
  bool moves() const { return from_.matrix() != to_.matrix(); }
  /// Whether no vertex may reach the obstacle.
  bool empty() const { return contacts_.empty(); }

  /// Moves the obstacle to the substep's end and takes friction bounds at its beginning. The first
  /// substep begins at the surface of find_contacts(), not at u.
  void begin_substep(const std::vector<Vec3>& u, double from, double to) override;
  /// Number of vertices.
  std::size_t size() const override { return contacts_.size(); }
  /// Nodes that carry a vertex.
  Stencil stencil(std::size_t k) const override { return contacts_[k].weights; }
  /// A vertex is carried by its master node, that node's neighbours and theirs.
  bool within_components() const override { return true; }
  /// Distance of a vertex less the obstacle's motion, over the norm of the vertex' weights.
  double activation_distance(std::size_t k) const override { return contacts_[k].activation_distance; }
  /// Energy of penalty and friction, J.
  double energy(std::size_t k, const Vec3& d) const override;
  /// Derivatives of penalty and friction.
  Derivatives derivatives(std::size_t k, const Vec3& d) const override;
  /// Takes the bound of friction.
  double begin_iterate(std::size_t k, const Vec3& d) override;
  /// The stiffness of the penalty.
  double stiffness_bound(std::size_t k) const override { return contacts_[k].stiffness; }
  /// The penalty's impulse of an explicit substep; friction stops the slip velocity as far as it
  /// can.
  void apply_impulse(const std::vector<Vec3>& u, double h, const std::vector<double>& inverse_mass,
                     std::vector<Vec3>& velocity) override;

  /// Mean force and torque on the obstacle.
  struct Reaction {
    Vec3 force = Vec3::Zero();   ///< N
    Vec3 torque = Vec3::Zero();  ///< N m, about the obstacle's origin
  };
  /// Mean reaction of the body over the step that ended at displacements u.
  Reaction reaction(const std::vector<Vec3>& u) const;
  /// Largest depth of a vertex at displacements u, model units; 0: none is inside.
  double depth(const std::vector<Vec3>& u) const;

 private:
  // A surface vertex. Positions are world coordinates; that of rest includes what rotations of
  // debris add.
  struct Contact {
    Stencil weights;
    Vec3 rest = Vec3::Zero(), displacement = Vec3::Zero();  // displacement: at the step's beginning
    double stiffness = 0;                                   // N/m
    double weight_norm = 0;
    // At the substep's beginning:
    Vec3 start = Vec3::Zero();       // position
    double distance = 0;             // to the obstacle; negative inside
    double activation_distance = 0;  // of nodes
    Vec3 normal = Vec3::Zero();
    Vec3 stuck = Vec3::Zero();  // where the vertex would be now had it stuck to the obstacle
    FrictionMemory friction;
  };
  Eigen::Isometry3d pose(double share) const;
  RigidShape::Field penetration(const Contact& c, const Vec3& y) const;
  static Vec3 slip(const Contact& c, const Vec3& y);
  LaggedFriction friction(const Contact& c) const {
    return {options_.friction * c.friction.normal_force, slip_regularisation_};
  }
  void add_reaction(const std::vector<Vec3>& u, Reaction& sum) const;
  template <class Use>
  void for_each_displacement(const std::vector<Vec3>& u, const Use& use) const;

  std::shared_ptr<const RigidShape> shape_;
  ObstaclePenaltyOptions options_;
  Eigen::Isometry3d from_, to_, now_;                                     // now_: at the end of the substep
  double slip_regularisation_ = 0, substep_begin_ = 0, substep_end_ = 0;  // the last two in shares of the step
  Reaction sum_;           // of earlier substeps, times their shares; of impulses, this substep included
  bool impulses_ = false;  // the step is explicit
  std::vector<Contact> contacts_;
};

}  // namespace geo
