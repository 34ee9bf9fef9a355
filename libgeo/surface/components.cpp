// Declared in surface/components.h.
#include "surface/components.h"

#include <algorithm>
#include <map>

#include "kerf/check.h"

namespace geo {

std::vector<HalfEdge> half_edges_of(const TriangleMesh& mesh) {
  std::vector<HalfEdge> half_edges;
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t)
    for (int k = 0; k < 3; ++k)
      half_edges.push_back({std::minmax({mesh.triangles[t][k], mesh.triangles[t][(k + 1) % 3]}), t, k});
  std::sort(half_edges.begin(), half_edges.end());
  return half_edges;
}

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
    sum += orientation(t);
    triangles.push_back(t);
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

Components orient(TriangleMesh& mesh) {
  const std::size_t n = mesh.triangles.size();
  std::vector<std::array<std::uint32_t, 3>> beside(n, {~0u, ~0u, ~0u});
  std::vector<std::array<char, 3>> against(n, {0, 0, 0});
  each_edge(half_edges_of(mesh), [&](std::span<const HalfEdge> s) {
    if (s.size() != 2) return;
    const bool same = mesh.triangles[s[0].triangle][s[0].corner] == mesh.triangles[s[1].triangle][s[1].corner];
    beside[s[0].triangle][s[0].corner] = s[1].triangle;
    beside[s[1].triangle][s[1].corner] = s[0].triangle;
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
        flips += reversed[next];
        component.push_back(next);
      }
    const bool majority = 2 * flips > component.size();
    for (const auto t : component)
      if (bool(reversed[t]) != majority) flip(mesh, t);
    ++components.count;
  }
  return components;
}

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

std::vector<std::uint32_t> polygon_of(const TriangleMesh& mesh, const std::vector<HalfEdge>& rim) {
  std::vector<std::uint32_t> polygon;
  for (const HalfEdge& s : rim) polygon.push_back(mesh.triangles[s.triangle][(s.corner + 1) % 3]);
  return polygon;
}

}  // namespace geo
