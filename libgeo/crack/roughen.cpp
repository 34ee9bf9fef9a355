// roughen() of kerf/crack.h.
//
// Longest-edge bisection (Rivara and Inostroza 1997); then each inner vertex moves along its normal
// to p + amplitude · min(1, d / fade) · Σ_o 0.6^o · noise_o(p), d: distance along edges to the
// nearest fixed vertex (Dijkstra). A refused move is tried at 1/2 and 1/4, then in later rounds.
#include "kerf/crack.h"

#include <algorithm>
#include <queue>
#include <unordered_map>
#include <unordered_set>

#include "crack/all_or_nothing.h"
#include "crack/features.h"
#include "crack/local_edit.h"
#include "crack/noise.h"
#include "kerf/error.h"
#include "kerf/progress.h"
#include "surface/radial_edge.h"

namespace geo {
namespace {

// Rounds of displace(). Larger: blocked vertices get nearer to their goals, the cost grows.
constexpr int rounds = 8;

class Roughener {
 public:
  Roughener(Complex& k, std::span<FrontState* const> fronts, const RoughenOptions& options, RoughenStats& stats,
            const Progress& progress)
      : k_(k), contacts_(fronts), options_(options), stats_(stats), progress_(progress), size_(k.extent().diagonal()) {
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
  // True for an edge inside one crack, or at its tip away from fronts.
  bool may_divide(VertexId a, VertexId b) const {
    if (contacts_.contains(a) && contacts_.contains(b)) return false;
    const auto cycle = k_.faces_around(a, b);
    return cycle.size() <= 2 && is_chosen(cycle[0]) && is_chosen(cycle[cycle.size() - 1]);
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
    const auto delta = crack::try_commit(k_, local, delta_);
    if (delta) new_faces_ = delta->new_faces;
    return delta.has_value();
  }

  // Longest-edge bisection (Rivara and Inostroza 1997): each edge divided is the longest of all its
  // faces, so that small angles stay bounded. Where the propagation path ends at an edge that must
  // stay, the faces on the path stay as large as they are.
  void divide(double longest) {
    std::vector<FaceId> todo;
    for (std::uint32_t f = 0; f < k_.face_count(); ++f)
      if (is_chosen(FaceId(f))) todo.push_back(FaceId(f));
    for (std::size_t done = 0; !todo.empty(); ++done) {
      report(progress_, "divide", done, done + todo.size());
      const FaceId f = todo.back();
      todo.pop_back();
      if (!k_.alive(f) || !(length_of(f, longest_edge(f)) > longest)) continue;
      FaceId at = f;
      for (FaceId next = at; next.valid();) {
        at = next;
        next = {};
        const int e = longest_edge(at);
        for (const FaceId g : k_.faces_around(k_.face(at).v[e], k_.face(at).v[(e + 1) % 3]))
          if (length_of(g, longest_edge(g)) > length_of(at, e) * (1 + 1e-9)) next = g;  // longer beyond rounding
      }
      const int e = longest_edge(at);
      const VertexId a = k_.face(at).v[e], b = k_.face(at).v[(e + 1) % 3];
      if (!may_divide(a, b)) continue;
      auto local = crack::divide(k_, a, b, 0.5 * (k_.point(a) + k_.point(b)));
      if (!apply(local)) {
        ++stats_.refused;
        continue;
      }
      ++stats_.divisions;
      todo.push_back(f);
      todo.insert(todo.end(), new_faces_.begin(), new_faces_.end());
    }
  }

  // Distances along edges from the vertices that stay, up to `reach` (Dijkstra).
  std::unordered_map<VertexId, double> distances(const std::vector<VertexId>& vertices,
                                                 const std::unordered_set<VertexId>& free, double reach) const {
    using Entry = std::pair<double, VertexId>;
    std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
    std::unordered_map<VertexId, double> distance;
    for (const VertexId v : vertices)
      if (!free.count(v)) {
        distance[v] = 0;
        queue.push({0, v});
      }
    while (!queue.empty()) {
      const auto [d, v] = queue.top();
      queue.pop();
      if (d > distance.at(v) || d > reach) continue;
      for (const FaceId f : k_.faces_at(v))
        if (is_chosen(f))
          for (const VertexId w : k_.face(f).v) {
            const double through = d + (k_.point(w) - k_.point(v)).norm();
            const auto [it, is_new] = distance.try_emplace(w, through);
            if (!is_new && through >= it->second) continue;
            it->second = through;
            queue.push({through, w});
          }
    }
    return distance;
  }

  struct Move {
    VertexId vertex;
    Vec3 to;
    bool complete = false;
  };

  std::vector<VertexId> chosen_vertices() const {
    std::vector<VertexId> vertices;
    for (std::uint32_t f = 0; f < k_.face_count(); ++f)
      if (is_chosen(FaceId(f)))
        vertices.insert(vertices.end(), k_.face(FaceId(f)).v.begin(), k_.face(FaceId(f)).v.end());
    std::sort(vertices.begin(), vertices.end());
    vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
    return vertices;
  }

  // Fractal noise at a vertex p of a crack: Σ_o 0.6^o · noise_o(2^o · frequency · (p − lo)).
  double noise_at(VertexId v, std::int32_t crack) const {
    double sum = 0, height = 1, frequency = options_.frequency / size_;
    for (int octave = 0; octave < options_.octaves; ++octave, height *= 0.6, frequency *= 2)
      sum += height * gradient_noise(frequency * (k_.point(v) - k_.extent().lo),
                                     options_.seed * 0x9e3779b97f4a7c15ull + static_cast<std::uint64_t>(crack) * 64 +
                                         static_cast<std::uint64_t>(octave));
    return sum;
  }

  // Where the vertices inside the chosen cracks are to go.
  std::vector<Move> plan_moves() const {
    const std::vector<VertexId> vertices = chosen_vertices();
    std::unordered_set<VertexId> free;
    for (const VertexId v : vertices) {
      if (contacts_.contains(v)) continue;
      const auto location = crack::location_of(k_, v, rules_);
      if (location.features.empty() && location.sources.empty() && location.cracks.size() == 1) free.insert(v);
    }
    // The noise grows linearly from 0 at vertices that stay to its full height at distance `fade`.
    // Its slope there is a third of the noise, whatever the amplitude.
    const double height = options_.amplitude * size_, fade = 3 * height;
    const auto distance = distances(vertices, free, fade);
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
      const double sum = noise_at(v, crack);
      const auto d = distance.find(v);
      const double near = d == distance.end() ? 1 : std::min(1.0, d->second / fade);
      moves.push_back({v, k_.point(v) + height * near * sum / length * normal});
    }
    return moves;
  }

  // Moves all vertices, in rounds: a vertex that is blocked by a neighbour may move once the
  // neighbour has.
  void displace() {
    std::vector<Move> moves = plan_moves();
    std::size_t done = 0;
    for (int round = 0; round < rounds; ++round)
      for (Move& move : moves) {
        report(progress_, "displace", done++, moves.size() * rounds);
        if (move.complete) continue;
        const Vec3 from = k_.point(move.vertex);
        double fraction = 1;
        for (int tries = 0; tries < 3; ++tries, fraction *= 0.5) {
          auto local =
              crack::relocate(k_, move.vertex, fraction == 1 ? move.to : Vec3(from + fraction * (move.to - from)));
          const VertexId moved(k_.vertex_count());
          if (!apply(local)) continue;
          move.vertex = moved;
          move.complete = fraction == 1;
          break;
        }
      }
    for (const Move& move : moves) {
      ++stats_.moves;
      stats_.lowered += !move.complete;
    }
  }

  Complex& k_;
  crack::FrontContacts contacts_;
  const RoughenOptions& options_;
  RoughenStats& stats_;
  const Progress& progress_;
  crack::FeatureRules rules_;
  double size_;
  std::vector<FaceId> new_faces_;
  DeltaSum delta_;
};

}  // namespace

CrackDelta roughen(Complex& complex, std::span<FrontState* const> fronts, const RoughenOptions& options,
                   RoughenStats* stats, const Progress& progress) {
  if (!(options.amplitude >= 0 && options.amplitude < 1) || !(options.frequency > 0 && options.frequency < 1e6) ||
      options.octaves < 1 || options.octaves > 16 || !(options.edge >= 0))
    throw InputError("the jaggedness's amplitude must be in [0, 1), its frequency positive, its octaves 1 to 16");
  RoughenStats done;
  Stopwatch watch;
  CrackDelta delta = crack::all_or_nothing(complex, fronts, progress,
                                           [&] { return Roughener(complex, fronts, options, done, progress).run(); });
  done.seconds = watch.lap();
  if (stats) *stats = done;
  return delta;
}

}  // namespace geo
