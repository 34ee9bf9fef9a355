#include "kerf/crack_edits.h"

#include <algorithm>
#include <queue>
#include <unordered_map>
#include <unordered_set>

#include "crack/features.h"
#include "crack/noise.h"
#include "kerf/error.h"
#include "kerf/progress.h"
#include "surface/radial_edge.h"

namespace geo {
namespace {

constexpr int rounds = 8;

class Roughener {
 public:
  Roughener(Complex& k, std::span<FrontState* const> fronts, const RoughenOptions& options, RoughenStats& work)
      : k_(k), contacts_(fronts), options_(options), work_(work), size_(k.extent().diagonal()) {
    rules_.crease = -1;  // bends of a crack are not features here
  }

  CrackDelta run() {
    divide(size_ * (options_.edge > 0 ? options_.edge : 1.0 / (12 * options_.frequency)));
    displace();
    return delta_.sum();
  }

 private:
  bool is_chosen(FaceId f) const {
    const auto crack = k_.face(f).crack;
    return k_.alive(f) && crack > 0 &&
           (options_.cracks.empty() || std::count(options_.cracks.begin(), options_.cracks.end(), crack) > 0);
  }
  // Inside one crack, or at its tip where no front holds that.
  bool may_divide(VertexId a, VertexId b) const {
    if (contacts_.holds(a) && contacts_.holds(b)) return false;
    const auto ring = k_.faces_around(a, b);
    return ring.size() <= 2 && is_chosen(ring[0]) && is_chosen(ring[ring.size() - 1]);
  }
  double length_of(FaceId f, int e) const {
    return (k_.point(k_.face(f).v[(e + 1) % 3]) - k_.point(k_.face(f).v[e])).norm();
  }
  int longest_edge(FaceId f) const {
    int best = 0;
    for (int e = 1; e < 3; ++e)
      if (length_of(f, e) > length_of(f, best)) best = e;
    return best;
  }

  bool apply(crack::LocalEdit& local) {
    const auto delta = crack::carry_out(k_, local, delta_);
    if (delta) last_ = delta->new_faces;
    return delta.has_value();
  }

  // Divides the longest edges, each the longest of all its faces (Rivara and Inostroza 1997), so
  // that faces stay about as round as they were. Where the way there ends at an edge that must
  // stay, the faces before it stay as large.
  void divide(double longest) {
    std::vector<FaceId> todo;
    for (std::uint32_t f = 0; f < k_.face_count(); ++f)
      if (is_chosen(FaceId(f))) todo.push_back(FaceId(f));
    while (!todo.empty()) {
      const FaceId f = todo.back();
      todo.pop_back();
      if (!k_.alive(f) || !(length_of(f, longest_edge(f)) > longest)) continue;
      FaceId at = f;
      for (FaceId next = at; next.valid();) {
        at = next;
        next = {};
        const int e = longest_edge(at);
        for (const FaceId g : k_.faces_around(k_.face(at).v[e], k_.face(at).v[(e + 1) % 3]))
          if (length_of(g, longest_edge(g)) > length_of(at, e) * (1 + 1e-9)) next = g;
      }
      const int e = longest_edge(at);
      const VertexId a = k_.face(at).v[e], b = k_.face(at).v[(e + 1) % 3];
      if (!may_divide(a, b)) continue;
      auto local = crack::divide(k_, a, b, 0.5 * (k_.point(a) + k_.point(b)));
      if (!apply(local)) {
        ++work_.refused;
        continue;
      }
      ++work_.divisions;
      todo.push_back(f);
      todo.insert(todo.end(), last_.begin(), last_.end());
    }
  }

  // Ways along edges from what stays as it is, as far as the noise fades.
  std::unordered_map<VertexId, double> distances(const std::vector<VertexId>& vertices,
                                                 const std::unordered_set<VertexId>& free, double reach) const {
    using Way = std::pair<double, VertexId>;
    std::priority_queue<Way, std::vector<Way>, std::greater<>> queue;
    std::unordered_map<VertexId, double> distance;
    for (const VertexId v : vertices)
      if (!free.count(v)) distance[v] = 0, queue.push({0, v});
    while (!queue.empty()) {
      const auto [d, v] = queue.top();
      queue.pop();
      if (d > distance.at(v) || d > reach) continue;
      for (const FaceId f : k_.faces_at(v))
        if (is_chosen(f))
          for (const VertexId w : k_.face(f).v) {
            const double there = d + (k_.point(w) - k_.point(v)).norm();
            const auto [it, fresh] = distance.try_emplace(w, there);
            if (!fresh && there >= it->second) continue;
            it->second = there;
            queue.push({there, w});
          }
    }
    return distance;
  }

  void displace() {
    std::vector<VertexId> vertices;
    for (std::uint32_t f = 0; f < k_.face_count(); ++f)
      if (is_chosen(FaceId(f)))
        vertices.insert(vertices.end(), k_.face(FaceId(f)).v.begin(), k_.face(FaceId(f)).v.end());
    std::sort(vertices.begin(), vertices.end());
    vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
    std::unordered_set<VertexId> free;
    for (const VertexId v : vertices) {
      if (contacts_.holds(v)) continue;
      const auto place = crack::place_of(k_, v, rules_);
      if (place.features.empty() && place.sources.empty() && place.cracks.size() == 1) free.insert(v);
    }
    const double height = options_.amplitude * size_, fade = 3 * height;
    const auto distance = distances(vertices, free, fade);
    struct Move {
      VertexId vertex;
      Vec3 to;
      bool there = false;
    };
    std::vector<Move> moves;
    for (const VertexId v : vertices) {
      if (!free.count(v)) continue;
      Vec3 normal = Vec3::Zero();
      std::int32_t crack = 0;
      for (const FaceId f : k_.faces_at(v)) {
        const auto t = k_.corners(f);
        normal += (t[1] - t[0]).cross(t[2] - t[0]);
        crack = k_.face(f).crack;
      }
      const double length = normal.norm();
      if (!(length > 0)) continue;
      double sum = 0, high = 1, fine = options_.frequency / size_;
      for (int octave = 0; octave < options_.octaves; ++octave, high *= 0.6, fine *= 2)
        sum += high * gradient_noise(fine * (k_.point(v) - k_.extent().lo), options_.seed * 0x9e3779b97f4a7c15ull +
                                                                                static_cast<std::uint64_t>(crack) * 64 +
                                                                                static_cast<std::uint64_t>(octave));
      const auto d = distance.find(v);
      const double near = d == distance.end() ? 1 : std::min(1.0, d->second / fade);
      moves.push_back({v, k_.point(v) + height * near * sum / length * normal});
    }
    // What a neighbour that has not moved yet is in the way of gets there in a later round.
    for (int round = 0; round < rounds; ++round)
      for (Move& move : moves) {
        if (move.there) continue;
        const Vec3 from = k_.point(move.vertex);
        double part = 1;
        for (int tries = 0; tries < 3; ++tries, part *= 0.5) {
          auto local = crack::relocate(k_, move.vertex, part == 1 ? move.to : Vec3(from + part * (move.to - from)));
          const VertexId moved(k_.vertex_count());
          if (!apply(local)) continue;
          move.vertex = moved;
          move.there = part == 1;
          break;
        }
      }
    for (const Move& move : moves) ++work_.moves, work_.lowered += !move.there;
  }

  Complex& k_;
  crack::Contacts contacts_;
  const RoughenOptions& options_;
  RoughenStats& work_;
  crack::PlaceRules rules_;
  double size_;
  std::vector<FaceId> last_;
  DeltaSum delta_;
};

}  // namespace

CrackDelta roughen(Complex& complex, std::span<FrontState* const> fronts, const RoughenOptions& options,
                   RoughenStats* work) {
  if (!(options.amplitude >= 0 && options.amplitude < 1) || !(options.frequency > 0 && options.frequency < 1e6) ||
      options.octaves < 1 || options.octaves > 16 || !(options.edge >= 0))
    throw InputError("the jaggedness's amplitude must be in [0, 1), its frequency positive, its octaves 1 to 16");
  RoughenStats done;
  Stopwatch watch;
  CrackDelta delta = Roughener(complex, fronts, options, done).run();
  done.seconds = watch.lap();
  if (work) *work = done;
  return delta;
}

}  // namespace geo
