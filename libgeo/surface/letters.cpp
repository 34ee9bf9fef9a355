// make_letter() of kerf/mesh.h. Block letters: a pen's distance field on a grid, contoured by
// marching squares, extruded.
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <vector>

#include "kerf/error.h"
#include "kerf/mesh.h"

namespace geo {
namespace {

struct PenPoint {
  double x, y;
};

struct Stroke {
  PenPoint from, to;
};

// Pen strokes in a box of width 0.6 and height 0.8; round letters are drawn as polygons.
std::vector<Stroke> strokes_of(char letter) {
  const double l = 0, r = 0.6, b = 0, t = 0.8, m = 0.4, c = 0.3;
  const auto arc_of = [&](double from, double to) {
    std::vector<Stroke> arc;
    constexpr int segments = 24;  // larger: rounder letters
    for (int i = 0; i < segments; ++i) {
      const double a0 = from + (to - from) * i / segments, a1 = from + (to - from) * (i + 1) / segments;
      arc.push_back(
          {{c + 0.3 * std::cos(a0), m + 0.4 * std::sin(a0)}, {c + 0.3 * std::cos(a1), m + 0.4 * std::sin(a1)}});
    }
    return arc;
  };
  constexpr double pi = std::numbers::pi;
  const Stroke left{{l, b}, {l, t}}, right{{r, b}, {r, t}}, top{{l, t}, {r, t}}, middle{{l, m}, {r, m}},
      bottom{{l, b}, {r, b}};
  switch (letter) {
    case 'A':
      return {{{l, b}, {c, t}}, {{c, t}, {r, b}}, {{0.11, 0.27}, {0.49, 0.27}}};
    case 'B':
      return {left, top, middle, bottom, right};
    case 'C':
      return arc_of(pi / 4, 7 * pi / 4);
    case 'D':
      return {
          left, {{l, t}, {c, t}}, {{c, t}, {r, 0.55}}, {{r, 0.55}, {r, 0.25}}, {{r, 0.25}, {c, b}}, {{c, b}, {l, b}}};
    case 'E':
      return {left, top, middle, bottom};
    case 'F':
      return {left, top, middle};
    case 'G': {
      auto g = arc_of(pi / 4, 2 * pi);
      g.push_back({{r, m}, {c, m}});
      return g;
    }
    case 'H':
      return {left, right, middle};
    case 'I':
      return {{{c, b}, {c, t}}};
    case 'J':
      return {{{r, t}, {r, 0.2}}, {{r, 0.2}, {c, b}}, {{c, b}, {l, 0.2}}};
    case 'K':
      return {left, {{l, m}, {r, t}}, {{l, m}, {r, b}}};
    case 'L':
      return {left, bottom};
    case 'M':
      return {left, right, {{l, t}, {c, m}}, {{c, m}, {r, t}}};
    case 'N':
      return {left, right, {{l, t}, {r, b}}};
    case 'O':
      return arc_of(0, 2 * pi);
    case 'P':
      return {left, top, middle, {{r, m}, {r, t}}};
    case 'Q': {
      auto q = arc_of(0, 2 * pi);
      q.push_back({{c, 0.25}, {r, b}});
      return q;
    }
    case 'R':
      return {left, top, middle, {{r, m}, {r, t}}, {{c, m}, {r, b}}};
    case 'S':
      return {top, {{l, t}, {l, m}}, middle, {{r, m}, {r, b}}, bottom};
    case 'T':
      return {{{c, b}, {c, t}}, top};
    case 'U':
      return {{{l, t}, {l, 0.2}}, {{l, 0.2}, {c, b}}, {{c, b}, {r, 0.2}}, {{r, 0.2}, {r, t}}};
    case 'V':
      return {{{l, t}, {c, b}}, {{c, b}, {r, t}}};
    case 'W':
      return {left, right, {{l, b}, {c, m}}, {{c, m}, {r, b}}};
    case 'X':
      return {{{l, b}, {r, t}}, {{l, t}, {r, b}}};
    case 'Y':
      return {{{l, t}, {c, m}}, {{r, t}, {c, m}}, {{c, m}, {c, b}}};
    case 'Z':
      return {top, bottom, {{l, b}, {r, t}}};
    default:
      throw InputError(std::string("no block letter for '") + letter + "'; use A to Z");
  }
}

double distance_to(const std::vector<Stroke>& strokes, double x, double y) {
  double best = 1e300;
  for (const Stroke& s : strokes) {
    const double dx = s.to.x - s.from.x, dy = s.to.y - s.from.y, length = dx * dx + dy * dy;
    const double along = length > 0 ? std::clamp(((x - s.from.x) * dx + (y - s.from.y) * dy) / length, 0.0, 1.0) : 0.0;
    best = std::min(best, std::hypot(x - s.from.x - along * dx, y - s.from.y - along * dy));
  }
  return best;
}

// A planar region as convex cells. A point is identified by its grid corner or grid edge, so
// neighbours share it.
struct Region {
  std::vector<std::array<double, 2>> points;
  std::vector<std::vector<std::uint32_t>> cells;             // counter-clockwise
  std::vector<std::pair<std::uint32_t, std::uint32_t>> rim;  // directed, material on the left
};

Region contour(const std::vector<Stroke>& strokes, int resolution) {
  // Half the pen's width; margin of the grid around the strokes, wider than that.
  constexpr double pen = 0.1, pad = 0.15;
  const double h = 1.0 / resolution;
  const int nx = static_cast<int>(std::ceil((0.6 + 2 * pad) / h)),
            ny = static_cast<int>(std::ceil((0.8 + 2 * pad) / h));
  // The grid is offset from the strokes' lines, so that no sample is zero; small samples are
  // enlarged, so that no cell degenerates.
  const auto value = [&](int i, int j) {
    const double v = pen - distance_to(strokes, i * h - pad + 0.37e-3, j * h - pad + 0.53e-3);
    return std::abs(v) < 0.02 * h ? (v < 0 ? -0.02 : 0.02) * h : v;
  };
  std::vector<double> field(static_cast<std::size_t>(nx + 1) * (ny + 1));
  for (int j = 0; j <= ny; ++j)
    for (int i = 0; i <= nx; ++i) field[j * (nx + 1) + i] = value(i, j);

  Region region;
  std::map<std::array<int, 3>, std::uint32_t> index;  // (i, j, 0: the corner, 1: edge to the right, 2: edge upwards)
  const auto point = [&](int i, int j, int kind) {
    const auto [it, is_new] = index.try_emplace({i, j, kind}, static_cast<std::uint32_t>(region.points.size()));
    if (is_new) {
      const int i1 = i + (kind == 1), j1 = j + (kind == 2);
      const double f0 = field[j * (nx + 1) + i], f1 = field[j1 * (nx + 1) + i1];
      // Zero of the linear interpolant, away from the grid corners: no needles.
      const double s = kind == 0 ? 0.0 : std::clamp(f0 / (f0 - f1), 0.1, 0.9);
      region.points.push_back({(i + s * (i1 - i)) * h, (j + s * (j1 - j)) * h});
    }
    return it->second;
  };
  for (int j = 0; j < ny; ++j)
    for (int i = 0; i < nx; ++i) {
      const int corner[4][2] = {{i, j}, {i + 1, j}, {i + 1, j + 1}, {i, j + 1}};
      const std::array<int, 3> edge[4] = {{i, j, 1}, {i + 1, j, 2}, {i, j + 1, 1}, {i, j, 2}};
      bool in[4];
      int count = 0;
      for (int k = 0; k < 4; ++k) count += in[k] = field[corner[k][1] * (nx + 1) + corner[k][0]] > 0;
      if (count == 0) continue;
      const auto crossing = [&](int k) { return point(edge[k][0], edge[k][1], edge[k][2]); };
      if (count == 2 && in[0] == in[2]) {
        // A saddle: two separate corners, the same choice everywhere.
        for (int k = 0; k < 4; ++k)
          if (in[k]) {
            const auto out = crossing(k), back = crossing((k + 3) % 4);
            region.cells.push_back({point(corner[k][0], corner[k][1], 0), out, back});
            region.rim.push_back({out, back});
          }
        continue;
      }
      std::vector<std::uint32_t> cell;
      std::uint32_t leave = 0, enter = 0;
      bool cut = false;
      for (int k = 0; k < 4; ++k) {
        if (in[k]) cell.push_back(point(corner[k][0], corner[k][1], 0));
        if (in[k] != in[(k + 1) % 4]) {
          const auto p = crossing(k);
          cell.push_back(p);
          (in[k] ? leave : enter) = p;
          cut = true;
        }
      }
      if (cut) region.rim.push_back({leave, enter});
      region.cells.push_back(cell);
    }
  return region;
}

}  // namespace

TriangleMesh make_letter(char letter, double depth, int resolution) {
  if (resolution < 12 || !(depth > 0))
    throw InputError("a letter needs a resolution of at least 12 and a positive depth");
  const Region region = contour(strokes_of(letter), resolution);
  const int layers = std::max(1, static_cast<int>(std::lround(depth * resolution)));
  const auto n = static_cast<std::uint32_t>(region.points.size());

  TriangleMesh mesh;
  for (const double z : {0.0, depth})
    for (const auto& p : region.points) mesh.vertices.push_back({p[0], p[1], z});
  for (const auto& cell : region.cells)
    for (std::size_t k = 1; k + 1 < cell.size(); ++k) {
      mesh.triangles.push_back({cell[0], cell[k + 1], cell[k]});
      mesh.triangles.push_back({n + cell[0], n + cell[k], n + cell[k + 1]});
    }
  std::map<std::pair<std::uint32_t, int>, std::uint32_t> between;  // wall points between the two caps
  const auto wall = [&](std::uint32_t p, int layer) {
    if (layer == 0) return p;
    if (layer == layers) return n + p;
    const auto [it, is_new] = between.try_emplace({p, layer}, static_cast<std::uint32_t>(mesh.vertices.size()));
    if (is_new) mesh.vertices.push_back({region.points[p][0], region.points[p][1], depth * layer / layers});
    return it->second;
  };
  for (const auto& [a, b] : region.rim)
    for (int layer = 0; layer < layers; ++layer) {
      mesh.triangles.push_back({wall(a, layer), wall(b, layer), wall(b, layer + 1)});
      mesh.triangles.push_back({wall(a, layer), wall(b, layer + 1), wall(a, layer + 1)});
    }
  return mesh;
}

}  // namespace geo
