// Glued bonds of a run, which break under their loads.
#pragma once

#include <cstdint>
#include <optional>
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

  /// Whether any bond holds.
  bool any_left() const;
  /// Opens the walls of all bonds that break now, as one crack. Where that is refused, each half of
  /// them, down to one bond, which is counted as refused and tried again in the next step. `solid`:
  /// with its points up to date; `friction`: between the sides of a wall.
  void step(const Solid& solid, double friction, FrameStats& stats);

 private:
  void open(std::span<const std::uint32_t> bonds, FrameStats& stats);

  const Body& body_;
  RunState& state_;
  CrackWriter& writer_;
  BondBreaking breaking_;
  std::optional<BondLoads> loads_;
  std::uint32_t crack_steps_ = 0;  // of the body, when loads_ were found
};

}  // namespace geo
