// repair() of kerf/check.h.
//
// Phases: weld, drop degenerate and duplicate triangles, orient components by flood fill (majority
// wins), fill the loops of open edges, arrange shells by nesting depth. A shell at odd depth is a
// cavity if it was oriented against the shell around it, else it is dropped.
#include "kerf/check.h"

#include <algorithm>
#include <map>
#include <set>
#include <span>
#include <tuple>

#include "geometry/bvh.h"
#include "geometry/predicates.h"
#include "geometry/triangle_index.h"
#include "surface/fair_patch.h"
#include "surface/polygon.h"
#include "surface/weld.h"

namespace geo {
namespace {

using Edge = std::pair<std::uint32_t, std::uint32_t>;

// An edge of a triangle.
struct HalfEdge {
  Edge edge;  // ascending
  std::uint32_t triangle;
  int corner;  // where it starts
  friend bool operator<(const HalfEdge& a, const HalfEdge& b) {
    return std::tie(a.edge, a.triangle, a.corner) < std::tie(b.edge, b.triangle, b.corner);
  }
};

// The half-edges of all triangles, sorted by edge.
std::vector<HalfEdge> half_edges_of(const TriangleMesh& mesh) {
  std::vector<HalfEdge> half_edges;
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t)
    for (int k = 0; k < 3; ++k)
      half_edges.push_back({std::minmax({mesh.triangles[t][k], mesh.triangles[t][(k + 1) % 3]}), t, k});
  std::sort(half_edges.begin(), half_edges.end());
  return half_edges;
}

// Calls call(half-edges) for each edge.
template <class Call>
void each_edge(const std::vector<HalfEdge>& half_edges, const Call& call) {
  for (std::size_t i = 0, end = 0; i < half_edges.size(); i = end) {
    while (end < half_edges.size() && half_edges[end].edge == half_edges[i].edge) ++end;
    call(std::span(half_edges).subspan(i, end - i));
  }
}

// Removes the triangles that are not kept, with their attributes.
void keep(TriangleMesh& mesh, const std::vector<char>& kept) {
  const auto filter = [&](auto& values) {
    if (values.empty()) return;
    std::size_t count = 0;
    for (std::size_t t = 0; t < kept.size(); ++t)
      if (kept[t]) values[count++] = values[t];
    values.resize(count);
  };
  Attributes& a = mesh.attributes;
  filter(mesh.triangles);
  filter(mesh.source);
  filter(a.uv);
  filter(a.uv2);
  filter(a.normal);
  filter(a.color);
  filter(a.group);
}

// Reverses the orientation of a triangle; its normals turn outwards.
void flip(TriangleMesh& mesh, std::uint32_t t) {
  std::swap(mesh.triangles[t][1], mesh.triangles[t][2]);
  Attributes& a = mesh.attributes;
  if (!a.uv.empty()) std::swap(a.uv[t][1], a.uv[t][2]);
  if (!a.uv2.empty()) std::swap(a.uv2[t][1], a.uv2[t][2]);
  if (!a.color.empty()) std::swap(a.color[t][1], a.color[t][2]);
  if (a.normal.empty()) return;
  std::swap(a.normal[t][1], a.normal[t][2]);
  const auto& [i, j, k] = mesh.triangles[t];
  const Vec3 outwards = face_normal(mesh.vertices[i], mesh.vertices[j], mesh.vertices[k]);
  for (Vec3& n : a.normal[t])
    if (n.dot(outwards) < 0) n = -n;
}

// Drops triangles with a vertex twice. Among triangles with the same vertices it keeps one, of the
// majority's orientation, or none where the orientations cancel.
std::size_t drop_degenerate(TriangleMesh& mesh) {
  std::map<Triangle, std::pair<int, std::vector<std::uint32_t>>> same;
  std::vector<char> kept(mesh.triangles.size(), 0);
  const auto orientation = [&](std::uint32_t t) {  // relative to ascending vertices
    const auto& [a, b, c] = mesh.triangles[t];
    return ((a > b) + (a > c) + (b > c)) % 2 == 0 ? 1 : -1;
  };
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    Triangle sorted = mesh.triangles[t];
    std::sort(sorted.begin(), sorted.end());
    if (sorted[0] == sorted[1] || sorted[1] == sorted[2]) continue;
    auto& [sum, triangles] = same[sorted];
    sum += orientation(t), triangles.push_back(t);
  }
  for (const auto& [sorted, found] : same)
    for (const auto t : found.second)
      if (found.first * orientation(t) > 0) {
        kept[t] = 1;
        break;
      }
  const auto dropped = static_cast<std::size_t>(std::count(kept.begin(), kept.end(), 0));
  if (dropped > 0) keep(mesh, kept);
  return dropped;
}

// Connected components of triangles, across edges of two triangles.
struct Components {
  std::vector<std::uint32_t> of;  // per triangle
  std::uint32_t count = 0;
};

// Orients neighbours alike; a component turns the smaller part of its triangles.
Components orient(TriangleMesh& mesh) {
  const std::size_t n = mesh.triangles.size();
  std::vector<std::array<std::uint32_t, 3>> beside(n, {~0u, ~0u, ~0u});
  std::vector<std::array<char, 3>> against(n, {0, 0, 0});
  each_edge(half_edges_of(mesh), [&](std::span<const HalfEdge> s) {
    if (s.size() != 2) return;
    const bool same = mesh.triangles[s[0].triangle][s[0].corner] == mesh.triangles[s[1].triangle][s[1].corner];
    beside[s[0].triangle][s[0].corner] = s[1].triangle, beside[s[1].triangle][s[1].corner] = s[0].triangle;
    against[s[0].triangle][s[0].corner] = against[s[1].triangle][s[1].corner] = same;
  });
  Components components{std::vector<std::uint32_t>(n, ~0u)};
  std::vector<char> reversed(n, 0);
  for (std::uint32_t seed = 0; seed < n; ++seed) {
    if (components.of[seed] != ~0u) continue;
    std::vector<std::uint32_t> component{seed};
    components.of[seed] = components.count;
    std::size_t flips = 0;
    for (std::size_t i = 0; i < component.size(); ++i)
      for (int k = 0; k < 3; ++k) {
        const auto t = component[i], next = beside[t][k];
        if (next == ~0u || components.of[next] != ~0u) continue;
        components.of[next] = components.count;
        reversed[next] = reversed[t] != against[t][k];
        flips += reversed[next], component.push_back(next);
      }
    const bool majority = 2 * flips > component.size();
    for (const auto t : component)
      if (bool(reversed[t]) != majority) flip(mesh, t);
    ++components.count;
  }
  return components;
}

// The rims of holes: loops of edges with one triangle, as the half-edges along them. A loop that
// passes a vertex twice is divided in two.
std::vector<std::vector<HalfEdge>> rims_of(const TriangleMesh& mesh) {
  std::multimap<std::uint32_t, HalfEdge> from;  // by the end of the half-edge: a hole runs against its rim
  each_edge(half_edges_of(mesh), [&](std::span<const HalfEdge> s) {
    if (s.size() == 1) from.emplace(mesh.triangles[s[0].triangle][(s[0].corner + 1) % 3], s[0]);
  });
  std::vector<std::vector<HalfEdge>> rims;
  while (!from.empty()) {
    std::vector<HalfEdge> path;
    std::map<std::uint32_t, std::size_t> position;  // of the vertices on the path
    for (std::uint32_t v = from.begin()->first;;) {
      if (const auto seen = position.find(v); seen != position.end()) {
        const std::size_t first = seen->second;
        rims.emplace_back(path.begin() + static_cast<std::ptrdiff_t>(first), path.end());
        for (std::size_t i = first; i < path.size(); ++i)
          position.erase(mesh.triangles[path[i].triangle][(path[i].corner + 1) % 3]);
        path.resize(first);
      }
      const auto next = from.find(v);
      if (next == from.end()) break;  // also where edges of three triangles end a rim
      position[v] = path.size();
      path.push_back(next->second);
      from.erase(next);
      v = mesh.triangles[path.back().triangle][path.back().corner];
    }
  }
  return rims;
}

// Adds a patch over the hole with this rim. Its attributes extend those of the rim inwards.
void add_patch(TriangleMesh& mesh, const std::vector<HalfEdge>& rim, const FairPatch& patch) {
  const auto corners = static_cast<std::uint32_t>(rim.size()), first = static_cast<std::uint32_t>(mesh.vertices.size()),
             first_triangle = static_cast<std::uint32_t>(mesh.triangles.size());
  mesh.vertices.insert(mesh.vertices.end(), patch.inner.begin(), patch.inner.end());
  const auto vertex_of = [&](std::uint32_t c) {
    return c < corners ? mesh.triangles[rim[c].triangle][(rim[c].corner + 1) % 3] : first + c - corners;
  };
  const auto rim_of = [&](std::uint32_t c) {
    while (c >= corners) c = patch.between[c - corners][0];
    return rim[c].triangle;
  };
  for (const auto& [a, b, c] : patch.triangles) mesh.triangles.push_back({vertex_of(a), vertex_of(b), vertex_of(c)});
  const auto spread = [&](auto& values, const auto& at_inner) {
    if (values.empty()) return;
    std::vector<typename std::decay_t<decltype(values[0])>::value_type> at;
    for (const HalfEdge& s : rim) at.push_back(values[s.triangle][(s.corner + 1) % 3]);
    at_inner(at);
    for (const auto& [a, b, c] : patch.triangles) values.push_back({at[a], at[b], at[c]});
  };
  const auto means = [&](auto& at) {
    for (const auto& [a, b, c] : patch.between) at.push_back((at[a] + at[b] + at[c]) / 3);
  };
  Attributes& a = mesh.attributes;
  spread(a.uv, means);
  spread(a.uv2, means);
  spread(a.color, means);
  const auto normal_of = [&](std::uint32_t t) {
    return face_normal(mesh.vertices[mesh.triangles[t][0]], mesh.vertices[mesh.triangles[t][1]],
                       mesh.vertices[mesh.triangles[t][2]]);
  };
  if (patch.inner.empty()) {
    for (auto t = first_triangle; t < mesh.triangles.size() && !a.normal.empty(); ++t)
      a.normal.push_back({normal_of(t), normal_of(t), normal_of(t)});
  } else {
    spread(a.normal, [&](auto& at) {
      at.resize(corners + patch.inner.size(), Vec3::Zero());
      for (std::uint32_t t = 0; t < patch.triangles.size(); ++t)
        for (const auto c : patch.triangles[t])
          if (c >= corners) at[c] += normal_of(first_triangle + t);
      for (std::size_t c = corners; c < at.size(); ++c) at[c].normalize();
    });
  }
  for (const auto& corner : patch.triangles) {
    if (!a.group.empty()) a.group.push_back(a.group[rim_of(corner[0])]);
    if (!mesh.source.empty()) mesh.source.push_back(~0u);
  }
}

// Replaces flat patches by fair ones, where no triangles cross and no edge has more than two.
class SmoothPatches {
 public:
  explicit SmoothPatches(TriangleMesh& mesh) : mesh_(mesh), around_(mesh.vertices.size()) {
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) add(t);
  }
  /// Collects the neighbours of vertices in the first `count` triangles: the surface without
  /// patches.
  void collect_neighbours(std::uint32_t count) {
    for (std::uint32_t t = 0; t < count; ++t)
      for (int k = 0; k < 3; ++k)
        around_[mesh_.triangles[t][k]].insert({mesh_.triangles[t][(k + 1) % 3], mesh_.triangles[t][(k + 2) % 3]});
  }
  /// Adds a fair patch for the hole whose flat patch has triangles [first, last), which are ignored
  /// from then on. False when it does not fit.
  bool replace(const std::vector<HalfEdge>& rim, const std::vector<std::uint32_t>& polygon, std::uint32_t first,
               std::uint32_t last) {
    for (auto t = first; t < last; ++t) remove(t);
    const FairPatch patch = fair_patch(positions(polygon), beyond(polygon), [&](std::uint32_t i, std::uint32_t j) {
      return edges_.count(std::minmax(polygon[i], polygon[j])) > 0;
    });
    if (!fits(polygon, patch)) {
      for (auto t = first; t < last; ++t) add(t);
      return false;
    }
    const auto added = static_cast<std::uint32_t>(mesh_.triangles.size());
    add_patch(mesh_, rim, patch);
    for (auto t = added; t < mesh_.triangles.size(); ++t) add(t);
    return true;
  }

 private:
  std::array<Vec3, 3> corners(std::uint32_t t) const {
    return {mesh_.vertices[mesh_.triangles[t][0]], mesh_.vertices[mesh_.triangles[t][1]],
            mesh_.vertices[mesh_.triangles[t][2]]};
  }
  Edge edge(std::uint32_t t, int k) const {
    return std::minmax(mesh_.triangles[t][k], mesh_.triangles[t][(k + 1) % 3]);
  }
  void add(std::uint32_t t) {
    const auto p = corners(t);
    index_.insert(t, box_of(p[0], p[1], p[2]));
    for (int k = 0; k < 3; ++k) ++edges_[edge(t, k)];
  }
  void remove(std::uint32_t t) {
    index_.erase(t);
    for (int k = 0; k < 3; ++k)
      if (const auto at = edges_.find(edge(t, k)); --at->second == 0) edges_.erase(at);
  }
  std::vector<Vec3> positions(const std::vector<std::uint32_t>& polygon) const {
    std::vector<Vec3> at;
    for (const auto v : polygon) at.push_back(mesh_.vertices[v]);
    return at;
  }
  std::vector<std::vector<Vec3>> beyond(const std::vector<std::uint32_t>& polygon) const {
    const auto n = polygon.size();
    std::vector<std::vector<Vec3>> points(n);
    for (std::size_t i = 0; i < n; ++i)
      for (const auto v : around_[polygon[i]])
        if (v != polygon[(i + 1) % n] && v != polygon[(i + n - 1) % n]) points[i].push_back(mesh_.vertices[v]);
    return points;
  }
  // Whether a patch crosses nothing; adds it for the time of the test.
  bool fits(const std::vector<std::uint32_t>& polygon, const FairPatch& patch) {
    const auto n = static_cast<std::uint32_t>(polygon.size()),
               first = static_cast<std::uint32_t>(mesh_.triangles.size());
    const auto vertices = mesh_.vertices.size();
    if (patch.triangles.empty()) return false;
    for (const auto& t : patch.triangles)
      for (int k = 0; k < 3; ++k)
        if (const auto i = t[k], j = t[(k + 1) % 3];
            i < n && j < n && (i + 1) % n != j && (j + 1) % n != i && edges_.count(std::minmax(polygon[i], polygon[j])))
          return false;
    mesh_.vertices.insert(mesh_.vertices.end(), patch.inner.begin(), patch.inner.end());
    const auto vertex_of = [&](std::uint32_t c) {
      return c < n ? polygon[c] : static_cast<std::uint32_t>(vertices) + c - n;
    };
    for (const auto& [a, b, c] : patch.triangles) mesh_.triangles.push_back({vertex_of(a), vertex_of(b), vertex_of(c)});
    auto t = first;
    for (bool fit = true; fit && t < mesh_.triangles.size(); t += fit) {
      const auto p = corners(t);
      near_.clear();
      index_.find(box_of(p[0], p[1], p[2]), near_);
      fit = !collinear(p[0], p[1], p[2]) && std::none_of(near_.begin(), near_.end(), [&](std::uint32_t other) {
        return faces_cross(mesh_.triangles[t], p, mesh_.triangles[other], corners(other));
      });
      if (fit) index_.insert(t, box_of(p[0], p[1], p[2]));
    }
    const bool all = t == mesh_.triangles.size();
    while (t > first) index_.erase(--t);
    mesh_.vertices.resize(vertices), mesh_.triangles.resize(first);
    return all;
  }

  TriangleMesh& mesh_;
  TriangleIndex index_;
  std::map<Edge, int> edges_;                    // number of triangles
  std::vector<std::set<std::uint32_t>> around_;  // neighbours on the surface without patches
  std::vector<std::uint32_t> near_;
};

void fill_holes(TriangleMesh& mesh, RepairStats& done, bool smooth) {
  auto rims = rims_of(mesh);
  std::erase_if(rims, [](const auto& rim) { return rim.size() < 3; });
  if (rims.empty()) return;
  const auto count = [&] { return static_cast<std::uint32_t>(mesh.triangles.size()); };
  std::vector<std::vector<std::uint32_t>> polygons;
  std::vector<std::uint32_t> first{count()};
  for (const auto& rim : rims) {
    auto& polygon = polygons.emplace_back();
    for (const HalfEdge& s : rim) polygon.push_back(mesh.triangles[s.triangle][(s.corner + 1) % 3]);
    add_patch(mesh, rim, {{}, {}, triangles_of(mesh.vertices, polygon)});
    first.push_back(count());
  }
  done.filled_holes += rims.size(), done.added_triangles += count() - first[0];
  if (!smooth) return;
  SmoothPatches patches(mesh);
  patches.collect_neighbours(first[0]);
  std::vector<char> kept(count(), 1);
  for (std::size_t hole = 0; hole < rims.size(); ++hole) {
    if (polygons[hole].size() == 3 || !patches.replace(rims[hole], polygons[hole], first[hole], first[hole + 1]))
      continue;
    std::fill(kept.begin() + first[hole], kept.begin() + first[hole + 1], 0);
    ++done.smooth_fills;
  }
  kept.resize(count(), 1);
  done.added_triangles = static_cast<std::size_t>(std::count(kept.begin() + first[0], kept.end(), 1));
  keep(mesh, kept);
}

// Orients shells outwards. A shell inside another one is a cavity where their orientations
// differed, else it is hidden and dropped.
void arrange_shells(TriangleMesh& mesh, const Components& components, RepairStats& done) {
  struct Shell {
    std::vector<std::uint32_t> triangles;
    std::vector<std::array<Vec3, 3>> corners;
    double volume = 0;
    Box3 box;
    std::uint32_t within = ~0u;
    int depth = 0;
  };
  std::vector<Shell> shells(components.count);
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto& [a, b, c] = mesh.triangles[t];
    Shell& s = shells[components.of[t]];
    s.triangles.push_back(t), s.corners.push_back({mesh.vertices[a], mesh.vertices[b], mesh.vertices[c]});
    for (const Vec3& p : s.corners.back()) s.box.add(p);
  }
  for (Shell& s : shells)
    for (const auto& [a, b, c] : s.corners) s.volume += (a - s.box.lo).dot((b - s.box.lo).cross(c - s.box.lo)) / 6;
  for (Shell& outer : shells) {
    TriangleBvh tree;
    for (Shell& s : shells) {
      if (&s == &outer ||
          !((outer.box.lo.array() < s.box.lo.array()).all() && (s.box.hi.array() < outer.box.hi.array()).all()))
        continue;
      if (tree.empty()) tree = TriangleBvh(outer.corners);
      if (!std::all_of(s.corners.begin(), s.corners.end(),
                       [&](const auto& t) { return tree.inside(t[0]) && tree.inside(t[1]) && tree.inside(t[2]); }))
        continue;
      ++s.depth;
      if (s.within == ~0u || std::abs(outer.volume) < std::abs(shells[s.within].volume))
        s.within = static_cast<std::uint32_t>(&outer - shells.data());
    }
  }
  std::vector<char> kept(mesh.triangles.size(), 1);
  for (const Shell& s : shells) {
    const bool inner = s.depth % 2 == 1, hidden = inner && (s.volume > 0) == (shells[s.within].volume > 0);
    if (hidden) ++done.dropped_shells;
    for (const auto t : s.triangles)
      if (hidden)
        kept[t] = 0;
      else if ((s.volume > 0) == inner)
        flip(mesh, t);
  }
  keep(mesh, kept);
}

// Triangles that begin with their smallest vertex, orientation kept, sorted.
std::vector<Triangle> turned_to_first(std::vector<Triangle> triangles) {
  for (Triangle& t : triangles) std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
  std::sort(triangles.begin(), triangles.end());
  return triangles;
}

// How many triangles were there before with the opposite orientation alone.
std::size_t count_flipped(const std::vector<Triangle>& before, const std::vector<Triangle>& after) {
  const auto had = [&](const Triangle& t) { return std::binary_search(before.begin(), before.end(), t); };
  const std::vector<Triangle> now = turned_to_first(after);
  return static_cast<std::size_t>(std::count_if(now.begin(), now.end(), [&](const Triangle& t) {
    return !had(t) && had({t[0], t[2], t[1]});
  }));
}

void drop_loose_vertices(TriangleMesh& mesh) {
  std::vector<std::uint32_t> index(mesh.vertices.size(), ~0u);
  for (const auto& t : mesh.triangles)
    for (const auto v : t) index[v] = 0;
  std::uint32_t count = 0;
  for (std::size_t v = 0; v < index.size(); ++v)
    if (index[v] == 0) mesh.vertices[count] = mesh.vertices[v], index[v] = count++;
  mesh.vertices.resize(count);
  for (auto& t : mesh.triangles)
    for (auto& v : t) v = index[v];
}

}  // namespace

RepairStats repair(TriangleMesh& mesh, double weld_distance, bool smooth_fill) {
  RepairStats done;
  done.welded_vertices = weld_seams(mesh, weld_distance);
  done.dropped_triangles = drop_degenerate(mesh);
  const std::vector<Triangle> before = turned_to_first(mesh.triangles);
  Components components = orient(mesh);
  fill_holes(mesh, done, smooth_fill);
  if (done.filled_holes > 0) components = orient(mesh);  // a patch may connect components
  arrange_shells(mesh, components, done);
  done.flipped_triangles = count_flipped(before, mesh.triangles);
  drop_loose_vertices(mesh);
  return done;
}

}  // namespace geo
