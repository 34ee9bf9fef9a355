// Adaptive bisection of the edge parameter. A segment is halved while its midpoint in the material
// is off the chord by more than `most_deviation`. Runs are split where neighbouring samples are
// torn.
#include "simulation/edge_runs.h"

#include <algorithm>
#include <cmath>

#include "geometry/resolution.h"
#include "kerf/parallel.h"
#include "simulation/edge_retreat.h"

namespace geo {
namespace {

// Largest distance of a front from the mapped edge, in spacings. Parameters come and go from cut to
// cut, and the sheet turns by this over the way of a cut.
constexpr double most_deviation = 0.02;
// Longest segment of a front, in spacings: a midpoint alone does not see an edge bent twice.
constexpr double longest_segment = 2;

// A point of the edge, mapped into the material.
struct Sample {
  double at = 0;  // edge parameter
  Vec3 world, material;
  bool within = false;  // the support of a node
  double spacing = 0;
  double gap = 0;  // distance to the nearest node, less its support radius
  EdgePoint point() const { return {at, material, spacing}; }
};

// Samples a part of the edge. Not shared between threads: it caches deformed surface vertices.
class EdgeSampler {
 public:
  EdgeSampler(const InverseDeformation& map, const Body& body, const Blade& blade, const Pose& pose,
              std::span<const EdgeFront> fronts)
      : map_(map), body_(body), blade_(blade), pose_(pose), fronts_(fronts), resolution_(body.surface.extent().diagonal()) {}

  Sample at(double parameter) {
    Sample s{parameter, pose_ * place_on(blade_, parameter), {}, false, 0, std::numeric_limits<double>::infinity()};
    const std::optional<Vec3> before = place_on(fronts_, parameter);
    const InverseDeformation::Location place = map_.to_material(s.world, memory_, before ? &*before : nullptr);
    s.material = resolution_.rounded(place.position), s.within = place.in_support;
    if (place.nearest.valid()) {
      s.spacing = body_.nodes.spacing[place.nearest.index()];
      s.gap =
          (s.material - body_.nodes.position[place.nearest.index()]).norm() - body_.nodes.radius[place.nearest.index()];
    }
    return s;
  }

  // Appends samples strictly between two, by bisection where the map is not straight. Ends of a run
  // are found to a quarter of a spacing.
  void refine(const Sample& a, const Sample& b, int depth, std::vector<Sample>& out) {
    if (depth == 0) return;
    const double length = (b.world - a.world).norm(), spacing = std::min(a.spacing, b.spacing);
    if (!a.within && !b.within && std::min(a.gap, b.gap) > length) return;  // no node reaches the points between
    const bool ends = a.within != b.within;
    if ((ends || !a.within) && length < 0.25 * spacing) return;
    const Sample middle = at(0.5 * (a.at + b.at));
    const bool straight = a.within && b.within && middle.within &&
                          (b.material - a.material).norm() <= longest_segment * spacing &&
                          (middle.material - 0.5 * (a.material + b.material)).norm() <= most_deviation * spacing;
    if (straight) return;
    refine(a, middle, depth - 1, out);
    out.push_back(middle);
    refine(middle, b, depth - 1, out);
  }

 private:
  const InverseDeformation& map_;
  const Body& body_;
  const Blade& blade_;
  const Pose& pose_;
  std::span<const EdgeFront> fronts_;
  Resolution resolution_;
  InverseDeformation::VertexCache memory_;
};

// All samples of an edge. Threads trace parts of it: a sample does not depend on the others.
std::vector<Sample> sample_edge(const InverseDeformation& map, const Body& body, const Blade& blade, const Pose& pose,
                                std::span<const EdgeFront> fronts) {
  std::vector<std::vector<Sample>> segments(blade.points.size() - 1);  // each with its last point
  parallel_for(segments.size(), 2, [&](std::size_t begin, std::size_t end) {
    EdgeSampler sampler(map, body, blade, pose, fronts);
    Sample last = sampler.at(double(begin));
    if (begin == 0) segments[0].push_back(last);
    for (std::size_t i = begin; i < end; ++i) {
      const Sample next = sampler.at(double(i + 1));
      sampler.refine(last, next, 6, segments[i]);
      segments[i].push_back(next), last = next;
    }
  });
  std::vector<Sample> samples;
  for (const auto& segment : segments) samples.insert(samples.end(), segment.begin(), segment.end());
  return samples;
}

// True where the edge is in disconnected material at these samples: with X material and x world
// positions, |ΔX| > 4 |Δx| + ½ spacing. A map of stretch below 4 never exceeds that.
bool torn(const Sample& a, const Sample& b) {
  return (b.material - a.material).norm() > 4 * (b.world - a.world).norm() + 0.5 * std::min(a.spacing, b.spacing);
}

// The first sample from i on that continues `last`, where the samples between are outliers of the
// map: it failed over less than a node spacing, and torn material is farther apart. i where there
// is none.
std::size_t after_outliers(const std::vector<Sample>& samples, std::size_t i, const Sample& last) {
  for (std::size_t j = i; j < samples.size() && samples[j].within &&
                          (samples[j].world - last.world).norm() < std::min(last.spacing, samples[j].spacing);
       ++j)
    if (!torn(last, samples[j])) return j;
  return i;
}

// True where a run continues a front. Their edge parameters overlap, and there a point of the run
// is within four spacings, in the material, of the front's point nearest in parameter, or within a
// quarter of a spacing of its crack.
bool continues(const std::vector<EdgePoint>& run, const EdgeFront& edge, const Complex& surface) {
  const double from = std::max(run.front().at, edge.at.front()), to = std::min(run.back().at, edge.at.back());
  if (from > to) return false;
  for (const EdgePoint& p : run) {
    if (p.at < from || p.at > to) continue;
    const auto k = static_cast<std::size_t>(
        std::min_element(edge.at.begin(), edge.at.end(),
                         [&](double a, double b) { return std::abs(a - p.at) < std::abs(b - p.at); }) -
        edge.at.begin());
    if ((edge.front.points[k].position - p.material).norm() < 4 * p.spacing ||
        distance_from_crack(surface, edge.front.crack, p.material, 0.25 * p.spacing) < 0.25 * p.spacing)
      return true;
  }
  return false;
}

}  // namespace

std::vector<std::vector<EdgePoint>> edge_runs(const InverseDeformation& map, const Body& body, const Blade& blade,
                                              const Pose& pose, std::span<const EdgeFront> fronts) {
  const std::vector<Sample> samples = sample_edge(map, body, blade, pose, fronts);
  std::vector<std::vector<EdgePoint>> runs;
  const Sample* last = nullptr;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (!samples[i].within) {
      last = nullptr;
      continue;
    }
    if (last) i = after_outliers(samples, i, *last);
    const Sample& s = samples[i];
    if (!last || torn(*last, s)) runs.emplace_back();
    auto& run = runs.back();
    if (run.size() > 1 && (s.material - run.back().material).norm() < 0.05 * s.spacing)
      run.back() = s.point();
    else
      run.push_back(s.point());
    last = &s;
  }
  std::erase_if(runs, [](const auto& run) { return run.size() < 2; });
  return runs;
}

std::vector<EdgePoint> closed_run(const InverseDeformation& map, const Body& body, const Blade& blade, const Pose& pose,
                                  std::span<const EdgeFront> fronts) {
  EdgeSampler sampler(map, body, blade, pose, fronts);
  std::vector<EdgePoint> run;
  for (std::size_t i = 0; i < blade.points.size(); ++i) run.push_back(sampler.at(double(i)).point());
  return run;
}

std::vector<EdgeFront> fronts_of(const std::vector<std::vector<EdgePoint>>& runs, const std::vector<EdgeFront>& before,
                                 const Complex& surface) {
  // A front that several runs continue is split half way between each two of them.
  std::vector<std::vector<std::size_t>> successors(before.size());
  for (std::size_t e = 0; e < before.size(); ++e)
    for (std::size_t r = 0; r < runs.size(); ++r)
      if (continues(runs[r], before[e], surface)) successors[e].push_back(r);
  std::vector<EdgeFront> fronts(runs.size());
  for (std::size_t e = 0; e < before.size(); ++e)
    for (std::size_t h = 0; h < successors[e].size(); ++h) {
      const std::size_t r = successors[e][h];
      const double infinity = std::numeric_limits<double>::infinity();
      const double from = h > 0 ? 0.5 * (runs[successors[e][h - 1]].back().at + runs[r].front().at) : -infinity;
      const double to =
          h + 1 < successors[e].size() ? 0.5 * (runs[r].back().at + runs[successors[e][h + 1]].front().at) : infinity;
      const EdgeFront part = successors[e].size() == 1 ? before[e] : part_of(before[e], from, to);
      if (part.at.size() < 2) continue;
      if (fronts[r].at.empty())
        fronts[r] = part;
      else if (fronts[r].at.back() < part.at.front())
        fronts[r] = joined(std::move(fronts[r]), part);
    }
  return fronts;
}

}  // namespace geo
