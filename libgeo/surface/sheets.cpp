// take_sheets() of kerf/repair.h. Pairs of triangles that coincide and face each other cancel in a
// solid, where they are a wall between two parts. In a card they are all that there is.
#include <algorithm>
#include <map>

#include "base/union_find.h"
#include "kerf/repair.h"
#include "surface/components.h"
#include "surface/polygon.h"
#include "surface/weld.h"

namespace geo {
namespace {

// Whether the orientation is that of ascending vertices, up to rotation.
bool is_even(const Triangle& t) { return ((t[0] > t[1]) + (t[0] > t[2]) + (t[1] > t[2])) % 2 == 0; }

// Per triangle: whether drop_degenerate() would drop it because its orientation cancels with that
// of another one. One of those on the same vertices is marked.
std::vector<char> cancelled_triangles(const TriangleMesh& mesh) {
  std::map<Triangle, std::pair<int, std::uint32_t>> same;  // sum of orientations, first triangle
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    Triangle sorted = mesh.triangles[t];
    std::sort(sorted.begin(), sorted.end());
    if (sorted[0] == sorted[1] || sorted[1] == sorted[2]) continue;
    same.try_emplace(sorted, 0, t).first->second.first += is_even(mesh.triangles[t]) ? 1 : -1;
  }
  std::vector<char> cancelled(mesh.triangles.size(), 0);
  for (const auto& [sorted, found] : same)
    if (found.first == 0) cancelled[found.second] = 1;
  return cancelled;
}

// A copy of some triangles, with the same vertices.
TriangleMesh part_of(const TriangleMesh& mesh, const std::vector<char>& wanted) {
  TriangleMesh part = mesh;
  keep(part, wanted);
  return part;
}

// Appends triangles on the same vertices and with the same attributes.
void append(TriangleMesh& to, const TriangleMesh& from) {
  const auto add = [](auto& values, const auto& more) { values.insert(values.end(), more.begin(), more.end()); };
  add(to.triangles, from.triangles);
  add(to.source, from.source);
  add(to.attributes.uv, from.attributes.uv);
  add(to.attributes.uv2, from.attributes.uv2);
  add(to.attributes.normal, from.attributes.normal);
  add(to.attributes.color, from.attributes.color);
  add(to.attributes.group, from.attributes.group);
}

// Those of cancelled triangles that are no wall. A wall is a connected group whose every border
// edge is an edge of other triangles, too.
std::vector<char> without_walls(const TriangleMesh& cards, const TriangleMesh& others) {
  std::map<Edge, int> of_others;
  each_edge(half_edges_of(others), [&](std::span<const HalfEdge> s) { of_others[s[0].edge] = 1; });
  UnionFind groups(cards.triangles.size());
  const auto half_edges = half_edges_of(cards);
  each_edge(half_edges, [&](std::span<const HalfEdge> s) {
    for (const HalfEdge& other : s) groups.unite(s[0].triangle, other.triangle);
  });
  std::vector<std::uint32_t> borders(cards.triangles.size(), 0), free_borders(cards.triangles.size(), 0);
  each_edge(half_edges, [&](std::span<const HalfEdge> s) {
    if (s.size() != 1) return;
    const auto group = groups.find(s[0].triangle);
    ++borders[group];
    free_borders[group] += !of_others.contains(s[0].edge);
  });
  std::vector<char> wanted;
  for (std::uint32_t t = 0; t < cards.triangles.size(); ++t) {
    const auto group = groups.find(t);
    wanted.push_back(borders[group] == 0 || free_borders[group] > 0);
  }
  return wanted;
}

double area_of(const TriangleMesh& mesh, const Triangle& t) {
  const Vec3 &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &c = mesh.vertices[t[2]];
  return (b - a).cross(c - a).norm() / 2;
}

// Per component: whether it is an open sheet.
std::vector<char> find_sheets(const TriangleMesh& mesh, const Components& components, OpenParts open) {
  std::vector<double> own(components.count, 0), closing(components.count, 0);
  std::vector<std::uint32_t> open_edges(components.count, 0), in_rims(components.count, 0);
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) own[components.of[t]] += area_of(mesh, mesh.triangles[t]);
  each_edge(half_edges_of(mesh), [&](std::span<const HalfEdge> s) {
    if (s.size() == 1) ++open_edges[components.of[s[0].triangle]];
  });
  for (const auto& rim : rims_of(mesh)) {
    for (const HalfEdge& s : rim) ++in_rims[components.of[s.triangle]];
    const auto polygon = polygon_of(mesh, rim);
    if (polygon.size() < 3) continue;
    for (const auto& [a, b, c] : triangles_of(mesh.vertices, polygon))
      closing[components.of[rim[0].triangle]] += area_of(mesh, {polygon[a], polygon[b], polygon[c]});
  }
  std::vector<char> is_sheet(components.count, 0);
  for (std::uint32_t c = 0; c < components.count; ++c) {
    if (open_edges[c] == 0) continue;
    // A part of a sphere that is smaller than a half needs more than half its area to be closed.
    constexpr double half_sphere = 0.5;
    const bool can_be_closed = in_rims[c] == open_edges[c] && closing[c] < half_sphere * own[c];
    is_sheet[c] = open == OpenParts::sheets || !can_be_closed;
  }
  return is_sheet;
}

}  // namespace

TriangleMesh take_sheets(TriangleMesh& mesh, double weld_distance, OpenParts open, OpenSheetStats* stats) {
  OpenSheetStats done;
  done.welded_vertices = weld_seams(mesh, weld_distance);
  TriangleMesh cards = part_of(mesh, cancelled_triangles(mesh));
  done.dropped_triangles = drop_degenerate(mesh);
  if (open == OpenParts::closed) {
    if (stats) *stats = done;
    return {};
  }
  keep(cards, without_walls(cards, mesh));
  done.dropped_triangles -= cards.triangles.size();
  append(mesh, cards);
  const Components components = orient(mesh);
  const std::vector<char> is_sheet = find_sheets(mesh, components, open);
  done.sheets = static_cast<std::size_t>(std::count(is_sheet.begin(), is_sheet.end(), 1));
  std::vector<char> in_sheet, in_rest;
  for (const auto c : components.of) {
    in_sheet.push_back(is_sheet[c]);
    in_rest.push_back(!is_sheet[c]);
  }
  TriangleMesh sheets = part_of(mesh, in_sheet);
  keep(mesh, in_rest);
  if (stats) *stats = done;
  return sheets;
}

}  // namespace geo
