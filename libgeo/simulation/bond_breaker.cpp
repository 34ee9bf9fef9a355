// Bonds that open together cost one update of the body. The bond that would make the surface cross
// itself is found by halving.
#include "simulation/bond_breaker.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "body/incremental_cache.h"
#include "mechanics/solver/solid_discretisation.h"
#include "simulation/cohesive_walls.h"
#include "simulation/next_crack.h"
#include "simulation/strength.h"

namespace geo {

BondBreaker::BondBreaker(const Body& body, RunState& state, CrackWriter& writer)
    : body_(body), state_(state), writer_(writer), breaking_(state.glued) {
  for (std::uint32_t i = 0; i < state.body_index.size(); ++i) first_node_.try_emplace(state.body_index[i], i);
}

bool BondBreaker::any_left() const {
  const auto& bonds = state_.glued.bonds;
  return std::any_of(bonds.begin(), bonds.end(), [](const GluedBond& b) { return !b.broken; });
}

void BondBreaker::find_loads(const Solid& solid) {
  if (crack_steps_ == body_.crack_steps) return;
  loads_.update(body_, solid, state_.glued);
  node_.clear();
  for (const GluedBond& bond : state_.glued.bonds)
    node_.push_back(
        body_.cache->grid.nearest(body_.nodes.position, bond.centroid, 1, ~0u, [](std::uint32_t) { return true; })[0]);
  crack_steps_ = body_.crack_steps;
}

std::vector<double> BondBreaker::ratios(const Solid& solid, double friction) const {
  return breaking_.ratios(state_.glued, loads_.at(solid, state_.motion, state_.glued), friction);
}

void BondBreaker::step(const Solid& solid, double friction, double dt, FrameStats& stats) {
  find_loads(solid);
  const std::size_t before = stats.fracture.broken;
  const auto over = breaking_.overloaded(ratios(solid, friction));
  if (!over.empty()) open(over, solid, dt, stats);
  if (stats.fracture.broken == before) return;
  const auto thin = breaking_.ligaments(state_.glued, body_.finest_spacing * body_.finest_spacing);
  if (!thin.empty()) open(thin, solid, dt, stats);
}

bool BondBreaker::is_too_long(const Solid& solid, const State& before, const Vec3& gravity, double friction,
                              double dt) {
  if (dt <= shortest_step(solid)) return false;
  find_loads(solid);
  const std::vector<double> ratio = ratios(solid, friction);
  return std::any_of(ratio.begin(), ratio.end(), [](double r) { return r > 1; }) ||
         is_struck(solid, before, gravity, dt);
}

// Walls are as wide as the root of their mean area in a body.
double BondBreaker::shortest_step(const Solid& solid) const {
  std::map<std::uint32_t, std::pair<double, std::size_t>> areas;  // per body: sum and number
  for (const GluedBond& bond : state_.glued.bonds) {
    areas[bond.body].first += bond.area;
    ++areas[bond.body].second;
  }
  double shortest = std::numeric_limits<double>::infinity();
  for (const auto& [body, area] : areas) {
    const double width = std::sqrt(area.first / double(area.second));
    shortest = std::min(shortest, 0.5 * width / pressure_wave_speed(material_of(body, solid)));
  }
  return shortest;
}

// By how much the velocity of a component of the graph has changed in the step: of one that falls
// freely or is at rest on others, not at all.
bool BondBreaker::is_struck(const Solid& solid, const State& before, const Vec3& gravity, double dt) const {
  const auto& component = SolidDiscretisation::of(solid).component;
  std::vector<Vec3> gained(SolidDiscretisation::of(solid).components, Vec3::Zero());
  std::vector<double> mass(gained.size(), 0);
  for (std::size_t i = 0; i < component.size(); ++i) {
    const double m = solid.mass(NodeId(static_cast<std::uint32_t>(i)));
    gained[component[i]] += m * (state_.motion.velocity[i] - before.velocity[i]);
    mass[component[i]] += m;
  }
  const auto change = [&](std::uint32_t c) {
    const Vec3 velocity = gained[c] / mass[c];
    return std::min(velocity.norm(), (velocity - dt * gravity).norm());
  };
  for (std::size_t b = 0; b < node_.size(); ++b) {
    const GluedBond& bond = state_.glued.bonds[b];
    if (bond.broken) continue;
    const auto c = component[node_[b]];
    const Material& material = material_of(bond.body, solid);
    const double stress = material.density * pressure_wave_speed(material) * change(c);
    if (stress > breaking_.limit(state_.glued, static_cast<std::uint32_t>(b))) return true;
  }
  return false;
}

// All nodes of a body of the scene have the same material.
const Material& BondBreaker::material_of(std::uint32_t of, const Solid& solid) const {
  const auto node = first_node_.find(of);
  return solid.materials().of(node == first_node_.end() ? 0 : node->second);
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
                                     material_of(state_.glued.bonds[b].body, solid), dt));
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
