#include "simulation/edge_runs.h"

#include <algorithm>
#include <cmath>

#include "kerf/parallel.h"

namespace geo {
namespace {

struct Sample {
  double at = 0;
  Vec3 world, material;
  bool within = false;
  double spacing = 0;
  double gap = 0;  // to the nearest node's place in the world, less its support radius
  EdgePoint point() const { return {at, material, spacing}; }
};

// Of a part of the edge.
class Tracer {
 public:
  Tracer(const PointMap& map, const Body& body, const Blade& blade, const Pose& pose)
      : map_(map), body_(body), blade_(blade), pose_(pose) {}

  Sample at(double where) {
    const std::size_t n = blade_.points.size(), i = std::min(static_cast<std::size_t>(where), n - 1);
    const double t = where - double(i);
    const Vec3 local =
        t > 0 ? Vec3(blade_.points[i] + t * (blade_.points[(i + 1) % n] - blade_.points[i])) : blade_.points[i];
    Sample s{where, pose_ * local, {}, false, 0, std::numeric_limits<double>::infinity()};
    const PointMap::Place place = map_.material(s.world, memory_);
    s.material = place.material, s.within = place.within;
    if (place.anchor.valid()) {
      s.spacing = body_.nodes.spacing[place.anchor.index()];
      s.gap =
          (s.material - body_.nodes.position[place.anchor.index()]).norm() - body_.nodes.radius[place.anchor.index()];
    }
    return s;
  }

  // What is between two samples, both left out, as finely as the mapping asks for.
  void between(const Sample& a, const Sample& b, int depth, std::vector<Sample>& out) {
    if (depth == 0) return;
    const double length = (b.world - a.world).norm(), spacing = std::min(a.spacing, b.spacing);
    if (!a.within && !b.within && std::min(a.gap, b.gap) > length) return;  // nothing can be between
    const bool ends = a.within != b.within;
    if ((ends || !a.within) && length < 0.25 * spacing) return;
    const Sample middle = at(0.5 * (a.at + b.at));
    const bool straight = a.within && b.within && middle.within &&
                          (middle.material - 0.5 * (a.material + b.material)).norm() <= 0.1 * spacing;
    if (straight) return;
    between(a, middle, depth - 1, out);
    out.push_back(middle);
    between(middle, b, depth - 1, out);
  }

 private:
  const PointMap& map_;
  const Body& body_;
  const Blade& blade_;
  const Pose& pose_;
  PointMap::Memory memory_;
};

// All samples of an edge. Parts of it are traced for themselves: what a sample says depends on no other.
std::vector<Sample> trace(const PointMap& map, const Body& body, const Blade& blade, const Pose& pose) {
  std::vector<std::vector<Sample>> parts(blade.points.size() - 1);  // from each point to the next, which is in it
  parallel_for(parts.size(), 2, [&](std::size_t begin, std::size_t end) {
    Tracer tracer(map, body, blade, pose);
    Sample last = tracer.at(double(begin));
    if (begin == 0) parts[0].push_back(last);
    for (std::size_t i = begin; i < end; ++i) {
      const Sample next = tracer.at(double(i + 1));
      tracer.between(last, next, 6, parts[i]);
      parts[i].push_back(next), last = next;
    }
  });
  std::vector<Sample> samples;
  for (const auto& part : parts) samples.insert(samples.end(), part.begin(), part.end());
  return samples;
}

// The mapping tears the edge apart between these.
bool torn(const Sample& a, const Sample& b) {
  return (b.material - a.material).norm() > 4 * (b.world - a.world).norm() + 0.5 * std::min(a.spacing, b.spacing);
}

// The first sample from i on that `last` goes on to, where what is between has strayed: the map was lost for less than
// nodes are apart, which nothing torn is. i where there is none.
std::size_t after_strays(const std::vector<Sample>& samples, std::size_t i, const Sample& last) {
  for (std::size_t j = i; j < samples.size() && samples[j].within &&
                          (samples[j].world - last.world).norm() < std::min(last.spacing, samples[j].spacing);
       ++j)
    if (!torn(last, samples[j])) return j;
  return i;
}

// Whether a run goes on from a front: they share a part of the edge, and are near there in the material.
bool follows(const std::vector<EdgePoint>& run, const EdgeFront& edge) {
  const double from = std::max(run.front().at, edge.at.front()), to = std::min(run.back().at, edge.at.back());
  if (from > to) return false;
  for (const EdgePoint& p : run) {
    if (p.at < from || p.at > to) continue;
    const auto k = static_cast<std::size_t>(
        std::min_element(edge.at.begin(), edge.at.end(),
                         [&](double a, double b) { return std::abs(a - p.at) < std::abs(b - p.at); }) -
        edge.at.begin());
    if ((edge.front.points[k].position - p.material).norm() < 4 * p.spacing) return true;
  }
  return false;
}

}  // namespace

std::vector<std::vector<EdgePoint>> edge_runs(const PointMap& map, const Body& body, const Blade& blade,
                                              const Pose& pose) {
  const std::vector<Sample> samples = trace(map, body, blade, pose);
  std::vector<std::vector<EdgePoint>> runs;
  const Sample* last = nullptr;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (!samples[i].within) {
      last = nullptr;
      continue;
    }
    if (last) i = after_strays(samples, i, *last);
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

std::vector<EdgePoint> closed_run(const PointMap& map, const Body& body, const Blade& blade, const Pose& pose) {
  Tracer tracer(map, body, blade, pose);
  std::vector<EdgePoint> run;
  for (std::size_t i = 0; i < blade.points.size(); ++i) run.push_back(tracer.at(double(i)).point());
  return run;
}

std::vector<EdgeFront> fronts_of(const std::vector<std::vector<EdgePoint>>& runs,
                                 const std::vector<EdgeFront>& before) {
  // Of a front that several runs go on from, each takes the part up to the middle between it and the next.
  std::vector<std::vector<std::size_t>> heirs(before.size());
  for (std::size_t e = 0; e < before.size(); ++e)
    for (std::size_t r = 0; r < runs.size(); ++r)
      if (follows(runs[r], before[e])) heirs[e].push_back(r);
  std::vector<EdgeFront> fronts(runs.size());
  for (std::size_t e = 0; e < before.size(); ++e)
    for (std::size_t h = 0; h < heirs[e].size(); ++h) {
      const std::size_t r = heirs[e][h];
      const double infinity = std::numeric_limits<double>::infinity();
      const double from = h > 0 ? 0.5 * (runs[heirs[e][h - 1]].back().at + runs[r].front().at) : -infinity;
      const double to =
          h + 1 < heirs[e].size() ? 0.5 * (runs[r].back().at + runs[heirs[e][h + 1]].front().at) : infinity;
      const EdgeFront part = heirs[e].size() == 1 ? before[e] : part_of(before[e], from, to);
      if (part.at.size() < 2) continue;
      if (fronts[r].at.empty())
        fronts[r] = part;
      else if (fronts[r].at.back() < part.at.front())
        fronts[r] = joined(std::move(fronts[r]), part);
    }
  return fronts;
}

}  // namespace geo
