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

namespace geo {

/// A blade where it is at the end of a step. Its flanks are the parallelograms of edge segments and
/// `back`.
struct BladeWedge {
  std::vector<Vec3> edge;    ///< points of the cutting edge, world
  bool closed = false;       ///< the last point is followed by the first
  Vec3 back = Vec3::Zero();  ///< from the edge to the back of the blade, world
  double thickness = 0;      ///< at the back, model units
  double stiffness = 0;      ///< acceleration over depth, 1/s²
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

/// The penalty of contact_law.h, without friction, for every node that is beside a flank when the
/// step begins. The plane of a contact is the wedge's face on the node's side, for the whole step.
/// Its depth is that of the surface nearest to the node.
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
  /// Energy of the penalty, J.
  double energy(std::size_t k, const Vec3& d) const override;
  /// Derivatives of the penalty.
  Derivatives derivatives(std::size_t k, const Vec3& d) const override;
  /// Force of the material on each of `blades` blades at displacements u, N.
  std::vector<Vec3> reaction(const std::vector<Vec3>& u, std::size_t blades) const;

 private:
  struct Contact {
    NodeWeight node;  // with weight 1
    std::size_t blade;
    Vec3 normal;       // out of the blade
    double stiffness;  // N/m
    double offset;     // depth = offset − normal · u
    /// Depth of the node's surface beyond the plane, at displacement u of the node; 0 outside.
    double depth(const Vec3& u) const { return std::max(0.0, offset - normal.dot(u)); }
  };
  std::vector<Contact> contacts_;
};

}  // namespace geo
