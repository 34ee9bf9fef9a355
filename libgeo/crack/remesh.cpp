#include "crack/remesh.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <map>
#include <numbers>
#include <unordered_map>

#include "base/error.h"
#include "base/stopwatch.h"
#include "crack/local_internal.h"
#include "geometry/distance.h"
#include "surface/complex_internal.h"
#include "surface/delta_sum.h"

namespace geo {
namespace {

using crack::LocalEdit;

// The cotangent of a triangle's smallest angle: the smaller the better.
double badness(const Vec3& a, const Vec3& b, const Vec3& c) {
  const double ab = (b - a).squaredNorm(), bc = (c - b).squaredNorm(), ca = (a - c).squaredNorm();
  const double area = (b - a).cross(c - a).norm();
  // The smallest angle is opposite to the shortest side.
  return 0.5 * (ab + bc + ca - 2 * std::min({ab, bc, ca})) / std::max(area, 1e-300);
}
double badness(const std::array<Vec3, 3>& t) { return badness(t[0], t[1], t[2]); }

// What a vertex lies on, and the edges along which it may be moved.
struct Place {
  std::vector<std::uint32_t> sources;  ///< triangles of the input, ascending
  std::vector<std::int32_t> cracks;    ///< ascending
  std::vector<VertexId> features;      ///< other ends of the feature edges at it
};

class Remesher {
 public:
  Remesher(Complex& k, std::span<FrontState* const> fronts, const RemeshOptions& options, RemeshWork& work)
      : k_(k), fronts_(fronts), options_(options), work_(work), size_(k.extent().diagonal()) {
    limit_ = 1 / std::tan(options.angle * std::numbers::pi / 180);
    crease_ = std::cos(options.crease * std::numbers::pi / 180);
    for (const FrontState* front : fronts)
      for (const auto& segment : front->segments)
        for (const auto& p : segment)
          if (p.id.valid()) ++held_[p.id];
  }

  CrackDelta run(std::span<const FaceId> region) {
    for (const FaceId f : region) queue(f);
    // Each face may be asked about again when its neighbours change, but not for ever.
    std::size_t patience = 60 * todo_.size() + 400, divisions = 4 * todo_.size() + 40;
    while (!todo_.empty() && patience-- > 0) {
      const FaceId f = todo_.front();
      todo_.pop_front();
      if (!k_.alive(f)) continue;
      if (badness(k_.corners(f)) <= limit_) continue;
      ++work_.faces;
      if (flip(f) || collapse(f) || move(f)) continue;
      if (divisions > 0 && divide(f)) --divisions;
    }
    return delta_.sum();
  }

 private:
  void queue(FaceId f) {
    if (k_.alive(f) && badness(k_.corners(f)) > limit_) todo_.push_back(f);
  }

  bool is_feature(VertexId a, VertexId b) const {
    const auto ring = k_.around(a, b);
    if (ring.size() != 2) return true;
    const auto &f = k_.face(ring[0]), &g = k_.face(ring[1]);
    if (f.crack != g.crack || (f.crack == 0 && f.source != g.source)) return true;
    const auto p = k_.corners(ring[0]), q = k_.corners(ring[1]);
    const Vec3 m = (p[1] - p[0]).cross(p[2] - p[0]), n = (q[1] - q[0]).cross(q[2] - q[0]);
    const double turn = runs_upwards(f, a, b) == runs_upwards(g, a, b) ? -m.dot(n) : m.dot(n);
    return turn < crease_ * m.norm() * n.norm();
  }

  Place place_of(VertexId v) const {
    Place place;
    std::vector<VertexId> link;
    for (const FaceId f : k_.faces_at(v)) {
      const auto& face = k_.face(f);
      if (face.crack == 0)
        place.sources.push_back(face.source);
      else
        place.cracks.push_back(face.crack);
      for (const VertexId w : face.v)
        if (w != v) link.push_back(w);
    }
    const auto once = [](auto& row) {
      std::sort(row.begin(), row.end());
      row.erase(std::unique(row.begin(), row.end()), row.end());
    };
    once(place.sources), once(place.cracks), once(link);
    for (const VertexId w : link)
      if (is_feature(v, w)) place.features.push_back(w);
    return place;
  }

  // The other feature edge at a vertex that one may slide along from a.
  static std::optional<VertexId> opposite(const Place& place, VertexId a) {
    if (place.features.size() != 2) return {};
    if (place.features[0] == a) return place.features[1];
    if (place.features[1] == a) return place.features[0];
    return {};
  }

  // True when the second lies on all that the first lies on, so that the way between them may.
  static bool lies_within(const Place& some, const Place& all) {
    return std::includes(all.sources.begin(), all.sources.end(), some.sources.begin(), some.sources.end()) &&
           std::includes(all.cracks.begin(), all.cracks.end(), some.cracks.begin(), some.cracks.end());
  }

  static double distance_to_line(const Vec3& p, const Vec3& a, const Vec3& b) {
    const Vec3 along = b - a;
    const double t = std::clamp(along.dot(p - a) / std::max(along.squaredNorm(), 1e-300), 0.0, 1.0);
    return (a + t * along - p).norm();
  }

  // How far `p` is from the nearest of the new faces of a crack (the skin's stay in their planes).
  bool stays_close(const LocalEdit& local, const Vec3& p) const {
    std::map<std::int32_t, double> nearest;
    for (const auto& f : local.edit.new_faces) {
      if (f.crack == 0) continue;
      Vec3 t[3];
      for (int i = 0; i < 3; ++i) t[i] = f.v[i].value < k_.vertex_count() ? k_.point(f.v[i]) : local.edit.new_vertices[f.v[i].value - k_.vertex_count()];
      const double d = (closest_point_on_triangle(p, t[0], t[1], t[2]) - p).norm();
      const auto [it, fresh] = nearest.try_emplace(f.crack, d);
      if (!fresh) it->second = std::min(it->second, d);
    }
    return std::all_of(nearest.begin(), nearest.end(), [&](const auto& n) { return n.second <= options_.deviation * size_; });
  }

  double worst(const std::vector<FaceId>& faces) const {
    double bad = 0;
    for (const FaceId f : faces) bad = std::max(bad, badness(k_.corners(f)));
    return bad;
  }
  double worst_new(const ComplexEdit& edit) const {
    double bad = 0;
    for (const auto& f : edit.new_faces) {
      std::array<Vec3, 3> t;
      for (int i = 0; i < 3; ++i) t[i] = f.v[i].value < k_.vertex_count() ? k_.point(f.v[i]) : edit.new_vertices[f.v[i].value - k_.vertex_count()];
      bad = std::max(bad, badness(t));
    }
    return bad;
  }

  // Carries an edit out if the guard lets it.
  bool apply(LocalEdit& local) {
    const bool free = !options_.may_pass || std::all_of(local.swept.begin(), local.swept.end(), options_.may_pass);
    if (!free || !is_sound(k_, local)) return ++work_.refused, false;
    try {
      const CrackDelta delta = k_.apply(local.edit);
      for (const FaceId f : delta.new_faces) {
        queue(f);
        for (int e = 0; e < 3; ++e)
          for (const FaceId g : k_.around(k_.face(f).v[e], k_.face(f).v[(e + 1) % 3])) queue(g);
      }
      delta_.add(delta);
    } catch (const GeometryError&) {
      return ++work_.refused, false;
    }
    return true;
  }

  bool flip(FaceId f) {
    const auto c = k_.corners(f);
    std::array<int, 3> by_length{0, 1, 2};
    std::sort(by_length.begin(), by_length.end(), [&](int i, int j) { return (c[(i + 1) % 3] - c[i]).squaredNorm() > (c[(j + 1) % 3] - c[j]).squaredNorm(); });
    for (const int e : by_length) {
      if (is_feature(k_.face(f).v[e], k_.face(f).v[(e + 1) % 3])) continue;
      auto local = crack::flip(k_, f, e);
      if (!local || !(worst_new(local->edit) < 0.999 * worst(local->edit.removed_faces))) continue;
      // The edge's middle may not leave the surface.
      const Vec3 middle = 0.5 * (c[e] + c[(e + 1) % 3]);
      if (k_.face(f).crack > 0 && !stays_close(*local, middle)) continue;
      if (apply(*local)) return ++work_.flips, true;
    }
    return false;
  }

  // Contacts that b's disappearance would take from a front; true when each has a as its neighbour and can be left out.
  bool may_leave_front(VertexId b, VertexId a) const {
    if (!held_.count(b)) return true;
    for (const FrontState* front : fronts_)
      for (const auto& segment : front->segments)
        for (std::size_t i = 0; i < segment.size(); ++i)
          if (segment[i].id == b && (i == 0 || i + 1 == segment.size() || (segment[i - 1].id != a && segment[i + 1].id != a))) return false;
    return true;
  }
  void leave_front(VertexId b) {
    if (!held_.erase(b)) return;
    for (FrontState* front : fronts_)
      for (auto& segment : front->segments) std::erase_if(segment, [&](const auto& p) { return p.id == b; });
  }

  bool may_merge(VertexId b, VertexId a) const {
    if (!may_leave_front(b, a)) return false;
    const Place from = place_of(b), to = place_of(a);
    if (!lies_within(from, to)) return false;
    if (from.features.empty()) return true;
    const auto c = opposite(from, a);
    return c && distance_to_line(k_.point(b), k_.point(a), k_.point(*c)) <= options_.deviation * size_;
  }

  bool collapse(FaceId f) {
    const auto c = k_.corners(f);
    const auto v = k_.face(f).v;
    std::array<int, 3> by_length{0, 1, 2};
    std::sort(by_length.begin(), by_length.end(), [&](int i, int j) { return (c[(i + 1) % 3] - c[i]).squaredNorm() < (c[(j + 1) % 3] - c[j]).squaredNorm(); });
    for (int i = 0; i < 2; ++i)
      for (const bool backwards : {false, true}) {
        const int e = by_length[i];
        const VertexId from = backwards ? v[e] : v[(e + 1) % 3], to = backwards ? v[(e + 1) % 3] : v[e];
        if (!may_merge(from, to)) continue;
        auto local = crack::collapse(k_, from, to);
        if (!local || !(worst_new(local->edit) < 0.999 * worst(local->edit.removed_faces))) continue;
        if (!stays_close(*local, k_.point(from))) continue;
        if (!apply(*local)) continue;
        leave_front(from);
        return ++work_.collapses, true;
      }
    return false;
  }

  // Moves a corner within its surface, or along its line, to where its faces are better.
  bool move(FaceId f) {
    for (const VertexId v : k_.face(f).v) {
      if (held_.count(v)) continue;
      const Place place = place_of(v);
      std::vector<Vec3> goals;
      const Vec3 p = k_.point(v);
      if (place.features.empty() && place.sources.size() + place.cracks.size() == 1) {
        Vec3 sum = Vec3::Zero(), normal = Vec3::Zero();
        double weight = 0;
        for (const FaceId g : k_.faces_at(v)) {
          const auto t = k_.corners(g);
          const int at = corner_at(k_.face(g), v);
          const Vec3 n = (t[1] - t[0]).cross(t[2] - t[0]);
          sum += t[(at + 1) % 3] + t[(at + 2) % 3], weight += 2;
          normal += normal.dot(n) < 0 ? Vec3(-n) : n;
        }
        const Vec3 n = normal.normalized(), to = sum / weight - p;
        goals = {p + (to - to.dot(n) * n), p + 0.5 * (to - to.dot(n) * n)};
      } else if (place.features.size() == 2) {
        const Vec3 a = k_.point(place.features[0]), c = k_.point(place.features[1]);
        if (distance_to_line(p, a, c) > options_.deviation * size_) continue;
        for (const VertexId w : place.features)
          if (lies_within(place, place_of(w)))
            for (const double t : {0.5, 0.2}) goals.push_back(p + t * (k_.point(w) - p));
      }
      for (const Vec3& goal : goals) {
        if (!goal.allFinite() || goal == p) continue;
        auto local = crack::relocate(k_, v, goal);
        if (!(worst_new(local.edit) < 0.9 * worst(local.edit.removed_faces)) || !stays_close(local, p)) continue;
        if (apply(local)) return ++work_.moves, true;
      }
    }
    return false;
  }

  // Divides the longest edge at the end of the way over ever longer ones (Rivara and Inostroza 1997).
  bool divide(FaceId f) {
    for (int way = 0; way < 64; ++way) {
      const auto c = k_.corners(f);
      int e = 0;
      for (int i = 1; i < 3; ++i)
        if ((c[(i + 1) % 3] - c[i]).squaredNorm() > (c[(e + 1) % 3] - c[e]).squaredNorm()) e = i;
      const VertexId a = k_.face(f).v[e], b = k_.face(f).v[(e + 1) % 3];
      const double length = (k_.point(b) - k_.point(a)).norm();
      FaceId next;
      if (const auto ring = k_.around(a, b); ring.size() == 2 && !is_feature(a, b)) {
        const FaceId g = ring[0] == f ? ring[1] : ring[0];
        const auto t = k_.corners(g);
        for (int i = 0; i < 3; ++i)
          if ((t[(i + 1) % 3] - t[i]).norm() > length * (1 + 1e-9)) next = g;
      }
      if (next.valid()) {
        f = next;
        continue;
      }
      if (length < 2 * options_.shortest * size_ || (held_.count(a) && held_.count(b))) return false;
      auto local = crack::divide(k_, a, b, 0.5 * (k_.point(a) + k_.point(b)));
      if (!apply(local)) return false;
      ++work_.divisions;
      return true;
    }
    return false;
  }

  Complex& k_;
  std::span<FrontState* const> fronts_;
  const RemeshOptions& options_;
  RemeshWork& work_;
  double size_, limit_, crease_;
  std::deque<FaceId> todo_;
  std::unordered_map<VertexId, int> held_;  // contacts of fronts
  DeltaSum delta_;
};

}  // namespace

double smallest_angle(const std::array<Vec3, 3>& t) { return std::atan2(1.0, badness(t)) * 180 / std::numbers::pi; }

CrackDelta remesh(Complex& complex, std::span<const FaceId> region, std::span<FrontState* const> fronts, const RemeshOptions& options, RemeshWork* work) {
  RemeshWork done;
  Stopwatch watch;
  CrackDelta delta = Remesher(complex, fronts, options, done).run(region);
  done.seconds = watch.lap();
  if (work) {
    work->faces += done.faces, work->flips += done.flips, work->collapses += done.collapses, work->moves += done.moves;
    work->divisions += done.divisions, work->refused += done.refused, work->seconds += done.seconds;
  }
  return delta;
}

}  // namespace geo
