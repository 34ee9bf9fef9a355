// Potential of the springs by which hands hold the bodies: kerf/scene.h's pulls.
#pragma once

#include <cstddef>
#include <vector>

#include "kerf/body.h"
#include "kerf/potential.h"
#include "kerf/scene.h"
#include "kerf/solid.h"

namespace geo {

/// The weights of nodes that give a material point x its displacement by Eq. 1, as seen from
/// `node`: carriers are the node and its neighbours whose supports hold x. Ascending, sum 1.
std::vector<NodeWeight> point_weights(const Body& body, const Solid& solid, NodeId node, const Vec3& x);

/// The node that a pull or a stitch without one is seen from: the nearest of those that the body
/// was built from.
NodeId nearest_original_node(const Body& body, const Vec3& x);

/// The springs E = ½ k |x + u(x) − y|² of the pulls that exist during a time step. The end y moves
/// straight from its place at the step's begin to that at its end.
class PullPotential : public Potential {
 public:
  /// Begins a time step from `time` to `end`, in seconds. Only pulls whose keys span it act.
  void begin_step(const std::vector<Pull>& pulls, const Body& body, const Solid& solid, double time, double end);
  /// Forgets the weights: nodes or neighbours have changed.
  void invalidate() { weights_.clear(); }
  /// Whether no pull acts.
  bool empty() const { return springs_.empty(); }

  /// Moves the ends to share `to` of the time step.
  void begin_substep(const std::vector<Vec3>& u, double from, double to) override;
  /// Number of springs.
  std::size_t size() const override { return springs_.size(); }
  /// The nodes around the point.
  Stencil stencil(std::size_t k) const override { return weights_[springs_[k].pull]; }
  /// A neighbourhood lies in one component.
  bool within_components() const override { return true; }
  /// Springs are.
  bool is_smooth() const override { return true; }
  /// ½ k |stretch|², J.
  double energy(std::size_t k, const Vec3& d) const override;
  /// Derivatives of the spring.
  Derivatives derivatives(std::size_t k, const Vec3& d) const override;
  /// The spring's stiffness, N/m.
  double stiffness_bound(std::size_t k) const override { return springs_[k].stiffness; }
  /// The spring's impulse.
  void apply_impulse(const std::vector<Vec3>& u, double h, const std::vector<double>& inverse_mass,
                     std::vector<Vec3>& velocity) override;

  /// Force of the material on each of `pulls` ends at displacements u, N; zero where none acts.
  std::vector<Vec3> reaction(const std::vector<Vec3>& u, std::size_t pulls) const;
  /// Work of the moving ends on the material in the step, by the forces at displacements u, J.
  double work(const std::vector<Vec3>& u) const;

 private:
  struct Spring {
    std::size_t pull;
    Vec3 point, begin, end, now;  // of the material; the moving end's places
    double stiffness;
    /// From the moving end to the point, at displacement d of the point.
    Vec3 stretch(const Vec3& d) const { return point + d - now; }
  };
  std::vector<Spring> springs_;
  std::vector<std::vector<NodeWeight>> weights_;  // per pull; empty: not known
};

}  // namespace geo
