#include "simulation/fracture_step.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "kerf/parallel.h"
#include "simulation/fracture_rest.h"
#include "simulation/fracture_start.h"
#include "simulation/fracture_tip.h"
#include "simulation/strength.h"

namespace geo {
namespace {

// What drives each point of a front.
struct Drive {
  std::vector<Vec3> direction;     // unit, across the front
  std::vector<double> excess;      // stress over what the toughness asks for; ≤ 1: none
  std::vector<std::uint8_t> told;  // whether enough nodes see the point for that to be known
  std::uint32_t node = 0;          // of the body that it is in, where any is told
};

double spacing_at(const Body& body, const Vec3& p) {
  const auto nearest = body.grid.nearest(body.nodes.position, p, 1, ~0u, [](auto) { return true; });
  return body.nodes.spacing[nearest.at(0)];
}

double needed_stress(const Strength& own, std::uint64_t seed, const Body& body, const Vec3& x, double h) {
  const double stress = own.toughness > 0 ? stress_of_toughness(own.toughness, h) : own.strength;
  return stress * strength_factor(own, seed, body.surface.extent().diagonal(), x);
}

Drive drive(const FractureOptions& fracture, const std::vector<std::uint32_t>& body_index, const Body& body,
            const Solid& solid, const State& motion, const GrowingFront& g) {
  const std::size_t n = g.size();
  std::vector<Mat3> separation(n, Mat3::Zero());
  std::vector<TipFrame> frame(n);
  std::vector<std::uint8_t> told(n, 0);
  std::vector<std::uint32_t> node(n, 0);
  parallel_for(n, 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      frame[i] = tip_frame(g, i);
      if (!g.live(i) || !may_break(fracture, frame[i].at)) continue;
      const TipField field = tip_field(body, motion.displacement, solid.materials(), frame[i]);
      told[i] = field.nodes >= 4, node[i] = field.node;
      if (!told[i]) continue;
      const auto [angle, stress] = field.strongest();
      if (!(stress > 0)) continue;
      const Vec3 across = std::cos(angle) * frame[i].normal - std::sin(angle) * frame[i].ahead;
      separation[i] =
          stress /
          needed_stress(fracture.at_node(body_index, field.node), fracture.seed, body, frame[i].at, field.support) *
          across * across.transpose();
    }
  });
  // Twice with the weights 1, 2, 1 of neighbours on the same part of the front.
  for (int pass = 0; pass < 2; ++pass) {
    const auto old = separation;
    for (std::size_t i = 0; i < n; ++i) {
      if (!g.live(i)) continue;
      double total = 2;
      separation[i] = 2 * old[i];
      for (const bool after : {false, true}) {
        if (!g.front.closed && (after ? i + 1 == n : i == 0)) continue;
        const std::size_t j = after ? (i + 1) % n : (i + n - 1) % n;
        if (g.live(j)) separation[i] += old[j], total += 1;
      }
      separation[i] /= total;
    }
  }
  Drive d{std::vector<Vec3>(n, Vec3::Zero()), std::vector<double>(n, 0), std::move(told)};
  if (const auto any = std::find(d.told.begin(), d.told.end(), 1); any != d.told.end())
    d.node = node[static_cast<std::size_t>(any - d.told.begin())];
  for (std::size_t i = 0; i < n; ++i) {
    d.direction[i] = frame[i].ahead;
    if (!g.live(i) || separation[i].isZero() || !may_break(fracture, frame[i].at)) continue;
    const Eigen::SelfAdjointEigenSolver<Mat3> eigen(separation[i]);
    d.excess[i] = eigen.eigenvalues()[2];
    // In the new plane, across the front, away from the crack behind.
    const Vec3 tangent = frame[i].normal.cross(frame[i].ahead);
    Vec3 way = tangent.cross(eigen.eigenvectors().col(2));
    if (way.dot(frame[i].ahead) < 0) way = -way;
    if (way.norm() > 0.1) d.direction[i] = way.normalized();
  }
  return d;
}

std::int32_t unused_crack(const Body& body, std::span<const GrowingFront> fronts, std::span<const GrowingFront> more) {
  std::int32_t last = body.surface.crack_count();
  for (const auto& some : {fronts, more})
    for (const auto& g : some) last = std::max(last, g.front.crack);
  return last + 1;
}

// A front whose stress is far more than it needs divides: the two parts leave at 30° to either
// side.
bool divides(const FractureOptions& fracture, const GrowingFront& g, const Drive& d, double spacing,
             const FractureState& state) {
  if (fracture.branching <= 0 || state.cracks >= fracture.max_cracks || g.length < fracture.separation * spacing)
    return false;
  double sum = 0;
  std::size_t live = 0;
  for (std::size_t i = 0; i < g.size(); ++i)
    if (g.live(i)) sum += d.excess[i], ++live;
  return live > 0 && sum > fracture.branching * double(live);
}

void turn(Drive& d, const GrowingFront& g, double angle) {
  for (std::size_t i = 0; i < g.size(); ++i) {
    const TipFrame f = tip_frame(g, i);
    d.direction[i] = Eigen::AngleAxisd(angle, f.along()) * d.direction[i];
  }
}

}  // namespace

void step_fracture(const FractureOptions& fracture, const std::vector<std::uint32_t>& body_index, const Body& body,
                   const Solid& solid, const State& motion, double dt, FractureState& state, const SplitStep& split,
                   FractureStats* work) {
  FractureStats done;
  std::vector<GrowingFront> fronts;
  fronts.swap(state.fronts);
  const auto keep = [&](std::vector<GrowingFront> parts) {
    state.fronts.insert(state.fronts.end(), parts.begin(), parts.end());
  };
  std::vector<std::pair<std::int32_t, Box3>> moves;  // cracks, and where they grew
  const auto make = [&](GrowingFront& g, const Drive& d, std::vector<double>& step, double spacing) {
    const FrontPlan plan = plan_front(body.surface, g, step, d.direction, spacing);
    FrontState moved = with_planned_points(g, plan);
    if (split(moved, plan.next)) {
      ++done.advanced;
      moves.push_back({g.front.crack, {}});
      for (const auto& p : g.front.points) moves.back().second.add(p.position);
      for (const Vec3& p : plan.next) moves.back().second.add(p);
      keep(fronts_after(g, plan, moved, d.direction));
    } else {
      ++done.refused;
      keep({g});
    }
  };
  for (std::size_t f = 0; f < fronts.size(); ++f) {
    GrowingFront& g = fronts[f];
    Drive d = drive(fracture, body_index, body, solid, motion, g);
    const double fastest = fracture.speed * rayleigh_speed(solid.materials().of(d.node));
    std::vector<double> step(g.size(), 0);
    double spacing = std::numeric_limits<double>::infinity(), most = 0;
    bool air = true;  // only parts between points in air are left
    for (std::size_t i = 0; i < g.size(); ++i) {
      if (!g.live(i)) continue;
      air = false;
      const double here = spacing_at(body, g.front.points[i].position);
      spacing = std::min(spacing, here);
      g.owed[i] =
          d.excess[i] > 1 ? std::min(here, g.owed[i] + dt * fastest * (1 - 1 / (d.excess[i] * d.excess[i]))) : 0;
      if (!d.told[i] && may_break(fracture, g.front.points[i].position) &&
          is_ligament(body.surface, tip_frame(g, i), here))
        g.owed[i] = std::max(g.owed[i], 0.25 * here);
      most = std::max(most, g.owed[i]);
    }
    if (air) spacing = spacing_at(body, g.front.points[0].position);
    if (!air && most < 0.25 * spacing) {
      keep({g});
      continue;
    }
    for (std::size_t i = 0; i < g.size(); ++i)
      if (g.live(i) && g.owed[i] > 0.05 * spacing) step[i] = g.owed[i];
    if (!air && divides(fracture, g, d, spacing, state)) {
      GrowingFront branch = g;
      branch.front.crack = unused_crack(body, state.fronts, fronts);
      branch.length = g.length = 0;
      Drive other = d;
      turn(d, g, std::numbers::pi / 6), turn(other, g, -std::numbers::pi / 6);
      ++state.cracks, ++done.divided;
      make(g, d, step, spacing);
      make(branch, other, step, spacing);
    } else {
      make(g, d, step, spacing);
    }
  }
  for (const auto& [crack, where] : moves)
    for (FrontState& rest : left_behind(body.surface, crack, where, state.fronts))
      if (const auto next = across_ligament(body.surface, rest, spacing_at(body, rest.points[0].position));
          !next.empty())
        ++(split(rest, next) ? done.advanced : done.refused);
  const int most = std::min(fracture.cracks_per_step, fracture.max_cracks - state.cracks);
  if (most > 0) {
    const auto stress = averaged_stress(body, solid, motion);
    for (const CrackStart& s : find_starts(body, stress, fracture, body_index, static_cast<std::size_t>(most))) {
      const double spacing = body.nodes.spacing[s.node.index()];
      // Off the node, which would lie in the flaw else.
      auto [g, plan] = plan_flaw(body.surface, body.nodes.position[s.node.index()] + 0.05 * spacing * s.normal,
                                 s.normal, spacing, unused_crack(body, state.fronts, {}));
      FrontState moved = with_planned_points(g, plan);
      if (!split(moved, plan.next)) {
        ++done.refused;
        continue;
      }
      ++state.cracks, ++done.begun;
      keep(fronts_after(g, plan, moved, {}));
    }
  }
  if (work)
    work->begun += done.begun, work->divided += done.divided, work->advanced += done.advanced,
        work->refused += done.refused;
}

}  // namespace geo
