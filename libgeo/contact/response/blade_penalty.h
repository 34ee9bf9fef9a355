// What a thick blade does: behind its edge the material has to make way (§ 5.1 leaves it to the
// contact of objects).
#pragma once

#include <vector>

#include "kerf/scene.h"
#include "mechanics/terms/potential.h"

namespace geo {

/// Nodes beside the flanks of blades, each before a plane through the edge: an energy ½ m k d²
/// where the material that the node stands for is d beyond it, as with the ground. Made anew for
/// each time step, by the sides that nodes are on.
class BladePenalty : public Potential {
 public:
  /// Adds the nodes that a blade at `pose` has beside it. `x`, `u`, `clearance` (how far the
  /// material goes around each), `mass`: per node. `stiffness`: acceleration per depth, 1/s².
  void add(std::size_t blade, const Blade& shape, const Pose& pose, const std::vector<Vec3>& x,
           const std::vector<Vec3>& u, const std::vector<double>& clearance, const std::vector<double>& mass,
           double stiffness);
  bool empty() const { return contacts_.empty(); }

  std::size_t size() const override { return contacts_.size(); }
  Stencil stencil(std::size_t k) const override { return {&contacts_[k].at, 1}; }
  double energy(std::size_t k, const Vec3& d) const override;
  Derivatives derivatives(std::size_t k, const Vec3& d) override;
  /// What the material does to each of so many blades at displacements u, N.
  std::vector<Vec3> reaction(const std::vector<Vec3>& u, std::size_t blades) const;

 private:
  struct Contact {
    NodeWeight at;  // the node, 1
    std::size_t blade;
    Vec3 normal;       // out of the blade
    double stiffness;  // N/m
    double offset;     // depth = offset − normal · u
    double depth(const Vec3& u) const { return std::max(0.0, offset - normal.dot(u)); }
  };
  std::vector<Contact> contacts_;
};

}  // namespace geo
