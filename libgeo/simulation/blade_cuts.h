// The cuts of blades (§ 5.1): the runs of their edges in the material, and the fronts that these
// leave.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "kerf/body.h"
#include "kerf/scene.h"
#include "kerf/simulation.h"
#include "simulation/blade_way.h"
#include "simulation/crack_writer.h"
#include "simulation/edge_front.h"
#include "simulation/front_anchor.h"

namespace geo {

/// Moves the fronts of blades through time steps that the nodes have made. Refers to all that it is
/// made of.
class BladeCuts {
 public:
  /// `state`: its fronts, a list for each blade, are those between two steps.
  BladeCuts(const Scene& scene, const Body& body, RunState& state, CrackWriter& writer);

  /// Whether a blade cuts in a time step that begins then.
  bool any_at(double time) const;
  /// Forgets the fronts of blades that do not cut in a time step that begins then.
  void drop_idle(double time);
  /// Plans the first cut of the first blade that cuts, and begins its first crack: changes the
  /// body's complex. It may run beside work that reads the nodes alone.
  void begin_first(const MovedBody& moved, FrameStats& stats);
  /// Makes all cuts of the time step, from the one that has begun.
  void make_all(const MovedBody& moved, FrameStats& stats);

 private:
  // A front and its next position.
  struct Advance {
    bool rests = false;           // the edge is where the front is: nothing is cut
    EdgeFront edge;               // with a point for each of `to`
    std::vector<Vec3> to;         // material positions
    std::vector<double> spacing;  // of the nodes there, model units
    double deviation = 0;         // see sheet_deviation()
    std::size_t retreating = 0;   // points of `to` that hold_retreating() held
    bool has_begun = false;
    std::optional<BegunCrack> crack;  // once begun; none: it is refused
  };
  // A cut by a blade: its runs in the material, and the advance of each.
  struct PlannedCut {
    std::vector<std::vector<EdgePoint>> runs;
    std::vector<Advance> advances;
  };
  // The first cut of the first blade that cuts in a time step.
  struct FirstCut {
    std::size_t blade;
    int cuts;  // by this blade in the step
    PlannedCut plan;
  };

  int begin_blade(const MovedBody& moved, std::size_t blade);
  std::vector<std::vector<EdgePoint>> map_edge(const MovedBody& moved, std::size_t blade, double fraction,
                                               double before);
  PlannedCut plan_cut(const MovedBody& moved, std::size_t blade, int k, int cuts);
  Advance plan_advance(const EdgeFront& front, std::span<const EdgePoint> run, const MapAt& half, const Blade& blade,
                       const FrontAnchor& anchor, const Solid& solid) const;
  void begin(Advance& advance, FrameStats& stats);
  void make_cut(std::size_t blade, PlannedCut plan, FrameStats& stats);

  const Scene& scene_;
  const Body& body_;
  RunState& state_;
  CrackWriter& writer_;
  std::optional<FirstCut> first_;  // between begin_first() and make_all()
};

}  // namespace geo
