// Shapes of kerf/mesh.h other than letters.
//
// Geodesic spheres divide each face of an icosahedron into frequency² triangles and project them
// along rays from the centre. Radius functions are sums of bumps exp(−x²) and sines. Points are
// shared by integer coordinates, never by comparison of doubles.
#include "kerf/mesh.h"

#include <cmath>
#include <iterator>
#include <map>
#include <numbers>

#include "kerf/error.h"

namespace geo {
namespace {

// The regular icosahedron, counter-clockwise from outside.
constexpr double golden = 1.618033988749895;
constexpr double icosahedron_points[12][3] = {{-1, golden, 0}, {1, golden, 0}, {-1, -golden, 0}, {1, -golden, 0},
                                              {0, -1, golden}, {0, 1, golden}, {0, -1, -golden}, {0, 1, -golden},
                                              {golden, 0, -1}, {golden, 0, 1}, {-golden, 0, -1}, {-golden, 0, 1}};
constexpr std::uint32_t icosahedron_faces[20][3] = {{0, 11, 5}, {0, 5, 1},  {0, 1, 7},   {0, 7, 10}, {0, 10, 11},
                                                    {1, 5, 9},  {5, 11, 4}, {11, 10, 2}, {10, 7, 6}, {7, 1, 8},
                                                    {3, 9, 4},  {3, 4, 2},  {3, 2, 6},   {3, 6, 8},  {3, 8, 9},
                                                    {4, 9, 5},  {2, 4, 11}, {6, 2, 10},  {8, 6, 7},  {9, 8, 1}};

// The numbers in the models below are their dimensions: no algorithm depends on them.
double bump(double x) { return std::exp(-x * x); }

}  // namespace

TriangleMesh make_star(int frequency, const std::function<double(const Vec3&)>& radius) {
  if (frequency < 1) throw InputError("a geodesic sphere needs a frequency of at least 1");
  TriangleMesh mesh;
  // A grid point is identified by its integer weights at the icosahedron's corners, so that
  // neighbours share it exactly.
  std::map<std::array<std::uint32_t, 6>, std::uint32_t> index;
  const auto vertex_at = [&](const std::uint32_t(&face)[3], int wa, int wb, int wc) {
    std::array<std::pair<std::uint32_t, std::uint32_t>, 3> weights{{{face[0], static_cast<std::uint32_t>(wa)},
                                                                    {face[1], static_cast<std::uint32_t>(wb)},
                                                                    {face[2], static_cast<std::uint32_t>(wc)}}};
    std::sort(weights.begin(), weights.end());
    std::array<std::uint32_t, 6> key;
    key.fill(99);
    std::size_t filled = 0;
    Vec3 sum = Vec3::Zero();
    for (const auto& [corner, weight] : weights) {
      if (weight == 0) continue;
      key[filled++] = corner;
      key[filled++] = weight;
      sum += static_cast<double>(weight) * Vec3(icosahedron_points[corner]);
    }
    const auto [it, is_new] = index.try_emplace(key, static_cast<std::uint32_t>(mesh.vertices.size()));
    if (is_new) {
      const Vec3 d = sum.normalized();
      mesh.vertices.push_back(radius(d) * d);
    }
    return it->second;
  };
  for (const auto& face : icosahedron_faces)
    for (int i = 0; i < frequency; ++i)
      for (int j = 0; j < frequency - i; ++j) {
        const int k = frequency - i - j;
        const auto a = vertex_at(face, k, i, j), b = vertex_at(face, k - 1, i + 1, j),
                   c = vertex_at(face, k - 1, i, j + 1);
        mesh.triangles.push_back({a, b, c});
        if (k >= 2) mesh.triangles.push_back({b, vertex_at(face, k - 2, i + 1, j + 1), c});
      }
  return mesh;
}

TriangleMesh make_sphere(int frequency) {
  return make_star(frequency, [](const Vec3&) { return 1.0; });
}

TriangleMesh make_pumpkin(int frequency) {
  return make_star(frequency, [](const Vec3& d) {
    const double s = std::hypot(d.x(), d.y()), phi = std::atan2(d.y(), d.x());
    const double lobes = 0.09 * std::abs(std::cos(4.5 * phi)) * s * s;
    const double flat = 1.0 / std::sqrt(s * s + d.z() * d.z() / 0.64);
    return flat * (0.92 + lobes) - 0.16 * bump(s / 0.33) - 0.004 * std::sin(7 * d.x() + 3 * d.z());
  });
}

TriangleMesh make_apple(int frequency) {
  return make_star(frequency, [](const Vec3& d) {
    const double s = std::hypot(d.x(), d.y()), phi = std::atan2(d.y(), d.x());
    const double dimple = d.z() > 0 ? 0.42 * bump(s / 0.34) : 0.2 * bump(s / 0.28);
    const double shoulders = 0.06 * d.z() * s;
    const double knobs = d.z() < 0 ? 0.02 * std::cos(5 * phi) * s * d.z() * d.z() : 0.0;
    return 0.98 + shoulders + knobs - dimple;
  });
}

TriangleMesh make_polyp(int frequency) {
  // A surface of revolution over a geodesic sphere. The polar angle runs along a profile (radius,
  // height), a simple curve; the azimuth stays. Small bumps on the bulb hide the rotational
  // symmetry.
  constexpr double profile[][2] = {{0, 1.0},      {0.30, 0.95},  {0.52, 0.76},  {0.60, 0.48},  {0.52, 0.20},
                                   {0.32, 0.0},   {0.19, -0.16}, {0.17, -0.38}, {0.20, -0.60}, {0.34, -0.80},
                                   {0.46, -0.92}, {0.42, -1.0},  {0.2, -1.0},   {0, -1.0}};
  constexpr int last = static_cast<int>(std::size(profile)) - 1;
  TriangleMesh mesh = make_sphere(frequency);
  for (Vec3& p : mesh.vertices) {
    const double s = std::hypot(p.x(), p.y()), along = std::atan2(s, p.z()) / std::numbers::pi * last;
    const int i = std::clamp(static_cast<int>(along), 0, last - 1);
    const double t = along - i;
    // Catmull-Rom through the profile, mirrored at its ends.
    const auto at = [&](int j, int c) {
      if (j < 0) return c == 0 ? -profile[-j][0] : profile[-j][1];
      if (j > last) return c == 0 ? -profile[2 * last - j][0] : profile[2 * last - j][1];
      return profile[j][c];
    };
    double point[2];
    for (int c = 0; c < 2; ++c) {
      const double p0 = at(i - 1, c), p1 = at(i, c), p2 = at(i + 1, c), p3 = at(i + 2, c);
      point[c] = p1 + 0.5 * t * (p2 - p0 + t * (2 * p0 - 5 * p1 + 4 * p2 - p3 + t * (3 * (p1 - p2) + p3 - p0)));
    }
    const Vec3 d = p;
    const double bulb = std::clamp(point[1] / 0.5, 0.0, 1.0);
    const double r = point[0] * (1 + bulb * (0.05 * std::sin(5 * d.x() + 1) + 0.05 * std::sin(6 * d.y())));
    p = s > 0 ? Vec3(r * d.x() / s, r * d.y() / s, point[1]) : Vec3(0, 0, point[1]);
  }
  return mesh;
}

TriangleMesh make_block(const Vec3& size, double edge) {
  if (!(size.minCoeff() > 0) || !(edge > 0)) throw InputError("a block needs a positive size and edge");
  TriangleMesh mesh;
  const Eigen::Vector3i n = (size / edge * (1 - 1e-12)).array().ceil().max(1.0).cast<int>();
  std::map<std::array<int, 3>, std::uint32_t> index;
  const auto vertex_at = [&](std::array<int, 3> cell) {
    const auto [it, is_new] = index.try_emplace(cell, static_cast<std::uint32_t>(mesh.vertices.size()));
    if (is_new)
      mesh.vertices.push_back({size.x() * cell[0] / n.x(), size.y() * cell[1] / n.y(), size.z() * cell[2] / n.z()});
    return it->second;
  };
  for (int axis = 0; axis < 3; ++axis)
    for (int high = 0; high < 2; ++high) {
      const int u = (axis + 1) % 3, v = (axis + 2) % 3;
      for (int i = 0; i < n[u]; ++i)
        for (int j = 0; j < n[v]; ++j) {
          const auto at = [&](int di, int dj) {
            std::array<int, 3> cell{};
            cell[axis] = high ? n[axis] : 0;
            cell[u] = i + di;
            cell[v] = j + dj;
            return vertex_at(cell);
          };
          std::uint32_t a = at(0, 0), b = at(1, 0), c = at(1, 1), d = at(0, 1);
          if (!high) std::swap(b, d);
          // Diagonals alternate, so that no direction of the block is stiffer or prettier than
          // another.
          if ((i + j) % 2 == 0) {
            mesh.triangles.push_back({a, b, c});
            mesh.triangles.push_back({a, c, d});
          } else {
            mesh.triangles.push_back({a, b, d});
            mesh.triangles.push_back({b, c, d});
          }
        }
    }
  return mesh;
}

}  // namespace geo
