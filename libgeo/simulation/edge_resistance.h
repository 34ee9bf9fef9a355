// The resistance of the material to the edges of blades: it is pushed along until it parts.
#pragma once

#include <vector>

#include "contact/surface/surface_weights.h"
#include "kerf/body.h"
#include "kerf/potential.h"
#include "kerf/scene.h"
#include "kerf/simulation.h"
#include "kerf/solid.h"
#include "simulation/edge_front.h"
#include "simulation/node_loads.h"

namespace geo {

/// How far the edge of a blade with a resistance is ahead of its front where it cuts, in node
/// spacings: as near as a cut follows an edge.
constexpr double edge_lead = resolved_by_front;

/// Springs between the edges of blades and the vertices of the fronts that they leave. A spring
/// exerts a force on a vertex, across the edge, of at most R ℓ: R is the blade's resistance, and ℓ
/// the length of front that belongs to the vertex. It reaches that at edge_lead, where BladeCuts
/// lets the front go on: so an area A takes the work R A. An edge that goes back in its cut exerts
/// nothing. Cutting with an energy per area: Atkins and Mai 1985.
class EdgeResistance : public Potential {
 public:
  /// Refers to the scene.
  explicit EdgeResistance(const Scene& scene) : scene_(scene) {}

  /// Whether a blade with a resistance exists in a time step that begins then.
  bool any_at(double time) const;
  /// Begins a time step. `weights`: of the body's surface, up to date, until the step's end.
  void begin_step(const TimeStep& step, const Body& body, const Solid& solid, const RunState& state,
                  const SurfaceWeights& weights);
  /// Ends a time step at displacements u, whose `share` of a frame it is: adds work and forces.
  void end_step(const std::vector<Vec3>& u, double share, FrameStats& stats) const;
  /// Whether nothing acts in this time step.
  bool empty() const { return springs_.empty(); }

  /// Places of the edges at share `to` of the time step.
  void begin_substep(const std::vector<Vec3>& u, double from, double to) override;
  /// Number of vertices of fronts.
  std::size_t size() const override { return springs_.size(); }
  /// The nodes that carry the vertex.
  Stencil stencil(std::size_t k) const override { return weights_->stencil(springs_[k].vertex); }
  /// The nodes that carry a vertex lie in one component.
  bool within_components() const override { return true; }
  /// Energy of the spring, J: ½ k s² up to its largest force, linear in the stretch s beyond.
  double energy(std::size_t k, const Vec3& d) const override;
  /// Derivatives of this.
  Derivatives derivatives(std::size_t k, const Vec3& d) const override;

 private:
  // A vertex of a front, and the place of the edge that belongs to it.
  struct Spring {
    std::size_t blade;
    std::uint32_t vertex;
    Vec3 rest, begin, end, now;  // of the vertex without displacement; of the edge, world
    Mat3 across;                 // takes off the part along the edge
    double limit, lead;          // largest force, N; stretch where it is reached, model units
    /// From the vertex at displacement d to the edge, across the edge.
    Vec3 stretch(const Vec3& d) const { return across * (now - rest - d); }
  };
  struct FrontInStep;
  void add_front(const FrontInStep& at);
  Vec3 force(const Spring& s, const Vec3& d) const;

  const Scene& scene_;
  std::vector<Spring> springs_;
  const SurfaceWeights* weights_ = nullptr;
};

}  // namespace geo
