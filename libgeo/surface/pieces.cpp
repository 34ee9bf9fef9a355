#include "kerf/pieces.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/union_find.h"
#include "geometry/bvh.h"
#include "geometry/predicates.h"

namespace geo {
namespace {

// One connected component of the derived surface.
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
      double carry = 0;  // Kahan's compensation
      while (!stack.empty()) {
        const Side s = stack.back();
        stack.pop_back();
        shell.sides.push_back(s);
        const auto c = k.corners(s.face);
        const double part = (c[0] - origin).dot((c[1] - origin).cross(c[2] - origin)) / 6;
        const double y = (s.which == 0 ? part : -part) - carry, t = shell.volume + y;
        carry = (t - shell.volume) - y;
        shell.volume = t;
        for (int e = 0; e < 3; ++e) {
          const Side n = k.neighbor(s, e);
          auto& mark = of_side[n.face.index() * 2 + n.which];
          if (mark < 0) mark = id, stack.push_back(n);
        }
      }
      std::sort(shell.sides.begin(), shell.sides.end());
      shells.push_back(std::move(shell));
    }
  return shells;
}

// Shells that share faces, in groups: the group of each shell.
std::vector<std::uint32_t> group(std::size_t shells, const std::vector<std::int32_t>& of_side) {
  UnionFind joined(shells);
  for (std::size_t f = 0; f + 1 < of_side.size(); f += 2)
    if (of_side[f] >= 0 && of_side[f + 1] >= 0)
      joined.unite(static_cast<std::uint32_t>(of_side[f]), static_cast<std::uint32_t>(of_side[f + 1]));
  std::vector<std::uint32_t> group(shells);
  for (std::uint32_t s = 0; s < shells; ++s) group[s] = joined.find(s);
  return group;
}

// Of the shells of faces that hang together, one looks outwards at what is around them all: it has
// corners at the extreme points. Where several have, it is the one with the most volume outside.
std::uint32_t outward(const Complex& k, const std::vector<Shell>& shells, std::vector<std::uint32_t> of_group) {
  for (int way = 0; way < 6 && of_group.size() > 1; ++way) {
    const auto farther = [&](VertexId a, VertexId b) {
      for (int i = 0; i < 3; ++i) {
        const double xa = k.point(a)[(way + i) % 3], xb = k.point(b)[(way + i) % 3];
        if (xa != xb) return way < 3 ? xa > xb : xa < xb;
      }
      return a < b;
    };
    VertexId extreme;
    std::vector<std::uint32_t> there;
    for (const auto s : of_group)
      for (const Side side : shells[s].sides)
        for (const VertexId v : k.face(side.face).v) {
          if (!extreme.valid() || farther(v, extreme)) extreme = v, there.clear();
          if (v == extreme && (there.empty() || there.back() != s)) there.push_back(s);
        }
    of_group = there;
  }
  return *std::min_element(of_group.begin(), of_group.end(),
                           [&](auto a, auto b) { return shells[a].volume < shells[b].volume; });
}

// True for shells that bound a piece from outside. Faces that hang together divide space into one
// region for each of the shells that they have, air included (Alexander's duality). All but one of
// these regions are enclosed by them: a piece of material each, however thin, and whatever rounding
// makes of its volume. The one around them is air where they have skin that encloses something,
// else the inside of another piece.
std::vector<std::uint8_t> find_outer(const Complex& k, const std::vector<Shell>& shells,
                                     const std::vector<std::uint32_t>& root) {
  std::vector<std::vector<std::uint32_t>> groups(shells.size());
  for (std::uint32_t s = 0; s < shells.size(); ++s) groups[root[s]].push_back(s);
  std::vector<std::uint8_t> outer(shells.size(), 1);
  for (const auto& members : groups) {
    if (members.empty()) continue;
    bool skin = false;
    double volume = 0;  // that the skin encloses: faces between shells do not count
    for (const auto s : members) {
      volume += shells[s].volume;
      for (const Side side : shells[s].sides) skin |= k.face(side.face).crack == 0;
    }
    if (!(skin && volume > 0)) outer[outward(k, shells, members)] = 0;
  }
  return outer;
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

  // Cavities and internal cracks belong to the smallest outer shell around them, which is none of
  // those that they share faces with.
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
      // Any face will do, by its middle: two shells may touch at vertices and edges.
      for (const Side side : shells[s].sides) {
        const auto c = k.corners(side.face);
        const Vec3 middle = (c[0] + c[1] + c[2]) / 3;
        if (trees[o].closest(middle).distance == 0) continue;
        if (trees[o].inside(middle)) best = shells[o].volume, owner[s] = o;
        break;
      }
    }
  }

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

TriangleMesh piece_mesh(const Complex& k, const Pieces& pieces, std::uint32_t piece, std::vector<SurfaceVertexId>* of) {
  TriangleMesh mesh;
  if (of) of->clear();
  std::vector<std::uint32_t> row(k.surface_vertex_count(), ~0u);
  for (std::uint32_t f = 0; f < k.face_count(); ++f)
    for (int which = 0; which < 2; ++which) {
      if (pieces.of_side[f * 2 + which] != static_cast<std::int32_t>(piece)) continue;
      const auto& face = k.face(FaceId(f));
      Triangle t;
      for (int c = 0; c < 3; ++c) {
        const SurfaceVertexId v = k.surface_vertex({FaceId(f), which}, c);
        if (row[v.index()] == ~0u) {
          row[v.index()] = static_cast<std::uint32_t>(mesh.vertices.size());
          mesh.vertices.push_back(k.point(k.site(v)));
          mesh.site.push_back(k.site(v).value);
          if (of) of->push_back(v);
        }
        t[c] = row[v.index()];
      }
      if (which == 1) std::swap(t[1], t[2]);
      mesh.triangles.push_back(t);
      mesh.patch.push_back(which == 0 ? face.crack : -face.crack);
      mesh.source.push_back(face.source);
    }
  return mesh;
}

}  // namespace geo
