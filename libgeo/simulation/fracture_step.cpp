// Crack speed v = c_max (1 − (σ_c / σ)²) along the direction of the largest hoop stress. Ratio σ /
// σ_c and direction are smoothed together, as the tensor (σ / σ_c) n nᵀ with n the plane's normal.
#include "simulation/fracture_step.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/elementary.h"
#include "body/incremental_cache.h"
#include "geometry/rotation.h"
#include "kerf/parallel.h"
#include "simulation/fracture_ligaments.h"
#include "simulation/fracture_start.h"
#include "simulation/fracture_tip.h"
#include "simulation/interaction_integral.h"
#include "simulation/strength.h"

namespace geo {
namespace {

// In spacings. A front moves once a point owes the first; points that owe less than the second
// wait. Smaller: more steps, with faces that nodes do not resolve.
constexpr double least_growth = 0.25, least_point_growth = 0.05;
// Least number of nodes for a stress field around a point.
constexpr std::size_t least_nodes = 4;

// The load on each point of a front.
struct FrontLoad {
  std::vector<Vec3> direction;         // of growth: unit, across the front
  std::vector<double> ratio;           // of stress to resistance; ≤ 1: no growth
  std::vector<std::uint8_t> resolved;  // 1 where enough nodes see the point for its stress
  std::uint32_t node = 0;              // in the body of the front, where any point is resolved
};

double spacing_at(const Body& body, const Vec3& p) {
  const auto nearest = body.cache->grid.nearest(body.nodes.position, p, 1, ~0u, [](auto) { return true; });
  return body.nodes.spacing[nearest.at(0)];
}

// Stress at x, averaged over h ahead of a front, at which a crack grows.
double resistance(const Strength& own, std::uint64_t seed, const Body& body, const Vec3& x, double h) {
  const double stress = own.toughness > 0 ? stress_of_toughness(own.toughness, h) : own.strength;
  return stress * strength_factor(own, seed, body.surface.extent().diagonal(), x);
}

// Averages values along the front twice: (v_i−1 + 2 v_i + v_i+1) / 4, live neighbours only.
template <class Value>
void smooth_along(const GrowingFront& g, std::vector<Value>& value) {
  const std::size_t n = g.size();
  for (int pass = 0; pass < 2; ++pass) {
    const auto old = value;
    for (std::size_t i = 0; i < n; ++i) {
      if (!g.live(i)) continue;
      double total = 2;
      value[i] = 2 * old[i];
      for (const bool after : {false, true}) {
        if (!g.front.closed && (after ? i + 1 == n : i == 0)) continue;
        const std::size_t j = after ? (i + 1) % n : (i + n - 1) % n;
        if (g.live(j)) {
          value[i] += old[j];
          total += 1;
        }
      }
      value[i] /= total;
    }
  }
}

FrontLoad load_on(const FractureInput& in, const GrowingFront& g) {
  const std::size_t n = g.size();
  std::vector<Mat3> separation(n, Mat3::Zero());  // ratio · n nᵀ, n the normal of the plane of largest hoop stress
  std::vector<TipFrame> frame(n);
  std::vector<std::uint8_t> resolved(n, 0);
  std::vector<std::uint32_t> node(n, 0);
  const InteractionIntegral integral(in.body, in.solid, in.motion);
  parallel_for(n, 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      frame[i] = tip_frame(g, i);
      if (!g.live(i) || !may_break(in.options, frame[i].at)) continue;
      const TipField field = tip_field(in.body, in.motion.displacement, in.solid.materials(), frame[i],
                                       [&](const Mat3& rotation) { return integral.at(g, i, rotation); });
      resolved[i] = field.nodes >= least_nodes;
      node[i] = field.node;
      if (!resolved[i]) continue;
      const auto [angle, stress] = field.strongest();
      if (!(stress > 0)) continue;
      const Vec3 across = cosine(angle) * frame[i].normal - sine(angle) * frame[i].ahead;
      separation[i] = stress /
                      resistance(in.options.at_node(in.body_index, field.node), in.options.seed, in.body, frame[i].at,
                                 field.support) *
                      across * across.transpose();
    }
  });
  smooth_along(g, separation);
  FrontLoad load{.direction = std::vector<Vec3>(n, Vec3::Zero()),
                 .ratio = std::vector<double>(n, 0),
                 .resolved = std::move(resolved)};
  if (const auto any = std::find(load.resolved.begin(), load.resolved.end(), 1); any != load.resolved.end())
    load.node = node[static_cast<std::size_t>(any - load.resolved.begin())];
  for (std::size_t i = 0; i < n; ++i) {
    load.direction[i] = frame[i].ahead;
    if (!g.live(i) || separation[i].isZero() || !may_break(in.options, frame[i].at)) continue;
    const Eigen::SelfAdjointEigenSolver<Mat3> eigen(separation[i]);
    load.ratio[i] = eigen.eigenvalues()[2];
    // In the new plane, across the front, away from the crack behind. Where that plane is within
    // 6° of normal to the front (|ahead| ≤ 0.1), the old direction stays.
    const Vec3 tangent = frame[i].normal.cross(frame[i].ahead);
    Vec3 ahead = tangent.cross(eigen.eigenvectors().col(2));
    if (ahead.dot(frame[i].ahead) < 0) ahead = -ahead;
    if (ahead.norm() > 0.1) load.direction[i] = ahead.normalized();
  }
  return load;
}

// A crack number that neither the complex nor a front uses.
std::int32_t unused_crack(const Body& body, std::span<const GrowingFront> fronts, std::span<const GrowingFront> more) {
  CrackNumbers numbers(body.surface);
  for (const auto& some : {fronts, more})
    for (const auto& g : some) numbers.note(g.front.crack);
  return numbers.next();
}

// A front branches where the mean ratio of its live points exceeds the scene's.
bool branches(const FractureOptions& options, const GrowingFront& g, const FrontLoad& load, double spacing,
              const FractureState& state) {
  if (options.branching <= 0 || state.cracks >= options.max_cracks || g.length < options.separation * spacing)
    return false;
  double sum = 0;
  std::size_t live = 0;
  for (std::size_t i = 0; i < g.size(); ++i)
    if (g.live(i)) {
      sum += load.ratio[i];
      ++live;
    }
  return live > 0 && sum > options.branching * double(live);
}

// Turns the directions of growth about the front by an angle in radians.
void turn(FrontLoad& load, const GrowingFront& g, double angle) {
  for (std::size_t i = 0; i < g.size(); ++i)
    load.direction[i] = rotation_about(tip_frame(g, i).along(), angle) * load.direction[i];
}

// The growth that each point of a front owes after this step, and the spacing of the nodes there.
struct DueGrowth {
  double spacing = std::numeric_limits<double>::infinity();
  double largest = 0;
  bool in_air = true;  // no point is live: only parts of the front between points in air are inside
};

DueGrowth add_growth(const FractureInput& in, const FrontLoad& load, GrowingFront& g) {
  const double fastest = in.options.speed * rayleigh_speed(in.solid.materials().of(load.node));
  DueGrowth due;
  std::vector<double> spacing(g.size(), 0), growth(g.size(), 0);
  for (std::size_t i = 0; i < g.size(); ++i) {
    if (!g.live(i)) continue;
    spacing[i] = spacing_at(in.body, g.front.points[i].position);
    const double ratio = load.ratio[i];
    if (ratio > 1) growth[i] = std::min(spacing[i], in.dt * fastest * (1 - 1 / (ratio * ratio)));
  }
  // Nodes do not resolve a front that is bent within a spacing: neighbours move together.
  smooth_along(g, growth);
  for (std::size_t i = 0; i < g.size(); ++i) {
    if (!g.live(i)) continue;
    due.in_air = false;
    const Vec3& x = g.front.points[i].position;
    const double here = spacing[i];
    due.spacing = std::min(due.spacing, here);
    g.owed[i] = growth[i] > 0 ? std::min(here, g.owed[i] + growth[i]) : 0;
    if (!load.resolved[i] && may_break(in.options, x) && is_ligament(in.body.surface, tip_frame(g, i), here))
      g.owed[i] = std::max(g.owed[i], least_growth * here);
    due.largest = std::max(due.largest, g.owed[i]);
  }
  if (due.in_air) due.spacing = spacing_at(in.body, g.front.points[0].position);
  return due;
}

// The phases of step_fracture().
class FractureStep {
 public:
  FractureStep(const FractureInput& in, FractureState& state, const SplitStep& split)
      : in_(in), state_(state), split_(split) {}

  void grow_fronts();
  void cut_ligaments();
  void start_cracks();
  const FractureStats& stats() const { return stats_; }

 private:
  void grow(GrowingFront& g, std::span<const GrowingFront> all);
  void advance(GrowingFront& g, const FrontLoad& load, const std::vector<double>& step, double spacing);
  void keep(const std::vector<GrowingFront>& fronts) {
    state_.fronts.insert(state_.fronts.end(), fronts.begin(), fronts.end());
  }

  const FractureInput& in_;
  FractureState& state_;
  const SplitStep& split_;
  FractureStats stats_;
  std::vector<std::pair<std::int32_t, Box3>> grown_;  // cracks, and the boxes of their growth
};

void FractureStep::grow_fronts() {
  std::vector<GrowingFront> fronts;
  fronts.swap(state_.fronts);
  for (GrowingFront& g : fronts) grow(g, fronts);
}

// `all`: fronts at the beginning of the step.
void FractureStep::grow(GrowingFront& g, std::span<const GrowingFront> all) {
  FrontLoad load = load_on(in_, g);
  const DueGrowth due = add_growth(in_, load, g);
  if (!due.in_air && due.largest < least_growth * due.spacing) return keep({g});
  std::vector<double> step(g.size(), 0);
  for (std::size_t i = 0; i < g.size(); ++i)
    if (g.live(i) && g.owed[i] > least_point_growth * due.spacing) step[i] = g.owed[i];
  if (due.in_air || !branches(in_.options, g, load, due.spacing, state_)) return advance(g, load, step, due.spacing);
  // The two branches leave at 30° to either side.
  GrowingFront branch = g;
  branch.front.crack = unused_crack(in_.body, state_.fronts, all);
  branch.length = g.length = 0;
  FrontLoad other = load;
  turn(load, g, std::numbers::pi / 6);
  turn(other, g, -std::numbers::pi / 6);
  ++state_.cracks;
  ++stats_.divided;
  advance(g, load, step, due.spacing);
  advance(branch, other, step, due.spacing);
}

void FractureStep::advance(GrowingFront& g, const FrontLoad& load, const std::vector<double>& step, double spacing) {
  const FrontPlan plan = plan_front(in_.body.surface, g, step, load.direction, spacing);
  FrontState moved = with_planned_points(g, plan);
  if (!split_(moved, plan.next)) {
    ++stats_.refused;
    return keep({g});
  }
  ++stats_.advanced;
  grown_.push_back({g.front.crack, {}});
  for (const auto& p : g.front.points) grown_.back().second.add(p.position);
  for (const Vec3& p : plan.next) grown_.back().second.add(p);
  keep(fronts_after(g, plan, moved, load.direction));
}

// Cuts ligaments that fronts have left at edges of the body.
void FractureStep::cut_ligaments() {
  const Complex& complex = in_.body.surface;
  for (const auto& [crack, where] : grown_)
    for (FrontState& rest : unfollowed_borders(complex, crack, where, state_.fronts))
      if (const auto next = across_ligament(complex, rest, spacing_at(in_.body, rest.points[0].position));
          !next.empty())
        ++(split_(rest, next) ? stats_.advanced : stats_.refused);
}

void FractureStep::start_cracks() {
  const Body& body = in_.body;
  const int limit = std::min(in_.options.cracks_per_step, in_.options.max_cracks - state_.cracks);
  if (limit <= 0) return;
  const auto stress = averaged_stress(body, in_.solid, in_.motion);
  for (const CrackStart& s : find_starts(body, stress, in_.options, in_.body_index, static_cast<std::size_t>(limit))) {
    const double spacing = body.nodes.spacing[s.node.index()];
    // A twentieth of a spacing beside the node, which must not lie in the crack.
    auto [g, plan] = plan_flaw(body.surface, body.nodes.position[s.node.index()] + 0.05 * spacing * s.normal, s.normal,
                               spacing, unused_crack(body, state_.fronts, {}));
    FrontState moved = with_planned_points(g, plan);
    if (!split_(moved, plan.next)) {
      ++stats_.refused;
      continue;
    }
    ++state_.cracks;
    ++stats_.begun;
    keep(fronts_after(g, plan, moved, {}));
  }
}

}  // namespace

void step_fracture(const FractureInput& in, FractureState& state, const SplitStep& split, FractureStats* stats) {
  FractureStep step(in, state, split);
  step.grow_fronts();
  step.cut_ligaments();
  step.start_cracks();
  if (!stats) return;
  const FractureStats& done = step.stats();
  stats->begun += done.begun;
  stats->divided += done.divided;
  stats->advanced += done.advanced;
  stats->refused += done.refused;
}

}  // namespace geo
