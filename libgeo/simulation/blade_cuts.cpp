// All runs of an edge ask the map of the body as it is before any of them cuts.
#include "simulation/blade_cuts.h"

#include <algorithm>
#include <utility>

#include "kerf/parallel.h"
#include "simulation/edge_resistance.h"
#include "simulation/edge_retreat.h"
#include "simulation/edge_runs.h"
#include "simulation/existing_cuts.h"
#include "simulation/mapped_places.h"
#include "simulation/next_crack.h"
#include "simulation/timed.h"

namespace geo {
namespace {

// Undeformed area of faces, model units².
double area_of(const Complex& surface, std::span<const FaceId> faces) {
  double area = 0;
  for (const FaceId f : faces) {
    const auto [a, b, c] = surface.corners(f);
    area += 0.5 * (b - a).cross(c - a).norm();
  }
  return area;
}

}  // namespace

BladeCuts::BladeCuts(const Scene& scene, const Body& body, RunState& state, CrackWriter& writer)
    : scene_(scene), body_(body), state_(state), writer_(writer) {}

bool BladeCuts::any_at(double time) const {
  return std::any_of(scene_.blades.begin(), scene_.blades.end(), [&](const Blade& b) { return b.active(time); });
}

void BladeCuts::drop_idle(double time) {
  for (std::size_t b = 0; b < scene_.blades.size(); ++b)
    if (!scene_.blades[b].active(time)) state_.fronts[b].clear();
}

void BladeCuts::begin_first(const MovedBody& moved, FrameStats& stats) {
  const auto is_active = [&](const Blade& blade) { return blade.active(moved.begin); };
  const auto blade = std::find_if(scene_.blades.begin(), scene_.blades.end(), is_active);
  if (blade == scene_.blades.end()) return;
  first_ = FirstCut{static_cast<std::size_t>(blade - scene_.blades.begin()), 0, {}};
  first_->cuts = begin_blade(moved, first_->blade);
  first_->plan = plan_cut(moved, first_->blade, 1, first_->cuts);
  if (first_->plan.advances.empty() || first_->plan.advances[0].rests) return;
  Advance& advance = first_->plan.advances[0];
  begin(advance, stats);
  const Timed timed(stats.split.binding_seconds);
  if (advance.crack) advance.crack->step.prepare();
}

void BladeCuts::make_all(const MovedBody& moved, FrameStats& stats) {
  std::optional<FirstCut> first = std::exchange(first_, std::nullopt);
  for (std::size_t b = 0; b < scene_.blades.size(); ++b) {
    if (!scene_.blades[b].active(moved.begin)) continue;
    const bool has_begun = first && first->blade == b;
    const int cuts = has_begun ? first->cuts : begin_blade(moved, b);
    for (int k = 1; k <= cuts; ++k)
      make_cut(b, has_begun && k == 1 ? std::move(first->plan) : plan_cut(moved, b, k, cuts), stats);
  }
}

// Maps the edge of a blade that has no fronts yet. Returns the number of its cuts in the step.
int BladeCuts::begin_blade(const MovedBody& moved, std::size_t b) {
  if (state_.fronts[b].empty()) map_edge(moved, b, 0, 0);
  return number_of_cuts(moved, scene_.blades[b], state_.fronts[b]);
}

// The runs of a blade's edge in the material at a fraction of a time step. Its fronts become those
// that the runs continue; a run without one gets a new front. `before`: the fraction at the cut
// before, where a front begins that comes out of a cut.
std::vector<std::vector<EdgePoint>> BladeCuts::map_edge(const MovedBody& moved, std::size_t b, double fraction,
                                                        double before) {
  const Blade& blade = scene_.blades[b];
  std::vector<EdgeFront>& fronts = state_.fronts[b];
  const MapAt at(moved, blade, fraction);
  std::vector<std::vector<EdgePoint>> runs;
  if (blade.closed) {
    runs.push_back(closed_run(at.map(), body_, blade, at.pose(), fronts));
    if (fronts.empty()) fronts.resize(1);
  } else {
    runs = edge_runs(at.map(), body_, blade, at.pose(), fronts);
    fronts = fronts_of(runs, fronts, body_.surface);
  }
  for (std::size_t r = 0; r < runs.size(); ++r) {
    if (!fronts[r].at.empty()) {
      if (blade.closed) continue;
      const std::vector<EdgePoint> points = entering(moved, blade, before, runs[r], fronts[r]);
      fronts[r] = grown(std::move(fronts[r]), points);
      continue;
    }
    const std::vector<EdgePoint> begin = begin_of_run(moved, blade, before, runs[r], fronts);
    fronts[r] = begin_edge(begin, next_crack(body_.surface, state_), blade.name, blade.closed);
  }
  return runs;
}

// The advance of a blade's fronts to the end of cut k of a time step.
BladeCuts::PlannedCut BladeCuts::plan_cut(const MovedBody& moved, std::size_t b, int k, int cuts) {
  const Blade& blade = scene_.blades[b];
  PlannedCut plan{map_edge(moved, b, double(k) / cuts, (k - 1.0) / cuts), {}};
  plan.advances.resize(plan.runs.size());
  for (std::size_t r = 0; r < plan.runs.size(); ++r) plan.advances[r].rests = rests(state_.fronts[b][r], plan.runs[r]);
  if (std::all_of(plan.advances.begin(), plan.advances.end(), [](const Advance& a) { return a.rests; })) return plan;
  std::optional<MapAt> start, half;
  parallel_invoke([&] { start.emplace(moved, blade, (k - 1.0) / cuts); },
                  [&] { half.emplace(moved, blade, (k - 0.5) / cuts); });
  for (std::size_t r = 0; r < plan.runs.size(); ++r) {
    if (plan.advances[r].rests) continue;
    const EdgeFront& front = state_.fronts[b][r];
    const FrontAnchor anchor(body_.surface, *start, blade, front);
    plan.advances[r] = plan_advance(front, plan.runs[r], *half, blade, anchor, moved.solid);
  }
  return plan;
}

// The next position of a front. `run`: where the edge is; `half`: the map at half the time of the
// cut; `anchor`: of the front.
BladeCuts::Advance BladeCuts::plan_advance(const EdgeFront& front, std::span<const EdgePoint> run, const MapAt& half,
                                           const Blade& blade, const FrontAnchor& anchor, const Solid& solid) const {
  Advance a;
  const MappedPlaces places(body_);
  std::vector<Vec3> mapped;
  a.edge = refined(front, run, mapped);
  for (const double at : a.edge.at) {
    const EdgePoint& p = nearest(run, at);
    a.to.push_back(anchor.corrected(p.at, p.material, p.spacing));
    a.spacing.push_back(p.spacing);
  }
  if (blade.resistance > 0) stay_behind(body_, solid, blade.resistance, {.edge = a.edge, .run = run}, a.to);
  a.retreating = hold_retreating(body_.surface, a.edge.front, a.spacing, a.to);
  hold_sliding(a.edge.front, a.spacing, a.to);
  cross_first(body_.surface, a.edge.front, a.spacing, a.to);
  const std::vector<Vec3> resolved = places.resolved(a.to);
  for (std::size_t i = 0; i < a.to.size(); ++i)
    if (a.to[i] != a.edge.front.points[i].position) a.to[i] = resolved[i];
  a.rests = rests(a.edge.front, mapped, a.spacing, a.to);
  if (!a.rests) a.deviation = sheet_deviation(body_, half, blade, a.edge, a.to, anchor);
  return a;
}

void BladeCuts::begin(Advance& advance, FrameStats& stats) {
  advance.crack = writer_.begin(advance.edge.front, advance.to, stats);
  advance.has_begun = true;
}

// Advances the fronts of a blade.
void BladeCuts::make_cut(std::size_t b, PlannedCut plan, FrameStats& stats) {
  for (std::size_t r = 0; r < plan.runs.size(); ++r) {
    Advance& advance = plan.advances[r];
    stats.sheet.retreating += advance.retreating;
    if (advance.rests) continue;
    ++stats.fronts;
    if (!advance.has_begun) begin(advance, stats);
    if (!advance.crack) continue;
    auto written = writer_.commit(std::move(*advance.crack), stats);
    if (!written) continue;
    advance.edge.front = std::move(written->front);
    collapse(advance.edge, plan.runs[r]);
    state_.fronts[b][r] = std::move(advance.edge);
    const double resistance = scene_.blades[b].resistance;
    if (resistance > 0) stats.cut_energy += resistance * area_of(body_.surface, written->faces);
    stats.sheet.deviation = std::max(stats.sheet.deviation, advance.deviation);
    const double lowest = 0.1 * *std::min_element(advance.spacing.begin(), advance.spacing.end());
    stats.sheet.turning = std::max(stats.sheet.turning, sheet_turning(body_.surface, written->faces, lowest));
  }
}

}  // namespace geo
