// Bonds that open together cost one update of the body. The bond that would make the surface cross
// itself is found by halving.
#include "simulation/bond_breaker.h"

#include <algorithm>

#include "simulation/next_crack.h"

namespace geo {

BondBreaker::BondBreaker(const Body& body, RunState& state, CrackWriter& writer)
    : body_(body), state_(state), writer_(writer), breaking_(state.glued) {}

bool BondBreaker::any_left() const {
  const auto& bonds = state_.glued.bonds;
  return std::any_of(bonds.begin(), bonds.end(), [](const GluedBond& b) { return !b.broken; });
}

void BondBreaker::step(const Solid& solid, double friction, FrameStats& stats) {
  if (!loads_ || crack_steps_ != body_.crack_steps) {
    loads_.emplace(body_, solid, state_.glued);
    crack_steps_ = body_.crack_steps;
  }
  const auto over = breaking_.overloaded(state_.glued, loads_->at(solid, state_.motion, state_.glued), friction);
  if (!over.empty()) open(over, stats);
}

void BondBreaker::open(std::span<const std::uint32_t> bonds, FrameStats& stats) {
  const TriangleMesh sheet = sheet_of(state_.glued, bonds);
  const std::int32_t crack = next_crack(body_.surface, state_);
  const std::size_t refused = stats.refused;
  const CrackEdit edit = [&](Complex& complex, CrackStats* of_crack) {
    return insert_sheet(complex, sheet, crack, {}, of_crack);
  };
  if (writer_.write(edit, stats)) {
    for (const auto b : bonds) {
      state_.glued.bonds[b].broken = true;
      stats.fracture.broken_area += state_.glued.bonds[b].area;
    }
    stats.fracture.broken += bonds.size();
    return;
  }
  if (bonds.size() == 1) return;
  stats.refused = refused;
  open(bonds.first(bonds.size() / 2), stats);
  open(bonds.subspan(bonds.size() / 2), stats);
}

}  // namespace geo
