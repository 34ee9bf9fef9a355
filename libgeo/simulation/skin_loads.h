// Potential of what acts on the skin: the tractions and the supports of kerf/scene.h.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "contact/surface/surface_weights.h"
#include "kerf/body.h"
#include "kerf/potential.h"
#include "kerf/scene.h"
#include "kerf/solid.h"
#include "simulation/node_loads.h"

namespace geo {

/// Dead loads E = −a p · d of tractions p on the area a of a vertex, and springs of supports, E = ½
/// k a |x + d − y|² along their axes, as stiff as a layer of material a hundredth of a node spacing
/// thick. So a support yields by a hundredth of what the material between two nodes does.
class SkinLoads : public Potential {
 public:
  /// Throws InputError where a box of the scene holds no triangle of the skin: a load would do
  /// nothing. Refers to the scene.
  SkinLoads(const Scene& scene, const Body& body);

  /// Whether the scene has tractions or supports.
  bool any() const { return !scene_.loads.empty() || !scene_.supports.empty(); }
  /// Begins a time step. `weights`: of the body's surface, up to date, until the step's end.
  void begin_step(const TimeStep& step, const Body& body, const Solid& solid, const SurfaceWeights& weights);
  /// Ends a time step at displacements u, whose `share` of a frame it is: adds work and forces.
  void end_step(const std::vector<Vec3>& u, double share, FrameStats& stats) const;
  /// Whether nothing acts in this time step.
  bool empty() const { return acting_.empty(); }

  /// Loads and places of supports at share `to` of the time step.
  void begin_substep(const std::vector<Vec3>& u, double from, double to) override;
  /// Number of vertices, once for each load.
  std::size_t size() const override { return acting_.size(); }
  /// The nodes that carry the vertex.
  Stencil stencil(std::size_t k) const override { return weights_->stencil(acting_[k].vertex); }
  /// The nodes that carry a vertex lie in one component.
  bool within_components() const override { return true; }
  /// Dead loads and springs are.
  bool is_smooth() const override { return true; }
  /// −a p · d, or ½ k a |x + d − y|², J.
  double energy(std::size_t k, const Vec3& d) const override;
  /// Derivatives of these.
  Derivatives derivatives(std::size_t k, const Vec3& d) const override;
  /// The stiffness of a support, N/m.
  double stiffness_bound(std::size_t k) const override { return acting_[k].stiffness; }
  /// The impulse of the load.
  void apply_impulse(const std::vector<Vec3>& u, double h, const std::vector<double>& inverse_mass,
                     std::vector<Vec3>& velocity) override;

 private:
  // A vertex that a load acts on: of the tractions, then of the supports.
  struct Term {
    std::size_t load;
    std::uint32_t vertex;
    double area;       // of the skin in the box that belongs to the vertex, model units²
    double stiffness;  // of a support, N/m
    Vec3 before;       // displacement of the vertex at the begin of the step
  };
  // A load in a time step.
  struct Action {
    bool is_support = false, acts = false;
    Vec3 begin = Vec3::Zero(), end = Vec3::Zero(), now = Vec3::Zero();  // Pa, or the way of a support
  };
  static void find_terms(const Body& body, const Vec3& lo, const Vec3& hi, std::size_t load, std::vector<Term>& terms);
  void find_all(const Body& body);
  Action load_in(const Load& load, const TimeStep& step) const;
  Action support_in(const Support& support, const TimeStep& step) const;
  const Support::Axes& axes_of(std::size_t load) const { return scene_.supports[load - scene_.loads.size()].axes; }
  Vec3 force(const Term& term, const Vec3& d) const;
  Vec3 displacement(const Term& term, const std::vector<Vec3>& u) const;

  const Scene& scene_;
  std::vector<Term> terms_, acting_;  // of all loads; of those that act in this step
  std::vector<Action> actions_;
  const SurfaceWeights* weights_ = nullptr;
  std::uint32_t crack_steps_ = ~0u;  // of the body, when terms_ were found
};

}  // namespace geo
