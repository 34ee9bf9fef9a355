// Bonds that open together cost one update of the body. The bond that would make the surface cross
// itself is found by halving.
#include "simulation/bond_breaker.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "simulation/cohesive_walls.h"
#include "simulation/next_crack.h"

namespace geo {

BondBreaker::BondBreaker(const Body& body, RunState& state, CrackWriter& writer)
    : body_(body), state_(state), writer_(writer), breaking_(state.glued) {}

bool BondBreaker::any_left() const {
  const auto& bonds = state_.glued.bonds;
  return std::any_of(bonds.begin(), bonds.end(), [](const GluedBond& b) { return !b.broken; });
}

void BondBreaker::step(const Solid& solid, double friction, double dt, FrameStats& stats) {
  if (crack_steps_ != body_.crack_steps) loads_.update(body_, solid, state_.glued);
  crack_steps_ = body_.crack_steps;
  const auto ratio = breaking_.ratios(state_.glued, loads_.at(solid, state_.motion, state_.glued), friction);
  const double load = ratio.empty() ? 0 : *std::max_element(ratio.begin(), ratio.end());
  state_.glued.loading = (load - state_.glued.load) / dt;
  state_.glued.load = load;
  const std::size_t before = stats.fracture.broken;
  const auto over = breaking_.overloaded(ratio);
  if (!over.empty()) open(over, solid, dt, stats);
  if (stats.fracture.broken == before) return;
  const auto thin = breaking_.ligaments(state_.glued, body_.finest_spacing * body_.finest_spacing);
  if (!thin.empty()) open(thin, solid, dt, stats);
}

int BondBreaker::division(const Solid& solid, double dt, int most) const {
  const GluedBonds& glued = state_.glued;
  if (glued.load + std::max(0.0, glued.loading) * dt < 1) return 1;
  double shortest = dt;
  std::map<std::uint32_t, std::pair<double, std::size_t>> areas;  // per body: sum and number
  for (const GluedBond& bond : glued.bonds) {
    areas[bond.body].first += bond.area;
    ++areas[bond.body].second;
  }
  for (const GluedBond& bond : glued.bonds) {
    const auto found = areas.find(bond.body);
    if (found == areas.end()) continue;
    const auto [area, count] = found->second;
    areas.erase(found);
    const Material& m = material_of(bond, solid);
    const double speed = std::sqrt((m.lambda() + 2 * m.mu()) / m.density);
    shortest = std::min(shortest, 0.5 * std::sqrt(area / double(count)) / speed);
  }
  return static_cast<int>(std::min<double>(most, std::ceil(dt / shortest)));
}

// All nodes of a body of the scene have the same material.
const Material& BondBreaker::material_of(const GluedBond& bond, const Solid& solid) const {
  const auto& body = state_.body_index;
  const auto node = static_cast<std::size_t>(std::find(body.begin(), body.end(), bond.body) - body.begin());
  return solid.materials()[solid.materials().index(node < body.size() ? node : 0)];
}

void BondBreaker::open(std::span<const std::uint32_t> bonds, const Solid& solid, double dt, FrameStats& stats) {
  const TriangleMesh sheet = sheet_of(state_.glued, bonds);
  const std::int32_t crack = next_crack(body_.surface, state_);
  const std::size_t refused = stats.refused;
  const CrackEdit edit = [&](Complex& complex, CrackStats* of_crack) {
    return insert_sheet(complex, sheet, crack, {}, of_crack);
  };
  if (writer_.write(edit, stats)) {
    std::vector<CohesiveLaw> laws;  // before any of them is broken: each limits its neighbours
    for (const auto b : bonds)
      laws.push_back(CohesiveLaw::of(state_.glued.bonds[b], breaking_.limit(state_.glued, b),
                                     material_of(state_.glued.bonds[b], solid), dt));
    for (std::size_t i = 0; i < bonds.size(); ++i) {
      GluedBond& bond = state_.glued.bonds[bonds[i]];
      bond.broken = true;
      stats.fracture.broken_area += bond.area;
      if (laws[i].opening > 0)
        bond.cohesion = {.crack = crack,
                         .peak = laws[i].peak,
                         .opening = laws[i].opening,
                         .reached = std::vector<double>(bond.faces.size(), laws[i].first())};
    }
    stats.fracture.broken += bonds.size();
    return;
  }
  if (bonds.size() == 1) return;
  stats.refused = refused;
  open(bonds.first(bonds.size() / 2), solid, dt, stats);
  open(bonds.subspan(bonds.size() / 2), solid, dt, stats);
}

}  // namespace geo
