// decimate() of kerf/crack.h. Edge collapses from a priority queue, the shortest edge first.
// Each vertex carries a bound of the surface's deviation near it; a collapse adds its own deviation
// to those of its faces' corners and is refused where one exceeds the tolerance.
#include "kerf/crack.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <queue>
#include <unordered_map>

#include "crack/all_or_nothing.h"
#include "crack/edit_quality.h"
#include "crack/features.h"
#include "crack/local_edit.h"
#include "kerf/error.h"
#include "kerf/progress.h"

namespace geo {
namespace {

class Decimator {
 public:
  Decimator(Complex& k, std::span<FrontState* const> fronts, const DecimateOptions& options, DecimateStats& stats,
            const Progress& progress)
      : k_(k),
        contacts_(fronts),
        options_(options),
        stats_(stats),
        progress_(progress),
        allowed_(options.deviation * k.extent().diagonal()) {
    rules_.crease = std::cos(options.crease * std::numbers::pi / 180);
    rules_.keep_skin = false;
    limit_ = 1 / std::tan(options.angle * std::numbers::pi / 180);
  }

  CrackDelta run() {
    for (std::uint32_t f = 0; f < k_.face_count(); ++f)
      if (k_.alive(FaceId(f))) queue(FaceId(f));
    for (std::size_t done = 0; !todo_.empty() && k_.live_face_count() > options_.faces; ++done) {
      report(progress_, "decimate", done, done + todo_.size());
      const auto [length, a, b] = todo_.top();
      todo_.pop();
      if (k_.faces_around(a, b).empty()) continue;
      if (!collapse(b, a)) collapse(a, b);
    }
    return delta_.sum();
  }

 private:
  struct Edge {
    double length;
    VertexId a, b;
    friend auto operator<=>(const Edge&, const Edge&) = default;
  };
  void queue(FaceId f) {
    for (int e = 0; e < 3; ++e) {
      const VertexId a = k_.face(f).v[e], b = k_.face(f).v[(e + 1) % 3];
      todo_.push({(k_.point(b) - k_.point(a)).norm(), std::min(a, b), std::max(a, b)});
    }
  }
  double moved(VertexId v) const {
    const auto it = moved_.find(v);
    return it == moved_.end() ? 0.0 : it->second;
  }

  bool collapse(VertexId b, VertexId a) {
    if (!contacts_.may_omit(b, a)) return false;
    const auto from = crack::location_of(k_, b, rules_), to = crack::location_of(k_, a, rules_);
    if (!crack::lies_within(from, to)) return false;
    const auto off_line = crack::distance_off_line(k_, from, b, a);
    if (!off_line || *off_line > allowed_) return false;
    auto local = crack::collapse(k_, b, a);
    if (!local) return false;
    const double off = std::max(*off_line, crack::deviation_at(k_, *local, k_.point(b), rules_));
    if (crack::worst_new(k_, *local) > std::max(limit_, crack::worst_removed(k_, *local))) return false;
    // Deviations accumulate: the old surface near the corners of the new faces may be this much
    // farther off now.
    std::vector<std::pair<VertexId, double>> moved_now{{a, std::max(moved(a), moved(b)) + off}};
    for (const auto& f : local->edit.new_faces)
      for (const VertexId v : f.v)
        if (v != a) moved_now.push_back({v, moved(v) + off});
    if (std::any_of(moved_now.begin(), moved_now.end(), [&](const auto& m) { return m.second > allowed_; }))
      return false;
    const auto delta = crack::try_commit(k_, *local, delta_);
    if (!delta) {
      ++stats_.refused;
      return false;
    }
    for (const FaceId f : delta->new_faces) queue(f);
    contacts_.omit(b);
    for (const auto& [v, distance] : moved_now) moved_[v] = distance;
    ++stats_.collapses;
    return true;
  }

  Complex& k_;
  crack::FrontContacts contacts_;
  const DecimateOptions& options_;
  DecimateStats& stats_;
  const Progress& progress_;
  crack::FeatureRules rules_;
  double allowed_, limit_ = 0;
  std::priority_queue<Edge, std::vector<Edge>, std::greater<>> todo_;
  std::unordered_map<VertexId, double> moved_;  // bound of the deviation from the old surface, per vertex
  DeltaSum delta_;
};

}  // namespace

CrackDelta decimate(Complex& complex, std::span<FrontState* const> fronts, const DecimateOptions& options,
                    DecimateStats* stats, const Progress& progress) {
  if (!(options.deviation >= 0) || !(options.crease >= 0 && options.crease <= 180) ||
      !(options.angle > 0 && options.angle < 60))
    throw InputError(
        "decimation needs a deviation of 0 or more, a crease between 0 and 180 and an angle between 0 and 60 degrees");
  DecimateStats done;
  Stopwatch watch;
  CrackDelta delta = crack::all_or_nothing(complex, fronts, progress,
                                           [&] { return Decimator(complex, fronts, options, done, progress).run(); });
  done.seconds = watch.lap();
  if (stats) *stats = done;
  return delta;
}

}  // namespace geo
