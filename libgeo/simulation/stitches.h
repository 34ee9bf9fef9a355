// Potential of the threads that sew two places of the bodies together: kerf/scene.h's stitches.
#pragma once

#include <cstddef>
#include <vector>

#include "kerf/body.h"
#include "kerf/potential.h"
#include "kerf/scene.h"
#include "kerf/solid.h"

namespace geo {

/// How far the ends of a stitch are apart at displacements u of the nodes, model units. Throws
/// InputError for a node that does not exist.
double distance_of_ends(const Stitch& stitch, const Body& body, const Solid& solid, const std::vector<Vec3>& u);

/// The threads E = ½ k max(0, |r| − L)² of the stitches that exist during a time step. r is from
/// one end to the other, and L the rest length, which changes linearly in the step.
class StitchPotential : public Potential {
 public:
  /// Begins a time step from `time` to `end`, in seconds. Only stitches that span it act.
  void begin_step(const std::vector<Stitch>& stitches, const Body& body, const Solid& solid, double time, double end);
  /// Forgets the weights: nodes or neighbours have changed.
  void invalidate() { weights_.clear(); }
  /// Whether no stitch exists.
  bool empty() const { return threads_.empty(); }

  /// Takes the rest lengths at share `to` of the time step.
  void begin_substep(const std::vector<Vec3>& u, double from, double to) override;
  /// Number of threads.
  std::size_t size() const override { return threads_.size(); }
  /// The nodes around both ends.
  Stencil stencil(std::size_t k) const override { return weights_[threads_[k].stitch]; }
  /// ½ k times the squared stretch, J.
  double energy(std::size_t k, const Vec3& d) const override;
  /// Derivatives of this.
  Derivatives derivatives(std::size_t k, const Vec3& d) const override;
  /// The thread's stiffness, N/m.
  double stiffness_bound(std::size_t k) const override { return threads_[k].stiffness; }
  /// The thread's impulse.
  void apply_impulse(const std::vector<Vec3>& u, double h, const std::vector<double>& inverse_mass,
                     std::vector<Vec3>& velocity) override;

  /// Tension of each of `stitches` threads at displacements u, N; zero where none acts.
  std::vector<double> tension(const std::vector<Vec3>& u, std::size_t stitches) const;
  /// Work in the step of the hand that draws the threads tight, by the tension at displacements u,
  /// J.
  double work(const std::vector<Vec3>& u) const;

 private:
  struct Thread {
    std::size_t stitch;
    Vec3 apart;              // from the second end to the first, at rest
    double begin, end, now;  // rest lengths
    double stiffness;
    /// How much longer it is than at rest, at relative displacement d of its ends; not negative.
    double stretch(const Vec3& d) const;
    /// The force on the first end.
    Vec3 force(const Vec3& d) const;
  };
  std::vector<Thread> threads_;
  std::vector<std::vector<NodeWeight>> weights_;  // per stitch; empty: not known
};

}  // namespace geo
