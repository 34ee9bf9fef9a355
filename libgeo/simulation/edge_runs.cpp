// Adaptive bisection of the edge parameter. A segment is halved while its midpoint in the material
// is off the chord by more than `most_deviation`. Runs are split where neighbouring samples are
// torn.
#include "simulation/edge_runs.h"

#include <algorithm>
#include <cmath>

#include "body/locate.h"
#include "geometry/predicates.h"
#include "kerf/parallel.h"
#include "simulation/existing_cuts.h"
#include "simulation/mapped_places.h"

namespace geo {
namespace {

// Largest distance of a front from the mapped edge, in spacings. Parameters come and go from cut to
// cut, and the sheet turns by this over the way of a cut.
constexpr double most_deviation = 0.02;
// Longest segment of a front, in spacings: a midpoint alone does not see an edge bent twice.
constexpr double longest_segment = 2;

// Longest segment beside an existing cut, in spacings: shorter than an edge is in a cut of which a
// run counts (see CutLeaver).
constexpr double longest_beside_cut = 0.5;

// A point of the edge, mapped into the material.
struct Sample {
  double at = 0;  // edge parameter
  Vec3 world, material;
  MappedPlace place;       // that `material` is outside of
  bool within = false;     // the support of a node
  bool is_in_cut = false;  // one that exists, and no front there can go on
  bool is_beyond = false;  // a wall of it: in the air between pieces, by the map of one of them
  bool is_held = false;    // by a front that can go on
  bool is_dropped = false;
  double spacing = 0;
  NodeId node;                                           // the nearest
  double gap = std::numeric_limits<double>::infinity();  // distance to the nearest node, less its support radius
  EdgePoint point() const { return {.at = at, .material = material, .spacing = spacing, .node = node}; }
};

// Samples a part of the edge. Not shared between threads: it caches deformed surface vertices.
class EdgeSampler {
 public:
  EdgeSampler(const InverseDeformation& map, const Body& body, const Blade& blade, const Pose& pose,
              std::span<const EdgeFront> fronts)
      : map_(map),
        body_(body),
        blade_(blade),
        pose_(pose),
        fronts_(fronts),
        cuts_(body.surface, fronts),
        place_(body) {}

  Sample at(double parameter) {
    Sample s;
    s.at = parameter;
    s.world = pose_ * place_on(blade_, parameter);
    const std::optional<Vec3> before = place_on(fronts_, parameter);
    const InverseDeformation::Location place = map_.to_material(s.world, memory_, before ? &*before : nullptr);
    s.place = place_.at(place.position, pose_.rotation * direction_on(blade_, parameter));
    s.material = place_.outside(s.place);
    s.within = place.in_support;
    s.node = place.nearest;
    if (place.nearest.valid()) {
      s.spacing = body_.nodes.spacing[place.nearest.index()];
      s.gap =
          (s.material - body_.nodes.position[place.nearest.index()]).norm() - body_.nodes.radius[place.nearest.index()];
    }
    s.is_held = s.within && cuts_.can_go_on(parameter);
    s.is_beyond = s.within && !s.is_held && is_behind_wall(s);
    s.is_in_cut = s.is_beyond || (s.within && !s.is_held && cuts_.contain(s.material, s.spacing));
    return s;
  }

  // Appends samples strictly between two, by bisection where the map is not straight. Ends of a run
  // are found to a quarter of a spacing.
  void refine(const Sample& a, const Sample& b, int depth, std::vector<Sample>& out) {
    if (depth == 0) return;
    const double length = (b.world - a.world).norm(), spacing = std::min(a.spacing, b.spacing);
    if (!a.within && !b.within && std::min(a.gap, b.gap) > length) return;  // no node reaches the points between
    const bool ends = a.within != b.within, meets_cut = a.is_in_cut != b.is_in_cut;
    if ((ends || !a.within) && length < 0.25 * spacing) return;
    const Sample middle = at(0.5 * (a.at + b.at));
    const bool straight = a.within && b.within && middle.within &&
                          (!meets_cut || length < resolved_by_front * spacing) &&
                          (b.material - a.material).norm() <= longest_segment * spacing &&
                          (middle.material - 0.5 * (a.material + b.material)).norm() <= most_deviation * spacing;
    if (straight && !passes_cut(a, b, length, spacing)) return;
    std::vector<Sample> between;
    refine(a, middle, depth - 1, between);
    between.push_back(middle);
    refine(middle, b, depth - 1, between);
    const auto is_off = [](const Sample& s) { return s.is_in_cut || !s.within; };
    if (!straight || std::any_of(between.begin(), between.end(), is_off))
      out.insert(out.end(), between.begin(), between.end());
  }

 private:
  // Whether a wall of a cut lies between the place of a sample and the node that its map is of. The
  // motion of a piece is extended into the air beside it, where other pieces were at rest.
  bool is_behind_wall(const Sample& s) const {
    if (!s.node.valid()) return false;
    const Vec3& from = body_.nodes.position[s.node.index()];
    std::vector<FaceId> near;
    body_.surface.faces_near(box_of(from, s.material, s.material), near);
    return std::any_of(near.begin(), near.end(), [&](FaceId f) {
      if (body_.surface.face(f).crack == 0) return false;
      const auto [a, b, c] = body_.surface.corners(f);
      return segment_meets_triangle(from, s.material, a, b, c);
    });
  }

  // Whether a cut may lie between two samples that are in none.
  bool passes_cut(const Sample& a, const Sample& b, double length, double spacing) const {
    return length > longest_beside_cut * spacing && cuts_.may_contain_between(a.material, b.material, spacing);
  }

  const InverseDeformation& map_;
  const Body& body_;
  const Blade& blade_;
  const Pose& pose_;
  std::span<const EdgeFront> fronts_;
  ExistingCuts cuts_;
  MappedPlaces place_;
  InverseDeformation::VertexCache memory_;
};

// Puts the samples of an edge outside the planes of the skin that others of them may lie in.
void leave_planes(const Body& body, std::vector<Sample>& samples) {
  const MappedPlaces on(body);
  std::vector<MappedPlace> places;
  for (const Sample& s : samples) places.push_back(s.place);
  on.share_planes(places);
  for (std::size_t i = 0; i < samples.size(); ++i) samples[i].material = on.outside(places[i]);
}

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
      segments[i].push_back(next);
      last = next;
    }
  });
  std::vector<Sample> samples;
  for (const auto& segment : segments) samples.insert(samples.end(), segment.begin(), segment.end());
  leave_planes(body, samples);
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

// The samples of each stay in a cut: first and last index.
std::vector<std::pair<std::size_t, std::size_t>> stays_in_cut(const std::vector<Sample>& samples) {
  std::vector<std::pair<std::size_t, std::size_t>> stays;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (!samples[i].is_in_cut) continue;
    if (stays.empty() || stays.back().second + 1 != i)
      stays.push_back({i, i});
    else
      stays.back().second = i;
  }
  return stays;
}

// Takes samples in existing cuts out of the material, and beside them those in air outside the
// skin. From there, the skin bulges into what the edge sweeps, and a strip would lie on the sheet
// of the cut. An edge that comes from whole material and is in a cut for less than a spacing
// crosses it, and stays. Otherwise a part in whole material keeps one more sample, so that it ends
// at the sheet or in air.
class CutLeaver {
 public:
  CutLeaver(std::vector<Sample>& samples, const Complex& surface) : samples_(samples), surface_(surface) {}

  // Returns the samples before which a run ends.
  std::vector<std::uint8_t> run() {
    std::vector<std::uint8_t> is_end(samples_.size() + 1, 0);
    for (const auto& [first, last] : stays_in_cut(samples_)) {
      const bool whole_before = first > 0 && is_whole(first - 1);
      const bool whole_after = last + 1 < samples_.size() && is_whole(last + 1);
      const double length = (samples_[last].material - samples_[first].material).norm();
      if ((whole_before || whole_after) && length < samples_[first].spacing) {
        cross(first, last);
        continue;
      }
      for (std::size_t i = first; i <= last; ++i)
        samples_[i].within = (i == first && whole_before) || (i == last && whole_after);
      if (last == first + 1) is_end[last] = 1;
      if (!whole_before) leave_air(first, -1);
      if (!whole_after) leave_air(last, 1);
    }
    return is_end;
  }

 private:
  bool is_whole(std::size_t i) const {
    return samples_[i].within && !samples_[i].is_in_cut && is_inside(surface_, samples_[i].material);
  }

  // An edge that crosses the gap between two pieces goes from wall to wall: between them, the map
  // is that of either piece, beyond its wall.
  void cross(std::size_t first, std::size_t last) {
    for (std::size_t i = first; i <= last; ++i) samples_[i].is_dropped = samples_[i].is_beyond;
  }

  // Takes out the samples in air beside sample `from`, up to the last one before whole material, or
  // to a front that can go on.
  void leave_air(std::size_t from, std::ptrdiff_t way) {
    const auto next = [&](std::size_t i) { return static_cast<std::size_t>(static_cast<std::ptrdiff_t>(i) + way); };
    for (std::size_t i = next(from); i < samples_.size() && samples_[i].within && !samples_[i].is_in_cut; i = next(i)) {
      if (samples_[i].is_held || (next(i) < samples_.size() && is_whole(next(i)))) return;
      samples_[i].within = false;
    }
  }

  std::vector<Sample>& samples_;
  const Complex& surface_;
};

// The point of a front nearest to an edge parameter.
const Vec3& place_near(const EdgeFront& edge, double at) {
  const auto nearer = [&](double a, double b) { return std::abs(a - at) < std::abs(b - at); };
  const auto k = std::min_element(edge.at.begin(), edge.at.end(), nearer) - edge.at.begin();
  return edge.front.points[static_cast<std::size_t>(k)].position;
}

// True where a run continues a front that its edge has just made. Their edge parameters overlap,
// and there a point of the run is within four spacings, in the material, of the front's point
// nearest in parameter, or within a quarter of a spacing of its crack.
bool continues_current(const std::vector<EdgePoint>& run, const EdgeFront& edge, const Complex& surface) {
  const double from = std::max(run.front().at, edge.at.front()), to = std::min(run.back().at, edge.at.back());
  for (const EdgePoint& p : run) {
    if (p.at < from || p.at > to) continue;
    const double reach = beside_own_sheet * p.spacing;
    if ((place_near(edge, p.at) - p.material).norm() < 4 * p.spacing ||
        distance_from_crack(surface, edge.front.crack, p.material, reach) < reach)
      return true;
  }
  return false;
}

// True where a run comes back to a front that the edge has left: all of its points in the material
// with the front's edge parameters are in a cut, or within a spacing of the front.
bool comes_back(const std::vector<EdgePoint>& run, const EdgeFront& edge, const Complex& surface,
                const ExistingCuts& cuts) {
  if (!has_contact(edge.front)) return false;
  const double from = std::max(run.front().at, edge.at.front()), to = std::min(run.back().at, edge.at.back());
  bool any = false;
  for (const EdgePoint& p : run) {
    if (p.at < from || p.at > to) continue;
    if (cuts.contain(p.material, p.spacing) || (place_near(edge, p.at) - p.material).norm() < p.spacing)
      any = true;
    else if (is_inside(surface, p.material))
      return false;
  }
  return any;
}

// The parts of fronts that become one: their parameters do not overlap.
class FrontOfRun {
 public:
  // Takes the part if there is space for it.
  bool take(EdgeFront& part) {
    if (part.at.size() < 2) return false;
    const auto overlaps = [&](const EdgeFront& p) {
      return !(part.at.back() < p.at.front() || p.at.back() < part.at.front());
    };
    if (std::any_of(parts_.begin(), parts_.end(), overlaps)) return false;
    parts_.push_back(std::move(part));
    return true;
  }
  // One front; without points where there is no part.
  EdgeFront join() {
    if (parts_.empty()) return {};
    std::sort(parts_.begin(), parts_.end(), [](const auto& a, const auto& b) { return a.at.front() < b.at.front(); });
    EdgeFront front = std::move(parts_[0]);
    for (std::size_t i = 1; i < parts_.size(); ++i) front = joined(std::move(front), parts_[i]);
    front.is_left = false;
    return front;
  }

 private:
  std::vector<EdgeFront> parts_;
};

// Keeps fronts that the edge has left, where they can go on or tell of a cut.
void keep_left(std::vector<EdgeFront> left, std::vector<EdgeFront>& fronts) {
  for (EdgeFront& edge : left) {
    const auto same_cut = [&](const EdgeFront& f) { return f.front.crack == edge.front.crack && f.front.has_moved; };
    if (edge.at.empty() || !edge.front.has_moved) continue;
    if (!has_contact(edge.front) && std::any_of(fronts.begin(), fronts.end(), same_cut)) continue;
    edge.is_left = true;
    fronts.push_back(std::move(edge));
  }
}

}  // namespace

std::vector<std::vector<EdgePoint>> edge_runs(const InverseDeformation& map, const Body& body, const Blade& blade,
                                              const Pose& pose, std::span<const EdgeFront> fronts) {
  std::vector<Sample> samples = sample_edge(map, body, blade, pose, fronts);
  const std::vector<std::uint8_t> is_end = CutLeaver(samples, body.surface).run();
  std::vector<std::vector<EdgePoint>> runs;
  const Sample* last = nullptr;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (samples[i].is_dropped) continue;
    if (!samples[i].within) {
      last = nullptr;
      continue;
    }
    if (last) i = after_outliers(samples, i, *last);
    const Sample& s = samples[i];
    if (!last || is_end[i] || torn(*last, s)) runs.emplace_back();
    auto& run = runs.back();
    if (run.size() > 1 && (s.material - run.back().material).norm() < resolved_by_front * s.spacing)
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
  std::vector<Sample> samples;
  for (std::size_t i = 0; i < blade.points.size(); ++i) samples.push_back(sampler.at(double(i)));
  leave_planes(body, samples);
  std::vector<EdgePoint> run;
  for (const Sample& s : samples) run.push_back(s.point());
  return run;
}

std::vector<EdgeFront> fronts_of(const std::vector<std::vector<EdgePoint>>& runs, const std::vector<EdgeFront>& before,
                                 const Complex& surface) {
  const ExistingCuts cuts(surface, before);
  std::vector<FrontOfRun> parts(runs.size());
  std::vector<EdgeFront> left;
  // Fronts in the material come first: one in air has no claim to the edge parameters of these.
  std::vector<const EdgeFront*> order;
  for (const EdgeFront& edge : before) order.push_back(&edge);
  std::stable_partition(order.begin(), order.end(), [](const EdgeFront* e) { return has_contact(e->front); });
  for (const EdgeFront* edge : order) {
    std::vector<std::size_t> successors;
    for (std::size_t r = 0; r < runs.size(); ++r)
      if (edge->is_left ? comes_back(runs[r], *edge, surface, cuts) : continues_current(runs[r], *edge, surface))
        successors.push_back(r);
    if (successors.empty()) left.push_back(*edge);
    // A front that several runs continue is split half way between each two of them.
    for (std::size_t h = 0; h < successors.size(); ++h) {
      const std::size_t r = successors[h];
      const double infinity = std::numeric_limits<double>::infinity();
      const double from = h > 0 ? 0.5 * (runs[successors[h - 1]].back().at + runs[r].front().at) : -infinity;
      const double to =
          h + 1 < successors.size() ? 0.5 * (runs[r].back().at + runs[successors[h + 1]].front().at) : infinity;
      EdgeFront part = successors.size() == 1 ? *edge : part_of(*edge, from, to);
      if (!parts[r].take(part)) left.push_back(std::move(part));
    }
  }
  std::vector<EdgeFront> fronts;
  for (FrontOfRun& of_run : parts) fronts.push_back(of_run.join());
  keep_left(std::move(left), fronts);
  return fronts;
}

}  // namespace geo
