// find_pieces() and piece_mesh() of kerf/pieces.h.
//
// Shells are the connected components of S_A, flooded across wedges; their volumes are Kahan sums.
// Shells joined by crack faces form a group, which divides space (Alexander duality). Cavities and
// internal cracks belong to the smallest outer shell around them (point in solid test).
#include "kerf/pieces.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/union_find.h"
#include "geometry/bvh.h"
#include "geometry/predicates.h"
#include "surface/piece_sides.h"

namespace geo {
namespace {

// A connected component of the derived surface S_A.
struct Shell {
  std::vector<Side> sides;
  double volume = 0;
};

std::vector<Shell> find_shells(const Complex& k, std::vector<std::int32_t>& of_side) {
  of_side.assign(static_cast<std::size_t>(k.face_count()) * 2, -1);
  std::vector<Shell> shells;
  const Vec3 origin = k.extent().center();
  for (std::uint32_t f = 0; f < k.face_count(); ++f)
    for (int which = 0; which < 2; ++which) {
      const Side start{FaceId(f), which};
      if (!k.alive(FaceId(f)) || !k.has(start) || of_side[f * 2 + which] >= 0) continue;
      const auto id = static_cast<std::int32_t>(shells.size());
      Shell shell;
      std::vector<Side> stack{start};
      of_side[f * 2 + which] = id;
      double compensation = 0;  // Kahan summation
      while (!stack.empty()) {
        const Side s = stack.back();
        stack.pop_back();
        shell.sides.push_back(s);
        const auto c = k.corners(s.face);
        const double part = (c[0] - origin).dot((c[1] - origin).cross(c[2] - origin)) / 6;
        const double y = (s.which == 0 ? part : -part) - compensation, t = shell.volume + y;
        compensation = (t - shell.volume) - y;
        shell.volume = t;
        for (int e = 0; e < 3; ++e) {
          const Side n = k.neighbor(s, e);
          auto& mark = of_side[n.face.index() * 2 + n.which];
          if (mark < 0) {
            mark = id;
            stack.push_back(n);
          }
        }
      }
      std::sort(shell.sides.begin(), shell.sides.end());
      shells.push_back(std::move(shell));
    }
  return shells;
}

// Groups of shells that are connected by shared faces: the group of each shell.
std::vector<std::uint32_t> group(std::size_t shells, const std::vector<std::int32_t>& of_side) {
  UnionFind joined(shells);
  for (std::size_t f = 0; f + 1 < of_side.size(); f += 2)
    if (of_side[f] >= 0 && of_side[f + 1] >= 0)
      joined.unite(static_cast<std::uint32_t>(of_side[f]), static_cast<std::uint32_t>(of_side[f + 1]));
  std::vector<std::uint32_t> group(shells);
  for (std::uint32_t s = 0; s < shells; ++s) group[s] = joined.find(s);
  return group;
}

// The shell of a group that looks outwards, at what surrounds the group: it has corners at the
// extreme points. Among several such shells it is the one with the most volume outside.
std::uint32_t outward(const Complex& k, const std::vector<Shell>& shells, std::vector<std::uint32_t> of_group) {
  for (int direction = 0; direction < 6 && of_group.size() > 1; ++direction) {
    const auto farther = [&](VertexId a, VertexId b) {
      for (int i = 0; i < 3; ++i) {
        const double xa = k.point(a)[(direction + i) % 3], xb = k.point(b)[(direction + i) % 3];
        if (xa != xb) return direction < 3 ? xa > xb : xa < xb;
      }
      return a < b;
    };
    VertexId extreme;
    std::vector<std::uint32_t> touching;
    for (const auto s : of_group)
      for (const Side side : shells[s].sides)
        for (const VertexId v : k.face(side.face).v) {
          if (!extreme.valid() || farther(v, extreme)) {
            extreme = v;
            touching.clear();
          }
          if (v == extreme && (touching.empty() || touching.back() != s)) touching.push_back(s);
        }
    of_group = touching;
  }
  return *std::min_element(of_group.begin(), of_group.end(),
                           [&](auto a, auto b) { return shells[a].volume < shells[b].volume; });
}

// True for shells that bound a piece from outside.
//
// Connected faces divide space into one region for each of their shells, air included (Alexander
// duality). All regions but one are enclosed by the faces: each is a piece of material, however
// thin, whatever volume rounding gives it. The region around them is air where the faces have skin
// that encloses something, else the inside of another piece.
std::vector<std::uint8_t> find_outer(const Complex& k, const std::vector<Shell>& shells,
                                     const std::vector<std::uint32_t>& root) {
  std::vector<std::vector<std::uint32_t>> groups(shells.size());
  for (std::uint32_t s = 0; s < shells.size(); ++s) groups[root[s]].push_back(s);
  std::vector<std::uint8_t> outer(shells.size(), 1);
  for (const auto& members : groups) {
    if (members.empty()) continue;
    bool skin = false;
    double volume = 0;  // enclosed by the skin: faces between two shells cancel
    for (const auto s : members) {
      volume += shells[s].volume;
      for (const Side side : shells[s].sides) skin |= k.face(side.face).crack == 0;
    }
    if (!(skin && volume > 0)) outer[outward(k, shells, members)] = 0;
  }
  return outer;
}

// The outer shell of the piece that each shell bounds. Cavities and internal cracks belong to the
// smallest outer shell around them, which is not of their group.
std::vector<std::uint32_t> find_owners(const Complex& k, const std::vector<Shell>& shells,
                                       const std::vector<std::uint32_t>& root,
                                       const std::vector<std::uint8_t>& is_outer,
                                       const std::vector<std::uint32_t>& outer) {
  std::vector<std::uint32_t> owner(shells.size());
  std::vector<TriangleBvh> trees(shells.size());
  for (std::uint32_t s = 0; s < shells.size(); ++s) {
    owner[s] = s;
    if (is_outer[s]) continue;
    double best = std::numeric_limits<double>::infinity();
    for (const auto o : outer) {
      if (root[o] == root[s] || shells[o].volume >= best) continue;
      if (trees[o].empty()) {
        std::vector<std::array<Vec3, 3>> soup;
        for (const Side side : shells[o].sides) soup.push_back(k.corners(side.face));
        trees[o] = TriangleBvh(soup);
      }
      // Any face decides, by its centroid: two shells may touch at vertices and edges.
      for (const Side side : shells[s].sides) {
        const auto c = k.corners(side.face);
        const Vec3 middle = (c[0] + c[1] + c[2]) / 3;
        if (trees[o].closest(middle).distance == 0) continue;
        if (trees[o].inside(middle)) {
          best = shells[o].volume;
          owner[s] = o;
        }
        break;
      }
    }
  }
  return owner;
}

}  // namespace

Pieces find_pieces(const Complex& k) {
  std::vector<std::int32_t> shell_of;
  const auto shells = find_shells(k, shell_of);
  const auto root = group(shells.size(), shell_of);
  const auto is_outer = find_outer(k, shells, root);
  std::vector<std::uint32_t> outer;
  for (std::uint32_t s = 0; s < shells.size(); ++s)
    if (is_outer[s]) outer.push_back(s);

  const auto owner = find_owners(k, shells, root, is_outer, outer);
  Pieces pieces;
  pieces.shells = static_cast<std::uint32_t>(shells.size());
  std::vector<double> volume(shells.size(), 0);
  for (std::uint32_t s = 0; s < shells.size(); ++s) volume[owner[s]] += shells[s].volume;
  std::stable_sort(outer.begin(), outer.end(), [&](auto a, auto b) { return volume[a] > volume[b]; });
  std::vector<std::int32_t> number(shells.size(), -1);
  for (const auto o : outer) {
    number[o] = static_cast<std::int32_t>(pieces.count++);
    pieces.volume.push_back(volume[o]);
  }
  pieces.of_side.assign(shell_of.size(), -1);
  for (std::size_t i = 0; i < shell_of.size(); ++i)
    if (shell_of[i] >= 0) pieces.of_side[i] = number[owner[static_cast<std::size_t>(shell_of[i])]];
  return pieces;
}

std::vector<std::vector<Side>> sides_by_piece(const Pieces& pieces) {
  std::vector<std::vector<Side>> sides(pieces.count);
  for (std::size_t i = 0; i < pieces.of_side.size(); ++i)
    if (const auto piece = pieces.of_side[i]; piece >= 0)
      sides[static_cast<std::size_t>(piece)].push_back({FaceId(static_cast<std::uint32_t>(i / 2)), int(i % 2)});
  return sides;
}

TriangleMesh mesh_of_sides(const Complex& k, std::span<const Side> sides, std::vector<std::uint32_t>& index,
                           std::vector<SurfaceVertexId>& vertex_of) {
  TriangleMesh mesh;
  mesh.triangles.reserve(sides.size());
  mesh.patch.reserve(sides.size());
  mesh.source.reserve(sides.size());
  vertex_of.clear();
  for (const Side side : sides) {
    const auto& face = k.face(side.face);
    Triangle t;
    for (int c = 0; c < 3; ++c) {
      const SurfaceVertexId v = k.surface_vertex(side, c);
      if (index[v.index()] == ~0u) {
        index[v.index()] = static_cast<std::uint32_t>(mesh.vertices.size());
        mesh.vertices.push_back(k.point(k.site(v)));
        mesh.site.push_back(k.site(v).value);
        vertex_of.push_back(v);
      }
      t[c] = index[v.index()];
    }
    if (side.which == 1) std::swap(t[1], t[2]);
    mesh.triangles.push_back(t);
    mesh.patch.push_back(side.which == 0 ? face.crack : -face.crack);
    mesh.source.push_back(face.source);
  }
  for (const SurfaceVertexId v : vertex_of) index[v.index()] = ~0u;
  return mesh;
}

TriangleMesh piece_mesh(const Complex& k, const Pieces& pieces, std::uint32_t piece,
                        std::vector<SurfaceVertexId>* vertex_of) {
  std::vector<Side> sides;
  for (std::size_t i = 0; i < pieces.of_side.size(); ++i)
    if (pieces.of_side[i] == static_cast<std::int32_t>(piece))
      sides.push_back({FaceId(static_cast<std::uint32_t>(i / 2)), int(i % 2)});
  std::vector<std::uint32_t> index(k.surface_vertex_count(), ~0u);
  std::vector<SurfaceVertexId> vertices;
  return mesh_of_sides(k, sides, index, vertex_of ? *vertex_of : vertices);
}

}  // namespace geo
