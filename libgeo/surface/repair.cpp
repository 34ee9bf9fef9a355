// repair() of kerf/repair.h.
//
// Phases: weld, drop degenerate and duplicate triangles, orient components by flood fill (majority
// wins), fill the loops of open edges, arrange shells by nesting and winding number.
#include "kerf/repair.h"

#include <algorithm>
#include <map>
#include <numeric>
#include <set>
#include <span>
#include <tuple>

#include "geometry/predicates.h"
#include "geometry/triangle_index.h"
#include "kerf/check.h"
#include "surface/components.h"
#include "surface/fair_patch.h"
#include "surface/polygon.h"
#include "surface/shells.h"
#include "surface/weld.h"

namespace geo {
namespace {

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
    mesh_.vertices.resize(vertices);
    mesh_.triangles.resize(first);
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
    const auto& polygon = polygons.emplace_back(polygon_of(mesh, rim));
    add_patch(mesh, rim, {{}, {}, triangles_of(mesh.vertices, polygon)});
    first.push_back(count());
  }
  done.filled_holes += rims.size();
  done.added_triangles += count() - first[0];
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

// The fate of a shell.
struct ShellDecision {
  bool kept = true;
  bool outwards = true;      // its orientation in the result
  bool like_around = false;  // in material and oriented like it
};

// Decides about each shell, those around it first. `level`: winding number inside a shell, relative
// to the orientation of the outermost shell around it; material is where it is above 0.
std::vector<ShellDecision> decide_shells(const std::vector<Shell>& shells, InnerShells inner) {
  std::vector<std::uint32_t> order(shells.size());
  std::iota(order.begin(), order.end(), 0u);
  std::stable_sort(order.begin(), order.end(), [&](auto a, auto b) { return shells[a].depth < shells[b].depth; });
  std::vector<ShellDecision> decisions(shells.size());
  std::vector<int> level(shells.size(), 0);
  std::vector<char> reversed(shells.size(), 0);  // whether the outermost shell around it is inside out
  for (const auto s : order) {
    const Shell& shell = shells[s];
    ShellDecision& decision = decisions[s];
    const bool has_parent = shell.parent != ~0u;
    const int around = has_parent ? level[shell.parent] : 0;
    reversed[s] = around > 0 ? reversed[shell.parent] : !shell.outwards;
    const bool outwards = shell.outwards != bool(reversed[s]);
    level[s] = around + (outwards ? 1 : -1);
    const bool bounds = (around > 0) != (level[s] > 0);
    decision.like_around = !bounds;
    decision.kept = bounds;
    decision.outwards = outwards;
    if (inner == InnerShells::by_orientation) continue;
    decision.kept = inner == InnerShells::cavities || shell.depth == 0;
    decision.outwards = shell.depth % 2 == 0;
  }
  return decisions;
}

// Orients shells by their places; leaves out those that bound no material.
void arrange_shells(TriangleMesh& mesh, const Components& components, InnerShells inner, RepairStats& done) {
  const auto shells = arranged_shells(mesh, components.of, components.count, ShellContainment::all_vertices);
  const auto decisions = decide_shells(shells, inner);
  for (std::size_t s = 0; s < shells.size(); ++s) {
    const ShellDecision& decision = decisions[s];
    if (decision.kept && decision.like_around)
      ++done.hollowed_shells;
    else if (decision.kept)
      done.inverted_shells += decision.outwards != shells[s].outwards;
    else if (decision.like_around)
      ++done.dropped_shells;
    else
      ++done.filled_shells;
  }
  std::vector<char> kept(mesh.triangles.size(), 1);
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto s = components.of[t];
    kept[t] = decisions[s].kept;
    if (decisions[s].kept && decisions[s].outwards != shells[s].outwards) flip(mesh, t);
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
    if (index[v] == 0) {
      mesh.vertices[count] = mesh.vertices[v];
      index[v] = count++;
    }
  mesh.vertices.resize(count);
  for (auto& t : mesh.triangles)
    for (auto& v : t) v = index[v];
}

}  // namespace

RepairStats repair(TriangleMesh& mesh, const RepairOptions& options) {
  RepairStats done;
  done.welded_vertices = weld_seams(mesh, options.weld_distance);
  done.dropped_triangles = drop_degenerate(mesh);
  const std::vector<Triangle> before = turned_to_first(mesh.triangles);
  Components components = orient(mesh);
  fill_holes(mesh, done, options.smooth_fill);
  if (done.filled_holes > 0) components = orient(mesh);  // a patch may connect components
  arrange_shells(mesh, components, options.inner, done);
  done.flipped_triangles = count_flipped(before, mesh.triangles);
  drop_loose_vertices(mesh);
  return done;
}

}  // namespace geo
