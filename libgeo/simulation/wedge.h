// What a thick blade does: behind its edge the material has to make way (§ 5.1 leaves it to the contact of objects).
#pragma once

#include <vector>

#include "mechanics/potential.h"
#include "simulation/scene.h"

namespace geo {

/// Nodes beside the flanks of blades, each before a plane through the edge: an energy ½ m k d² where the material that the
/// node stands for is d beyond it, as with the ground. Made anew for each time step, by the sides that nodes are on.
class Wedge : public Potential {
 public:
  /// Adds the nodes that a blade at `pose` has beside it. `x`, `u`, `clearance` (how far the material goes around each), `mass`:
  /// per node. `stiffness`: acceleration per depth, 1/s².
  void add(std::size_t blade, const Blade& shape, const Pose& pose, const std::vector<Vec3>& x, const std::vector<Vec3>& u,
           const std::vector<double>& clearance, const std::vector<double>& mass, double stiffness);
  bool empty() const { return contacts_.empty(); }

  void each_row(const VisitRow& visit) const override;
  void add_energy(const std::vector<Vec3>& u, std::span<const std::uint32_t> part, std::vector<double>& sum) const override;
  void force(const std::vector<Vec3>& u, std::vector<Vec3>& out) override;
  /// What the material does to each of so many blades at displacements u, N.
  std::vector<Vec3> reaction(const std::vector<Vec3>& u, std::size_t blades) const;

 private:
  struct Contact {
    NodeWeight at;      // the node, 1
    std::size_t blade;
    Vec3 normal;        // out of the blade
    double stiffness;   // N/m
    double offset;      // depth = offset − normal · u
    bool deep = false;  // at the last force()
    double depth(const std::vector<Vec3>& u) const { return offset - normal.dot(u[at.node]); }
  };
  std::vector<Contact> contacts_;
};

}  // namespace geo
