#include "surface/pieces.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "geometry/bvh.h"
#include "geometry/predicates.h"

namespace geo {
namespace {

// One connected component of the derived surface.
struct Shell {
  std::vector<Side> sides;
  double volume = 0;
  double doubt = 0;  ///< rounding may have made this much of the volume
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
        shell.doubt += 0x1p-50 * (c[0] - origin).norm() * (c[1] - origin).norm() * (c[2] - origin).norm();
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

// True when the shell encloses something: a fold of a crack onto itself does not, whatever rounding makes of its volume.
// Nor does rounding decide of a crumb: were it an inner shell, it would enclose the shells across its faces.
bool is_outer(std::uint32_t id, const std::vector<Shell>& shells, const std::vector<std::int32_t>& of_side) {
  const Shell& shell = shells[id];
  bool thick = false, beside_larger = false;
  for (const Side s : shell.sides) {
    const auto other = of_side[s.face.index() * 2 + 1 - static_cast<std::size_t>(s.which)];
    if (other == static_cast<std::int32_t>(id)) continue;
    thick = true;
    if (other >= 0) {
      const Shell& next = shells[static_cast<std::size_t>(other)];
      beside_larger |= std::abs(next.volume) > 2 * std::abs(shell.volume) + shell.doubt + next.doubt;
    }
  }
  return thick && (shell.volume > 0 || beside_larger);
}

}  // namespace

Pieces find_pieces(const Complex& k) {
  std::vector<std::int32_t> shell_of;
  const auto shells = find_shells(k, shell_of);
  std::vector<std::uint32_t> outer;
  for (std::uint32_t s = 0; s < shells.size(); ++s)
    if (is_outer(s, shells, shell_of)) outer.push_back(s);

  // Cavities and internal cracks belong to the smallest outer shell around them.
  std::vector<std::uint32_t> owner(shells.size());
  std::vector<TriangleBvh> trees(shells.size());
  for (std::uint32_t s = 0; s < shells.size(); ++s) {
    owner[s] = s;
    if (std::find(outer.begin(), outer.end(), s) != outer.end()) continue;
    double best = std::numeric_limits<double>::infinity();
    for (const auto o : outer) {
      if (shells[o].volume >= best) continue;
      if (trees[o].empty()) {
        std::vector<std::array<Vec3, 3>> soup;
        for (const Side side : shells[o].sides) soup.push_back(k.corners(side.face));
        trees[o] = TriangleBvh(soup);
      }
      // Any vertex will do that is not on the outer shell itself (two shells may touch at a vertex).
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

TriangleMesh piece_mesh(const Complex& k, const Pieces& pieces, std::uint32_t piece) {
  TriangleMesh mesh;
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
