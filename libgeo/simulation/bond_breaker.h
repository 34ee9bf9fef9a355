// Glued bonds of a run, which break under their loads.
#pragma once

#include <cstdint>
#include <map>
#include <span>

#include "kerf/simulation.h"
#include "simulation/bond_breaking.h"
#include "simulation/bond_loads.h"
#include "simulation/crack_writer.h"

namespace geo {

/// Opens the walls of overloaded bonds. Refers to the body, its state and the writer.
class BondBreaker {
 public:
  /// The bonds are those of `state`, as they are now.
  BondBreaker(const Body& body, RunState& state, CrackWriter& writer);

  /// Whether there are bonds, broken or not.
  bool any() const { return !state_.glued.bonds.empty(); }
  /// Whether any bond holds.
  bool any_left() const;
  /// Whether a time step of dt seconds from `before` to the present motion is too long for what
  /// breaks in it: a bond is overloaded at its end, or a piece with bonds has been struck so hard
  /// that a wave would break them (ρ c |Δv|, with the velocity's change Δv but for gravity), where
  /// the step is longer than shortest_step(). `solid`: with its points up to date; `friction`:
  /// between the sides of a wall.
  bool is_too_long(const Solid& solid, const State& before, const Vec3& gravity, double friction, double dt);
  /// The length below which no step is too long, s: a pressure wave runs through half a wall in it,
  /// and a wall that opens unloads its neighbours at that speed. Infinite without bonds; it does
  /// not change when they break.
  double shortest_step(const Solid& solid) const;
  /// Opens the walls of all bonds that break in a time step of dt seconds, as one crack. Where that
  /// is refused, each half of them, down to one bond, which is counted as refused and tried again
  /// in the next step. Where some have broken, pieces that are joined by less than a node's share
  /// of area part as well: h², with h the finest spacing. `solid`: with its points up to date;
  /// `friction`: between the sides of a wall.
  void step(const Solid& solid, double friction, double dt, FrameStats& stats);

 private:
  void open(std::span<const std::uint32_t> bonds, const Solid& solid, double dt, FrameStats& stats);
  const Material& material_of(std::uint32_t of, const Solid& solid) const;
  void find_loads(const Solid& solid);
  std::vector<double> ratios(const Solid& solid, double friction) const;
  bool is_struck(const Solid& solid, const State& before, const Vec3& gravity, double dt) const;

  const Body& body_;
  RunState& state_;
  CrackWriter& writer_;
  BondBreaking breaking_;
  BondLoads loads_;
  std::map<std::uint32_t, std::uint32_t> first_node_;  // by body of the scene
  std::vector<std::uint32_t> node_;                    // per bond: the nearest
  std::uint32_t crack_steps_ = ~0u;                    // of the body, when loads_ and node_ were found
};

}  // namespace geo
