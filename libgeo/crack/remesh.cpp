// remesh() of kerf/crack.h. A queue of faces below the wanted angle; each tries flip,
// collapse, vertex move and bisection, in this order, until one is accepted. Quality of an edit:
// its largest cotangent of a smallest angle, before and after.
#include "kerf/crack.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <functional>
#include <numbers>
#include <unordered_set>

#include "crack/all_or_nothing.h"
#include "crack/edit_quality.h"
#include "crack/features.h"
#include "crack/local_edit.h"
#include "geometry/distance.h"
#include "kerf/error.h"
#include "kerf/progress.h"
#include "surface/radial_edge.h"

namespace geo {
namespace {

using crack::LocalEdit;

class Remesher {
 public:
  Remesher(Complex& k, std::span<FrontState* const> fronts, const RemeshOptions& options, RemeshStats& stats,
           const Progress& progress)
      : k_(k), contacts_(fronts), options_(options), stats_(stats), progress_(progress), size_(k.extent().diagonal()) {
    limit_ = 1 / std::tan(options.angle * std::numbers::pi / 180);
    rules_.crease = std::cos(options.crease * std::numbers::pi / 180);
  }

  CrackDelta run(std::span<const FaceId> region) {
    for (const FaceId f : region) queue(f);
    // A face is tried again when its neighbours change; these bounds end the loop. Larger:
    // more tries for faces that resist, and a later end where edits undo each other.
    std::size_t patience = 60 * todo_.size() + 400, divisions = 4 * todo_.size() + 40;
    for (std::size_t done = 0; !todo_.empty() && patience-- > 0; ++done) {
      report(progress_, "remesh", done, done + todo_.size());
      const FaceId f = todo_.front();
      todo_.pop_front();
      queued_.erase(f);
      if (!k_.alive(f)) continue;
      if (crack::smallest_angle_cotangent(k_.corners(f)) <= limit_) continue;
      ++stats_.faces;
      if (flip(f) || collapse(f) || move(f)) continue;
      if (divisions > 0 && divide(f)) --divisions;
    }
    return delta_.sum();
  }

 private:
  void queue(FaceId f) {
    if (k_.alive(f) && crack::smallest_angle_cotangent(k_.corners(f)) > limit_ && queued_.insert(f).second)
      todo_.push_back(f);
  }

  bool improves(const LocalEdit& local, double factor) const {
    return crack::worst_new(k_, local) < factor * crack::worst_removed(k_, local);
  }
  bool stays_close(const LocalEdit& local, const Vec3& p) const {
    return crack::deviation_at(k_, local, p, rules_) <= options_.deviation * size_;
  }

  // Commits an edit if neither may_sweep nor the guard refuses it.
  bool apply(LocalEdit& local) {
    const bool allowed = !options_.may_sweep || std::all_of(local.swept.begin(), local.swept.end(), options_.may_sweep);
    const auto delta = allowed ? crack::try_commit(k_, local, delta_) : std::nullopt;
    if (!delta) {
      ++stats_.refused;
      return false;
    }
    for (const FaceId f : delta->new_faces) {
      queue(f);
      for (int e = 0; e < 3; ++e)
        for (const FaceId g : k_.faces_around(k_.face(f).v[e], k_.face(f).v[(e + 1) % 3])) queue(g);
    }
    return true;
  }

  template <class Before>
  static std::array<int, 3> edges_by_length(const std::array<Vec3, 3>& c, const Before& before) {
    std::array<int, 3> edges{0, 1, 2};
    std::sort(edges.begin(), edges.end(), [&](int i, int j) {
      return before((c[(i + 1) % 3] - c[i]).squaredNorm(), (c[(j + 1) % 3] - c[j]).squaredNorm());
    });
    return edges;
  }

  bool flip(FaceId f) {
    const auto c = k_.corners(f);
    for (const int e : edges_by_length(c, std::greater<>())) {
      if (crack::is_feature_edge(k_, k_.face(f).v[e], k_.face(f).v[(e + 1) % 3], rules_)) continue;
      auto local = crack::flip(k_, f, e);
      // Better by 0.1 %, so that rounding cannot make flips alternate.
      if (!local || !improves(*local, 0.999)) continue;
      // The deviation is largest at the edge's midpoint.
      const Vec3 middle = 0.5 * (c[e] + c[(e + 1) % 3]);
      if (k_.face(f).crack > 0 && !stays_close(*local, middle)) continue;
      if (apply(*local)) {
        ++stats_.flips;
        return true;
      }
    }
    return false;
  }

  bool may_merge(VertexId b, VertexId a) const {
    if (!contacts_.may_omit(b, a)) return false;
    const crack::SurfaceLocation from = crack::location_of(k_, b, rules_), to = crack::location_of(k_, a, rules_);
    if (!crack::lies_within(from, to)) return false;
    const auto off = crack::distance_off_line(k_, from, b, a);
    return off && *off <= options_.deviation * size_;
  }

  bool collapse(FaceId f) {
    const auto c = k_.corners(f);
    const auto v = k_.face(f).v;
    const auto by_length = edges_by_length(c, std::less<>());
    for (std::size_t i = 0; i < 2; ++i)
      for (const bool reversed : {false, true}) {
        const int e = by_length[i];
        const VertexId from = reversed ? v[e] : v[(e + 1) % 3], to = reversed ? v[(e + 1) % 3] : v[e];
        const auto [before, after] = crack::worst_if_moved(k_, from, k_.point(to), to);
        if (after >= 0.999 * before || !may_merge(from, to)) continue;  // as in flip()
        auto local = crack::collapse(k_, from, to);
        if (!local) continue;
        if (!stays_close(*local, k_.point(from))) continue;
        if (!apply(*local)) continue;
        contacts_.omit(from);
        ++stats_.collapses;
        return true;
      }
    return false;
  }

  // Positions where the faces at v may be better: towards the centroid of its neighbours within its
  // surface, or along its feature line.
  std::vector<Vec3> goals_of(VertexId v) const {
    const crack::SurfaceLocation location = crack::location_of(k_, v, rules_);
    const Vec3 p = k_.point(v);
    std::vector<Vec3> goals;
    if (location.features.empty() && location.sources.size() + location.cracks.size() == 1) {
      Vec3 sum = Vec3::Zero(), normal = Vec3::Zero();
      double weight = 0;
      for (const FaceId g : k_.faces_at(v)) {
        const auto t = k_.corners(g);
        const int at = corner_at(k_.face(g), v);
        const Vec3 n = (t[1] - t[0]).cross(t[2] - t[0]);
        sum += t[(at + 1) % 3] + t[(at + 2) % 3];
        weight += 2;
        normal += normal.dot(n) < 0 ? Vec3(-n) : n;
      }
      const Vec3 n = normal.normalized(), to = sum / weight - p;
      goals = {p + (to - to.dot(n) * n), p + 0.5 * (to - to.dot(n) * n)};
    } else if (location.features.size() == 2) {
      const Vec3 a = k_.point(location.features[0]), c = k_.point(location.features[1]);
      if (distance_between_segments(p, p, a, c) > options_.deviation * size_) return {};
      for (const VertexId w : location.features)
        if (crack::lies_within(location, crack::location_of(k_, w, rules_)))
          for (const double t : {0.5, 0.2}) goals.push_back(p + t * (k_.point(w) - p));
    }
    return goals;
  }

  // Moves a corner to where the faces at it are better.
  bool move(FaceId f) {
    for (const VertexId v : k_.face(f).v) {
      if (contacts_.contains(v)) continue;
      const Vec3 p = k_.point(v);
      for (const Vec3& goal : goals_of(v)) {
        if (!goal.allFinite() || goal == p) continue;
        const auto [before, after] = crack::worst_if_moved(k_, v, goal);
        // A move must gain 10 %. Larger factors: more moves with less effect each.
        if (after >= 0.9 * before) continue;
        auto local = crack::relocate(k_, v, goal);
        if (!stays_close(local, p)) continue;
        if (apply(local)) {
          ++stats_.moves;
          return true;
        }
      }
    }
    return false;
  }

  // Bisects the terminal edge of f's longest-edge propagation path (Rivara and Inostroza 1997).
  bool divide(FaceId f) {
    for (int step = 0; step < 64; ++step) {
      const auto c = k_.corners(f);
      int e = 0;
      for (int i = 1; i < 3; ++i)
        if ((c[(i + 1) % 3] - c[i]).squaredNorm() > (c[(e + 1) % 3] - c[e]).squaredNorm()) e = i;
      const VertexId a = k_.face(f).v[e], b = k_.face(f).v[(e + 1) % 3];
      const double length = (k_.point(b) - k_.point(a)).norm();
      FaceId next;
      if (const auto cycle = k_.faces_around(a, b); cycle.size() == 2 && !crack::is_feature_edge(k_, a, b, rules_)) {
        const FaceId g = cycle[0] == f ? cycle[1] : cycle[0];
        const auto t = k_.corners(g);
        // Strictly longer beyond rounding, so that the path cannot return to a face.
        for (int i = 0; i < 3; ++i)
          if ((t[(i + 1) % 3] - t[i]).norm() > length * (1 + 1e-9)) next = g;
      }
      if (next.valid()) {
        f = next;
        continue;
      }
      if (length < 2 * options_.shortest * size_ || (contacts_.contains(a) && contacts_.contains(b))) return false;
      auto local = crack::divide(k_, a, b, 0.5 * (k_.point(a) + k_.point(b)));
      if (!apply(local)) return false;
      ++stats_.divisions;
      return true;
    }
    return false;
  }

  Complex& k_;
  crack::FrontContacts contacts_;
  const RemeshOptions& options_;
  RemeshStats& stats_;
  const Progress& progress_;
  crack::FeatureRules rules_;
  double size_, limit_;
  std::deque<FaceId> todo_;
  std::unordered_set<FaceId> queued_;  // the faces in todo_
  DeltaSum delta_;
};

}  // namespace

double smallest_angle(const std::array<Vec3, 3>& t) {
  return std::atan2(1.0, crack::smallest_angle_cotangent(t)) * 180 / std::numbers::pi;
}

CrackDelta remesh(Complex& complex, std::span<const FaceId> region, std::span<FrontState* const> fronts,
                  const RemeshOptions& options, RemeshStats* stats, const Progress& progress) {
  if (!(options.angle > 0 && options.angle <= 30) || !(options.deviation >= 0) || !(options.shortest > 0) ||
      !(options.crease > 0 && options.crease <= 180))
    throw InputError(
        "remeshing needs an angle of 0 to 30 degrees, a deviation of 0 or more, a shortest edge above 0 and a crease "
        "of 0 to 180 degrees");
  RemeshStats done;
  Stopwatch watch;
  CrackDelta delta = crack::all_or_nothing(
      complex, fronts, progress, [&] { return Remesher(complex, fronts, options, done, progress).run(region); });
  done.seconds = watch.lap();
  if (stats) {
    stats->faces += done.faces;
    stats->flips += done.flips;
    stats->collapses += done.collapses;
    stats->moves += done.moves;
    stats->divisions += done.divisions;
    stats->refused += done.refused;
    stats->seconds += done.seconds;
  }
  return delta;
}

}  // namespace geo
