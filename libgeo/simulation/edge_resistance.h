// The resistance of the material to the edges of blades: it is pushed along until it parts.
#pragma once

#include <span>
#include <vector>

#include "contact/response/relative_stencil.h"
#include "contact/surface/surface_weights.h"
#include "kerf/body.h"
#include "kerf/potential.h"
#include "kerf/scene.h"
#include "kerf/simulation.h"
#include "kerf/solid.h"
#include "simulation/edge_front.h"
#include "simulation/node_loads.h"

namespace geo {

/// How far the edge of a blade with a resistance R is ahead of its front where it cuts: 4 R / E, in
/// model units. A spring that reaches R there is a quarter as stiff as the material, and stiffer
/// ones crumple a soft surface. At least as near as a cut follows an edge, at most half a node
/// spacing. `young`: E, Pa, and `spacing` of the nodes there.
double edge_lead(double resistance, double young, double spacing);

/// A front, and where its edge is now.
struct FrontBehindEdge {
  const EdgeFront& edge;
  std::span<const EdgePoint> run;
};

/// Keeps the next positions `to` of a front behind the edge of a blade with a resistance: by
/// edge_lead(), and where they are, until it is a twentieth of a node spacing farther. A front in
/// air follows its edge to the skin. It stays there until one of its points is to lie a tenth of a
/// spacing deep in the material: shallower cuts are not distinguished from the skin.
void stay_behind(const Body& body, const Solid& solid, double resistance, const FrontBehindEdge& front,
                 std::vector<Vec3>& to);

/// Springs between the edges of blades and the vertices of the fronts that they leave. A spring
/// exerts a force on a vertex, across the edge, of at most R ℓ: R is the blade's resistance, and ℓ
/// the length of front that belongs to the vertex. It reaches that at edge_lead(), where BladeCuts
/// lets the front go on: so an area A takes the work R A. An edge that goes back in its cut exerts
/// nothing. Where the front is in air, springs act on the skin below it, along its normal, once the
/// edge is behind it: so the skin is dented before it parts. Cutting with an energy per area:
/// Atkins and Mai 1985.
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
  /// Number of springs.
  std::size_t size() const override { return springs_.size(); }
  /// The nodes that carry the spring's place of the surface.
  Stencil stencil(std::size_t k) const override { return springs_[k].nodes; }
  /// The nodes that carry a face lie in one component.
  bool within_components() const override { return true; }
  /// Energy of the spring, J: ½ k s² up to its largest force, linear in the stretch s beyond.
  double energy(std::size_t k, const Vec3& d) const override;
  /// Derivatives of this.
  Derivatives derivatives(std::size_t k, const Vec3& d) const override;

 private:
  // A place of the surface, and the place of the edge that belongs to it.
  struct Spring {
    std::size_t blade = 0;
    std::vector<NodeWeight> nodes;  // that carry the place of the surface
    std::uint32_t node = 0;         // the nearest of these
    Vec3 rest, begin, end, now;     // of the surface without displacement; of the edge, world
    Mat3 across = Mat3::Zero();     // takes off the part along the edge; along the skin
    Vec3 inward = Vec3::Zero();     // of the skin: only this way; zero: both
    double limit = 0, lead = 0;     // largest force, N; stretch where it is reached, model units
    /// From the place of the surface at displacement d to the edge, as far as it acts.
    Vec3 stretch(const Vec3& d) const;
  };
  struct FrontInStep;
  Spring spring_at(const FrontInStep& at, const SurfacePoint& on, const Vec3& place) const;
  void add_front(const FrontInStep& at);
  void add_skin_below(const FrontInStep& at);
  Vec3 force(const Spring& s, const Vec3& d) const;

  const Scene& scene_;
  std::vector<Spring> springs_;
  const SurfaceWeights* weights_ = nullptr;
};

}  // namespace geo
