// Potential of thick blades: behind its edge a blade is a wedge that presses the material apart.
// The paper leaves this to the contact of objects (§ 5.1).
#pragma once

#include <algorithm>
#include <functional>
#include <span>
#include <vector>

#include "kerf/body.h"
#include "kerf/potential.h"
#include "kerf/vec.h"
#include "mechanics/terms/contact_law.h"

namespace geo {

/// A blade where it is at the end of a step. Its flanks are the parallelograms of edge segments and
/// `back`.
struct BladeWedge {
  std::vector<Vec3> edge;    ///< points of the cutting edge, world
  bool closed = false;       ///< the last point is followed by the first
  Vec3 back = Vec3::Zero();  ///< from the edge to the back of the blade, world
  double thickness = 0;      ///< at the back, model units
  double stiffness = 0;      ///< acceleration over depth, 1/s²
  double friction = 0;       ///< Coulomb's coefficient
  /// The way of a point of the blade in the whole step, given where it is at its begin, world.
  std::function<Vec3(const Vec3&)> way = [](const Vec3&) { return Vec3(Vec3::Zero()); };
};

/// Nodes of a body. Refers to everything.
struct BladeNodes {
  const std::vector<Vec3>&position, &displacement;  ///< material coordinates; displacements
  const std::vector<double>& radius;                ///< bound of surface_distance(): support radii
  std::function<double(std::size_t)> surface;       ///< of a node: surface_distance()
  std::function<double(std::size_t)> mass;          ///< of a node, kg
};

/// Distance of a node from the nearest face in the material, model units; 0 where the node has no
/// surface within its support radius. The cost does not depend on the size of the body.
double surface_distance(const Body& body, NodeId node);

/// The penalty and the friction of contact_law.h for every node that is beside a flank when the
/// step begins. The plane of a contact is the wedge's face on the node's side, for the whole step.
/// Its depth is that of the surface nearest to the node. Slip is relative to the moving blade.
class BladePenalty : public Potential {
 public:
  /// Adds the contacts of a blade. `blade`: its number, for reaction().
  void add(std::size_t blade, const BladeWedge& wedge, const BladeNodes& nodes);
  /// Whether no node is beside a blade.
  bool empty() const { return contacts_.empty(); }

  /// Number of nodes in contact.
  std::size_t size() const override { return contacts_.size(); }
  /// The node.
  Stencil stencil(std::size_t k) const override { return {&contacts_[k].node, 1}; }
  /// Takes bounds of friction at the substep's begin.
  void begin_substep(const std::vector<Vec3>& u, double from, double to) override;
  /// Takes the bound of friction.
  double begin_iterate(std::size_t k, const Vec3& d) override;
  /// Energy of penalty and friction, J.
  double energy(std::size_t k, const Vec3& d) const override;
  /// Derivatives of penalty and friction.
  Derivatives derivatives(std::size_t k, const Vec3& d) const override;
  /// Force of the material on each of `blades` blades at displacements u, N, with friction.
  std::vector<Vec3> reaction(const std::vector<Vec3>& u, std::size_t blades) const;
  /// Work of the moving blades on the material in the step, by the forces at displacements u, J.
  double work(const std::vector<Vec3>& u) const;

 private:
  struct Contact {
    NodeWeight node;  // with weight 1
    std::size_t blade;
    Vec3 normal;                                 // out of the blade
    double stiffness;                            // N/m
    double offset;                               // depth = offset − normal · u
    double coefficient = 0, regularisation = 0;  // of friction; of its slip, model units
    Vec3 way = Vec3::Zero();                     // of the blade at the node, in the step
    Vec3 stuck = Vec3::Zero();                   // displacement of a node that sticks, at the substep's end
    FrictionMemory memory = {};
    /// Depth of the node's surface beyond the plane, at displacement u of the node; 0 outside.
    double depth(const Vec3& u) const { return std::max(0.0, offset - normal.dot(u)); }
    /// With the bound of this iterate.
    LaggedFriction friction() const { return {coefficient * memory.normal_force, regularisation}; }
    /// Along the plane, since the substep's begin, against the blade.
    Vec3 slip(const Vec3& u) const { return (u - stuck) - normal.dot(u - stuck) * normal; }
  };
  std::vector<Contact> contacts_;
};

}  // namespace geo
