// Walls are refined by longest-edge bisection and displaced by fractal noise in each coordinate,
// Σ_o 0.6^o · noise_o(2^o · frequency · p). Where triangles cross (exact test, spatial index), the
// displacement of their vertices is halved, and dropped at the fourth time.
//
// Detail near the skin is noise of the same kind times (1 − depth / width)². There, the triangles
// are refined further along longest-edge propagation paths (Rivara 1997), which keep their angles.
#include "score/jagged.h"

#include <algorithm>
#include <cmath>
#include <queue>
#include <tuple>

#include "base/union_find.h"
#include "crack/index_map.h"
#include "crack/noise.h"
#include "geometry/aabb_tree.h"
#include "geometry/distance.h"
#include "kerf/check.h"
#include "kerf/error.h"
#include "kerf/parallel.h"

namespace geo {
namespace {

std::array<Vec3, 3> corners(const TriangleMesh& mesh, std::size_t t) {
  const auto& c = mesh.triangles[t];
  return {mesh.vertices[c[0]], mesh.vertices[c[1]], mesh.vertices[c[2]]};
}

// A ball around a triangle, and how much larger it is with a bound of the rounding of distances.
struct Reach {
  Vec3 middle;
  double radius, loose;
};

std::vector<Reach> reaches(const TriangleMesh& walls, const TriangleBvh& skin, double margin) {
  const double rounding =
      0x1p-40 * (skin.box().diagonal() + skin.box().lo.cwiseAbs().cwiseMax(skin.box().hi.cwiseAbs()).maxCoeff());
  std::vector<Reach> all(walls.triangles.size());
  for (std::size_t t = 0; t < all.size(); ++t) {
    const auto c = corners(walls, t);
    const Vec3 middle = (c[0] + c[1] + c[2]) / 3;
    double radius = margin;
    for (const Vec3& p : c) radius = std::max(radius, margin + (p - middle).norm());
    all[t] = {middle, radius, (1 + 0x1p-40) * radius + rounding};
  }
  return all;
}

// The triangles by cells of a grid; each inner vector of indices has one cell.
std::vector<std::vector<std::uint32_t>> by_cell(const std::vector<Reach>& reach, const Box3& box, double cell) {
  std::vector<std::vector<std::uint32_t>> cells;
  crack::IndexMap<std::uint64_t, crack::SpreadHash> index;
  for (std::uint32_t t = 0; t < reach.size(); ++t) {
    std::uint64_t at = 0;
    for (int axis = 0; axis < 3; ++axis)  // far cells share a name: this costs time alone
      at = at << 21 | static_cast<std::uint64_t>(
                          std::clamp((reach[t].middle[axis] - box.lo[axis]) / cell + 0x1p19, 0.0, 0x1p21 - 1));
    std::uint32_t& entry = index[at];
    if (entry == ~0u) {
      entry = static_cast<std::uint32_t>(cells.size());
      cells.emplace_back();
    }
    cells[entry].push_back(t);
  }
  return cells;
}

// Whether each triangle is in the material or at most `margin` outside.
std::vector<std::uint8_t> near_or_inside(const TriangleMesh& walls, const TriangleBvh& skin, double margin) {
  const std::size_t count = walls.triangles.size();
  const std::vector<Reach> reach = reaches(walls, skin, margin);
  double largest = 0;
  for (const Reach& r : reach) largest = std::max(largest, r.radius - margin);
  // The factor affects speed alone: larger cells need fewer queries, each decides fewer triangles.
  const auto cells = by_cell(reach, skin.box(), std::max(3 * largest, 1e-6 * skin.box().diagonal()));
  std::vector<std::uint8_t> keep(count), clear(count);  // clear: certainly without a point of the skin
  parallel_for(cells.size(), 32, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      // The skin nearest to one triangle of the cell decides most of the others.
      const Vec3& from = reach[cells[i].front()].middle;
      double cutoff = 0;
      for (const auto t : cells[i]) cutoff = std::max(cutoff, (reach[t].middle - from).norm() + reach[t].loose);
      const auto nearest = skin.closest(from, cutoff);
      for (const auto t : cells[i]) {
        const auto& [middle, radius, loose] = reach[t];
        clear[t] = nearest.triangle == ~0u || (middle - from).norm() + loose < nearest.distance;
        if (clear[t]) continue;
        const auto& s = skin.corners(nearest.triangle);
        keep[t] = (closest_point_on_triangle(middle, s[0], s[1], s[2]) - middle).squaredNorm() <= radius * radius;
        if (keep[t]) continue;
        const auto found = skin.closest(middle, loose, radius);
        clear[t] = found.triangle == ~0u;
        keep[t] = !clear[t] && (found.distance <= radius || skin.inside(middle));
      }
    }
  });
  // Clear triangles that are connected are all inside, or all outside.
  UnionFind joined(count);
  std::vector<std::uint32_t> at(walls.vertices.size(), ~0u);
  for (std::uint32_t t = 0; t < count; ++t)
    for (const auto v : walls.triangles[t]) {
      if (!clear[t]) break;
      if (at[v] == ~0u) at[v] = t;
      joined.unite(at[v], t);
    }
  for (std::uint32_t t = 0; t < count; ++t)
    if (clear[t]) keep[t] = joined.find(t) == t ? skin.inside(reach[t].middle) : keep[joined.find(t)];
  return keep;
}

// Drops the triangles farther outside the material than `margin`, and vertices without triangles.
void trim(TriangleMesh& walls, const TriangleBvh& skin, double margin) {
  const auto keep = near_or_inside(walls, skin, margin);
  std::vector<std::uint32_t> index(walls.vertices.size(), ~0u);
  TriangleMesh kept;
  for (std::size_t t = 0; t < keep.size(); ++t) {
    if (!keep[t]) continue;
    Triangle triangle = walls.triangles[t];
    for (auto& v : triangle) {
      if (index[v] == ~0u) {
        index[v] = static_cast<std::uint32_t>(kept.vertices.size());
        kept.vertices.push_back(walls.vertices[v]);
      }
      v = index[v];
    }
    kept.triangles.push_back(triangle);
  }
  walls = std::move(kept);
}

// A finer limit on the length of edges whose middle is within `width` of the skin: `longest` there,
// and three times as much at that depth.
struct FineRegion {
  const TriangleBvh& skin;
  double width, longest;
};

// Bisects edges, the longest first: each is then the longest of all its triangles, so that small
// angles stay bounded. In a fine region, longer edges of its triangles come before an edge.
class Bisection {
 public:
  Bisection(TriangleMesh& walls, double longest, const FineRegion* fine = nullptr)
      : walls_(walls), longest_(longest), fine_(fine) {
    crack::IndexMap<std::uint64_t, crack::SpreadHash> index;
    for (std::uint32_t t = 0; t < walls.triangles.size(); ++t) {
      const Triangle& v = walls.triangles[t];
      edges_of_.emplace_back();
      for (std::size_t k = 0; k < 3; ++k) {
        const auto a = std::min(v[k], v[(k + 1) % 3]), b = std::max(v[k], v[(k + 1) % 3]);
        std::uint32_t& edge = index[std::uint64_t(a) << 32 | b];
        if (edge == ~0u) edge = add_edge(a, b);
        edges_of_[t][k] = edge;
        add_use(edge, t);
      }
    }
  }

  void run() {
    while (!queue_.empty()) {
      const std::uint32_t edge = queue_.top().edge;
      queue_.pop();
      if (fine_)
        for (std::uint32_t longer = longer_beside(edge); longer != ~0u; longer = longer_beside(edge)) {
          for (std::uint32_t next = longer; next != ~0u; next = longer_beside(next)) longer = next;
          bisect(longer);
        }
      if (edges_[edge].first != ~0u) bisect(edge);
    }
  }

 private:
  struct Edge {
    std::uint32_t a, b;                     // vertices, a < b
    std::uint32_t first = ~0u, last = ~0u;  // its uses, in the order in which they were added; none: bisected
  };
  struct Use {
    std::uint32_t triangle, next;
  };
  struct Entry {
    double length2;
    std::uint32_t a, b, edge;
    bool operator<(const Entry& o) const { return std::tie(length2, o.a, o.b) < std::tie(o.length2, a, b); }
  };

  double length2_of(std::uint32_t a, std::uint32_t b) const {
    return (walls_.vertices[a] - walls_.vertices[b]).squaredNorm();
  }
  // Whether an edge is in the fine region, and too long for it.
  bool is_coarse(std::uint32_t a, std::uint32_t b, double length2) const {
    if (!fine_ || !(length2 > fine_->longest * fine_->longest)) return false;
    const auto nearest = fine_->skin.closest(0.5 * (walls_.vertices[a] + walls_.vertices[b]), fine_->width);
    const double limit = fine_->longest * (1 + 2 * nearest.distance / fine_->width);
    return nearest.triangle != ~0u && length2 > limit * limit;
  }
  // An edge of the triangles at this one that is longer, by its place in the queue; ~0u: none.
  std::uint32_t longer_beside(std::uint32_t edge) const {
    const auto entry = [&](std::uint32_t e) {
      return Entry{.length2 = length2_of(edges_[e].a, edges_[e].b), .a = edges_[e].a, .b = edges_[e].b, .edge = e};
    };
    const Entry own = entry(edge);
    for (auto use = edges_[edge].first; use != ~0u; use = uses_[use].next)
      for (const auto other : edges_of_[uses_[use].triangle])
        if (own < entry(other)) return other;
    return ~0u;
  }

  std::uint32_t add_edge(std::uint32_t a, std::uint32_t b) {
    const auto edge = static_cast<std::uint32_t>(edges_.size());
    edges_.push_back({.a = std::min(a, b), .b = std::max(a, b)});
    const double length2 = length2_of(a, b);
    if (length2 > longest_ * longest_ || is_coarse(a, b, length2))
      queue_.push({.length2 = length2, .a = std::min(a, b), .b = std::max(a, b), .edge = edge});
    return edge;
  }
  void add_use(std::uint32_t edge, std::uint32_t triangle) {
    const auto use = static_cast<std::uint32_t>(uses_.size());
    uses_.push_back({triangle, ~0u});
    Edge& e = edges_[edge];
    (e.first == ~0u ? e.first : uses_[e.last].next) = use;
    e.last = use;
  }

  void bisect(std::uint32_t edge) {
    const auto [a, b, first, last] = edges_[edge];
    const auto middle = static_cast<std::uint32_t>(walls_.vertices.size());
    walls_.vertices.push_back(0.5 * (walls_.vertices[a] + walls_.vertices[b]));
    const std::uint32_t to_a = add_edge(a, middle), to_b = add_edge(middle, b);
    across_.clear();
    for (auto use = first; use != ~0u; use = uses_[use].next) {
      const std::uint32_t t = uses_[use].triangle, other = static_cast<std::uint32_t>(walls_.triangles.size());
      Triangle v = walls_.triangles[t];
      std::size_t k = 0;
      while (edges_of_[t][k] != edge) ++k;
      const std::uint32_t apex = v[(k + 2) % 3];
      // Two triangles with the same corners share the edge to their apex, too.
      const auto known = std::find_if(across_.begin(), across_.end(), [&](const auto& e) { return e.first == apex; });
      const std::uint32_t across = known == across_.end() ? add_edge(middle, apex) : known->second;
      if (known == across_.end()) across_.push_back({apex, across});
      const bool forward = v[k] == a;  // the triangle keeps a, the other one gets b
      const std::size_t at_a = (k + (forward ? 2 : 1)) % 3, at_b = (k + (forward ? 1 : 2)) % 3;
      auto edges = edges_of_[t];
      for (auto u = edges_[edges[at_b]].first; u != ~0u; u = uses_[u].next)
        if (uses_[u].triangle == t) uses_[u].triangle = other;
      v[forward ? k : (k + 1) % 3] = middle;
      walls_.triangles[t][forward ? (k + 1) % 3 : k] = middle;
      walls_.triangles.push_back(v);
      edges[at_a] = across;
      edges[k] = to_b;
      edges_of_[t][at_b] = across;
      edges_of_[t][k] = to_a;
      edges_of_.push_back(edges);
      add_use(across, t);
      add_use(to_a, t);
      add_use(across, other);
      add_use(to_b, other);
    }
    edges_[edge].first = ~0u;
  }

  TriangleMesh& walls_;
  const double longest_;
  const FineRegion* const fine_;
  std::vector<Edge> edges_;
  std::vector<Use> uses_;
  std::vector<std::array<std::uint32_t, 3>> edges_of_;           // per triangle: from corner k to the next
  std::vector<std::pair<std::uint32_t, std::uint32_t>> across_;  // of the edge at hand: apex, new edge
  std::priority_queue<Entry> queue_;
};

// Finds triangles that cross each other, incrementally.
class Crossings {
 public:
  explicit Crossings(const TriangleMesh& walls) : walls_(walls), at_(walls.vertices.size()) {
    for (std::uint32_t t = 0; t < walls.triangles.size(); ++t)
      for (const auto v : walls.triangles[t]) at_[v].push_back(t);
  }

  // The vertices, ascending, of crossing triangles: among all, or after update(), of pairs with a
  // moved vertex.
  std::vector<std::uint32_t> vertices() {
    std::vector<Box3> boxes;
    boxes.reserve(walls_.triangles.size());
    for (std::size_t t = 0; t < walls_.triangles.size(); ++t) {
      const auto c = corners(walls_, t);
      boxes.push_back(box_of(c[0], c[1], c[2]));
    }
    if (tree_.boxes().empty())
      tree_ = AabbTree(std::move(boxes));
    else
      tree_.refit_or_rebuild(std::move(boxes), {});
    std::vector<std::uint32_t> all;
    for (const auto& [t, other] :
         tree_.pairs(changed_.empty() ? nullptr : &changed_, [this](AabbTree::Pairs& pairs) { keep_crossing(pairs); }))
      for (const auto each : {t, other})
        all.insert(all.end(), walls_.triangles[each].begin(), walls_.triangles[each].end());
    std::sort(all.begin(), all.end());
    all.erase(std::unique(all.begin(), all.end()), all.end());
    return all;
  }

  // Marks the triangles at moved vertices.
  void update(const std::vector<std::uint32_t>& vertices) {
    changed_.assign(walls_.triangles.size(), 0);
    for (const auto v : vertices)
      for (const auto t : at_[v]) changed_[t] = 1;
  }

 private:
  void keep_crossing(AabbTree::Pairs& pairs) const {
    std::erase_if(pairs, [this](const auto& pair) {
      return !faces_cross(walls_.triangles[pair.first], corners(walls_, pair.first), walls_.triangles[pair.second],
                          corners(walls_, pair.second));
    });
  }

  const TriangleMesh& walls_;
  std::vector<std::vector<std::uint32_t>> at_;  // triangles at each vertex
  std::vector<std::uint8_t> changed_;           // per triangle; empty: all
  AabbTree tree_;
};

}  // namespace

void refine_walls(TriangleMesh& walls, const TriangleBvh& skin, double longest, double margin,
                  const std::function<void()>& pause) {
  // Coarsely first: few triangles are divided that are dropped afterwards. The factors change the
  // cost and where triangles are bisected, not the bound on their edges.
  for (const double edge : {8 * longest, 2 * longest, longest}) {
    Bisection(walls, edge).run();
    if (pause) pause();
    trim(walls, skin, margin);
    if (pause) pause();
  }
}

namespace {

// Fractal noise at a point, in model units: `octaves` of them, the first with `frequency` bumps a
// model unit and of height `height`.
Vec3 fractal_noise(const Vec3& p, double height, double frequency, int octaves, std::uint64_t first_seed) {
  Vec3 sum = Vec3::Zero();
  for (int octave = 0; octave < octaves; ++octave, height *= 0.6, frequency *= 2) {
    const std::uint64_t seed = first_seed + static_cast<std::uint64_t>(octave * 3);
    const auto noise = gradient_noises(frequency * p, {seed, seed + 1, seed + 2});
    for (int k = 0; k < 3; ++k) sum[k] += height * noise[std::size_t(k)];
  }
  return sum;
}

// How far a point of flat walls moves.
class Displacement {
 public:
  Displacement(const TriangleBvh& skin, const JaggedOptions& o) : skin_(skin), o_(o), size_(skin.box().diagonal()) {}

  Vec3 at(const Vec3& p) const {
    const Vec3 from = p - skin_.box().lo;
    const std::uint64_t seed = o_.seed * 0x9e3779b97f4a7c15ull;
    Vec3 offset = fractal_noise(from, o_.amplitude * size_, o_.frequency / size_, o_.octaves, seed);
    if (!(o_.edge_amplitude > 0)) return offset;
    const double width = o_.edge_width * size_;
    const auto nearest = skin_.closest(p, width);
    if (nearest.triangle == ~0u) return offset;
    const double fade = std::max(0.0, 1 - nearest.distance / width);
    // Seeds of their own: above those of the 16 octaves that there are at most.
    return offset + fade * fade * fractal_noise(from, o_.edge_amplitude * size_, 2 / width, edge_octaves, seed + 48);
  }

 private:
  static constexpr int edge_octaves = 2;  // the triangles, a quarter of a bump, show no more
  const TriangleBvh& skin_;
  const JaggedOptions& o_;
  const double size_;
};

void require_in_range(const JaggedOptions& o) {
  if (!(o.amplitude >= 0 && o.amplitude < 1) || !(o.frequency > 0 && o.frequency <= 1e4) || o.octaves < 1 ||
      o.octaves > 16 || !(o.edge >= 0))
    throw InputError(
        "the jaggedness's amplitude must be in [0, 1), its frequency positive and at most 10000, its octaves 1 to 16");
  if (!(o.edge_amplitude >= 0 && o.edge_amplitude < 1) || !(o.edge_width >= 1e-3 && o.edge_width <= 1))
    throw InputError("the height of detail at edges must be in [0, 1), its width from 0.001 to 1");
}

}  // namespace

void roughen_walls(TriangleMesh& walls, const TriangleBvh& skin, const JaggedOptions& o,
                   const std::function<void()>& pause) {
  require_in_range(o);
  const double size = skin.box().diagonal(), margin = 4 * (o.amplitude + o.edge_amplitude) * size;
  // Where detail is all, walls are refined near the skin alone.
  const bool flat_inside = o.edge_amplitude > 0 && !(o.amplitude > 0) && !(o.edge > 0);
  const double longest = flat_inside ? 1 : o.edge > 0 ? o.edge : 1 / (8 * o.frequency);
  refine_walls(walls, skin, size * longest, margin, pause);
  if (o.edge_amplitude > 0) {
    // A bump is as wide as half the region of detail, and four triangles at the skin.
    const FineRegion fine{.skin = skin, .width = o.edge_width * size, .longest = o.edge_width * size / 8};
    Bisection(walls, size * longest, &fine).run();
    if (pause) pause();
    trim(walls, skin, margin);
  }
  const std::vector<Vec3> flat = walls.vertices;
  std::vector<Vec3> offset(flat.size(), Vec3::Zero());
  const Displacement displacement(skin, o);
  parallel_for(flat.size(), 256, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      offset[i] = displacement.at(flat[i]);
      walls.vertices[i] = flat[i] + offset[i];
    }
  });
  std::vector<int> lowered(flat.size());
  Crossings crossings(walls);
  for (bool changed = true; changed;) {
    changed = false;
    if (pause) pause();
    std::vector<std::uint32_t> bad = crossings.vertices();
    std::erase_if(bad, [&](std::uint32_t v) { return offset[v].isZero(0); });
    for (const auto v : bad) {
      offset[v] *= ++lowered[v] < 4 ? 0.5 : 0;
      walls.vertices[v] = flat[v] + offset[v];
      changed = true;
    }
    crossings.update(bad);
  }
  trim(walls, skin, 0);
}

}  // namespace geo
