// Checks of kerf/check.h. Edges are counted by direction in a hash map. Pairs of near triangles
// come from a spatial index; faces_cross() decides each by the corners that they share: 0, 1 or 2
// leave different exact tests.
#include "kerf/check.h"

#include <algorithm>
#include <map>
#include <unordered_map>

#include "base/union_find.h"
#include "geometry/box_pairs.h"
#include "geometry/predicates.h"
#include "kerf/error.h"
#include "surface/crossing_triangles.h"
#include "surface/radial_edge.h"
#include "surface/shells.h"
#include "surface/skin.h"

namespace geo {
namespace {

std::string pair_name(std::size_t a, std::size_t b) { return std::to_string(a) + " and " + std::to_string(b); }

void report_problem(SurfaceReport& report, const std::string& problem) {
  if (report.first_problem.empty()) report.first_problem = problem;
}

// The triangles of an edge: how many run along it upwards and downwards, and two of them.
struct EdgeUses {
  std::uint32_t up = 0, down = 0, first = 0, last = 0;
};
using Edges = std::unordered_map<std::uint64_t, EdgeUses>;

std::uint64_t edge_key(std::uint32_t a, std::uint32_t b) {
  return std::uint64_t(std::min(a, b)) << 32 | std::max(a, b);
}

Edges edges_of(const TriangleMesh& mesh) {
  Edges edges;
  edges.reserve(mesh.triangles.size() * 2);
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t)
    for (int k = 0; k < 3; ++k) {
      const auto a = mesh.triangles[t][k], b = mesh.triangles[t][(k + 1) % 3];
      auto& e = edges.try_emplace(edge_key(a, b), EdgeUses{.up = 0, .down = 0, .first = t, .last = t}).first->second;
      ++(a < b ? e.up : e.down);
      e.last = t;
    }
  return edges;
}

// Reports edges without two triangles of opposite directions.
void check_edges(const TriangleMesh& mesh, const Edges& edges, SurfaceReport& report) {
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t)
    for (int k = 0; k < 3; ++k) {
      const auto a = mesh.triangles[t][k], b = mesh.triangles[t][(k + 1) % 3];
      const auto& e = edges.at(edge_key(a, b));
      if (e.first != t) continue;
      const std::string where = "edge " + std::to_string(std::min(a, b)) + "-" + std::to_string(std::max(a, b));
      if (e.up + e.down == 1) {
        report.closed = false;
        report_problem(report, "the surface is open: " + where + " has one triangle only; close the holes first");
      } else if (e.up + e.down > 2 && (e.up != e.down || !mesh.two_sided())) {
        report.manifold = false;
        report_problem(report, "the surface is not manifold: " + where + " has " + std::to_string(e.up + e.down) +
                                   " triangles; separate the parts that touch there");
      } else if (e.up != e.down) {
        report.oriented = false;
        report_problem(report, "the surface is not consistently oriented: both triangles at " + where +
                                   " run the same way; orient it first");
      }
    }
}

// Reports vertices of several fans: triangles that are joined across edges at the vertex. Each edge
// has two triangles.
void check_fans(const TriangleMesh& mesh, const Edges& edges, SurfaceReport& report) {
  UnionFind fans(3 * mesh.triangles.size());  // of corners
  const auto corner = [&](std::uint32_t t, std::uint32_t v) {
    const Triangle& c = mesh.triangles[t];
    return 3 * t + (c[0] == v ? 0 : c[1] == v ? 1 : 2);
  };
  for (const auto& [key, e] : edges)
    for (const auto v : {static_cast<std::uint32_t>(key >> 32), static_cast<std::uint32_t>(key)})
      fans.unite(corner(e.first, v), corner(e.last, v));
  std::vector<std::uint32_t> count(mesh.vertices.size(), 0);
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t)
    for (std::uint32_t k = 0; k < 3; ++k) count[mesh.triangles[t][k]] += fans.find(3 * t + k) == 3 * t + k;
  const auto several = std::find_if(count.begin(), count.end(), [](auto n) { return n > 1; });
  if (several == count.end()) return;
  report.manifold = false;
  report_problem(report, "the surface is not manifold: vertex " + std::to_string(several - count.begin()) + " joins " +
                             std::to_string(*several) + " fans of triangles; separate the parts that touch there");
}

std::size_t count_degenerate(const TriangleMesh& mesh, SurfaceReport& report) {
  std::size_t count = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto& [a, b, c] = mesh.triangles[t];
    if (!collinear(mesh.vertices[a], mesh.vertices[b], mesh.vertices[c])) continue;
    ++count;
    report_problem(report, "triangle " + std::to_string(t) + " is degenerate (no area); remove or repair it");
  }
  return count;
}

// Reports shells whose orientation does not fit their place. The surface is sound otherwise.
void check_shells(const TriangleMesh& mesh, SurfaceReport& report) {
  report.shells = find_shells(mesh);
  if (const std::string problem = shell_problem(report.shells); !problem.empty()) report_problem(report, problem);
}

}  // namespace

std::vector<std::pair<std::uint32_t, std::uint32_t>> crossing_triangles(const TriangleMesh& mesh) {
  const auto points = [&](std::uint32_t t) {
    const auto& [a, b, c] = mesh.triangles[t];
    return std::array<Vec3, 3>{mesh.vertices[a], mesh.vertices[b], mesh.vertices[c]};
  };
  std::vector<Box3> boxes(mesh.triangles.size());
  for (std::uint32_t t = 0; t < boxes.size(); ++t) {
    const auto& [a, b, c] = mesh.triangles[t];
    if (a != b && b != c && c != a) boxes[t] = box_of(mesh.vertices[a], mesh.vertices[b], mesh.vertices[c]);
  }
  auto pairs = meeting_pairs(boxes, [&](AabbTree::Pairs& some) {
    std::erase_if(some, [&](auto& pair) {
      std::swap(pair.first, pair.second);
      return !faces_cross(mesh.triangles[pair.first], points(pair.first), mesh.triangles[pair.second],
                          points(pair.second));
    });
  });
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

bool faces_cross(const std::array<std::uint32_t, 3>& f, const std::array<Vec3, 3>& p,
                 const std::array<std::uint32_t, 3>& g, const std::array<Vec3, 3>& q) {
  int shared_f[3], shared_g[3], shared = 0;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      if (f[i] == g[j]) {
        for (int k = 0; k < shared; ++k)
          if (shared_f[k] == i || shared_g[k] == j) return true;  // a vertex occurs twice
        shared_f[shared] = i;
        shared_g[shared] = j;
        ++shared;
      }
  if (shared == 3) return true;
  const auto clear = [](const std::array<Vec3, 3>& plane, const Vec3& a, const Vec3& b) {
    const int side = orient3d_filtered(plane[0], plane[1], plane[2], a);
    return side != 2 && orient3d_filtered(plane[0], plane[1], plane[2], b) == side;
  };
  const auto apart = [](const std::array<Vec3, 3>& x, const std::array<Vec3, 3>& y) {
    const Vec3 s[3] = {x[0], x[1], x[2]}, t[3] = {y[0], y[1], y[2]};
    return share_corners_only(s, t);
  };
  if (shared == 2) {
    const int i = 3 - shared_f[0] - shared_f[1], j = 3 - shared_g[0] - shared_g[1];
    const Vec3 &u = p[shared_f[0]], &v = p[shared_f[1]];
    if (orient3d_filtered(u, v, p[i], q[j]) != 2 || apart(p, q) || orient3d(u, v, p[i], q[j]) != 0) return false;
    if (collinear(u, v, p[i])) return segment_meets_triangle(p[i], p[i], q[0], q[1], q[2]);
    return coplanar_side(u, v, p[i], q[j]) >= 0;
  }
  if (shared == 1) {
    // Two corners strictly on one side of the other plane: the triangles touch at the shared corner
    // alone.
    const int i = shared_f[0], j = shared_g[0];
    if (clear(p, q[(j + 1) % 3], q[(j + 2) % 3]) || clear(q, p[(i + 1) % 3], p[(i + 2) % 3]) || apart(p, q))
      return false;
    return segment_meets_triangle(p[(i + 1) % 3], p[(i + 2) % 3], q[0], q[1], q[2]) ||
           segment_meets_triangle(q[(j + 1) % 3], q[(j + 2) % 3], p[0], p[1], p[2]);
  }
  const Vec3 s[3] = {p[0], p[1], p[2]}, t[3] = {q[0], q[1], q[2]};
  return triangles_meet(s, t);
}

bool in_radial_order(const Vec3& a, const Vec3& b, std::span<const Vec3> through) {
  for (std::size_t i = 0; i + 1 < through.size(); ++i)
    if (compare_angle(a, b, through[0], through[i], through[i + 1]) >= 0) return false;
  return true;
}

SurfaceReport check_surface(const TriangleMesh& mesh, SelfIntersections crossings) {
  if (mesh.two_sided()) {
    try {
      return check_complex(Complex::from_two_sided(mesh), crossings);
    } catch (const InputError& e) {
      SurfaceReport report;
      report.manifold = false;
      check_edges(mesh, edges_of(mesh), report);
      report.first_problem = e.what();
      return report;
    }
  }
  SurfaceReport report;
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v)
    if (!in_range(mesh.vertices[v])) {
      report_problem(report, "vertex " + std::to_string(v) +
                                 " has a coordinate that is not a finite number of sensible size; repair the file");
      return report;
    }
  if (mesh.triangles.empty()) report_problem(report, "the surface is empty: it has no triangles");
  report.degenerate_faces = count_degenerate(mesh, report);
  const Edges edges = edges_of(mesh);
  check_edges(mesh, edges, report);
  if (report.closed && report.manifold) check_fans(mesh, edges, report);
  if (crossings == SelfIntersections::ignore) return report;
  const auto pairs = crossing_triangles(mesh);
  report.self_intersections = pairs.size();
  if (!pairs.empty())
    report_problem(report, "triangles " + pair_name(pairs[0].second, pairs[0].first) +
                               " intersect each other; repair the surface first");
  if (report.good()) check_shells(mesh, report);
  return report;
}

std::vector<std::pair<FaceId, FaceId>> self_intersections(const Complex& complex, const std::vector<FaceId>* only) {
  std::vector<std::pair<FaceId, FaceId>> pairs;
  std::vector<FaceId> all, sorted;
  if (only) {
    for (const FaceId f : *only)
      if (complex.alive(f)) sorted.push_back(f);
    std::sort(sorted.begin(), sorted.end());
  } else {
    for (std::uint32_t f = 0; f < complex.face_count(); ++f)
      if (complex.alive(FaceId(f))) sorted.push_back(FaceId(f));
  }
  const auto rows = [&](FaceId f) {
    const auto& v = complex.face(f).v;
    return std::array<std::uint32_t, 3>{v[0].value, v[1].value, v[2].value};
  };
  const auto cross = [&](FaceId f, FaceId g) {
    return faces_cross(rows(f), complex.corners(f), rows(g), complex.corners(g));
  };
  if (!only) {
    std::vector<Box3> boxes;
    for (const FaceId f : sorted) boxes.push_back(complex.box(f));
    auto found = meeting_pairs(boxes, [&](AabbTree::Pairs& some) {
      std::erase_if(some, [&](const auto& pair) { return !cross(sorted[pair.first], sorted[pair.second]); });
    });
    std::sort(found.begin(), found.end());
    for (const auto& [i, j] : found) pairs.push_back({sorted[i], sorted[j]});
    return pairs;
  }
  std::vector<FaceId> near;
  for (const FaceId f : sorted) {
    near.clear();
    complex.faces_near(complex.box(f), near);
    for (const FaceId g : near) {
      if (g == f || (g < f && std::binary_search(sorted.begin(), sorted.end(), g))) continue;
      if (cross(f, g)) pairs.push_back({f, g});
    }
  }
  return pairs;
}

namespace {

void check_face(const Complex& k, std::uint32_t f, SurfaceReport& report) {
  const auto& face = k.face(FaceId(f));
  const auto c = k.corners(FaceId(f));
  if (collinear(c[0], c[1], c[2])) {
    ++report.degenerate_faces;
    report_problem(report, "face " + std::to_string(f) + " is degenerate (no area)");
  }
  for (int e = 0; e < 3; ++e) {
    const VertexId a = face.v[e], b = face.v[(e + 1) % 3];
    const auto cycle = k.faces_around(a, b);
    if (std::find(cycle.begin(), cycle.end(), FaceId(f)) == cycle.end()) {
      report.manifold = false;
      report_problem(report, "face " + std::to_string(f) + " is missing around its edge " + edge_name(a, b));
      continue;
    }
    try {
      check_wedges(std::vector<FaceId>(cycle.begin(), cycle.end()), std::min(a, b), std::max(a, b),
                   [&](FaceId g) { return k.face(g); });
    } catch (const GeometryError& error) {
      report.closed = false;
      report_problem(report, error.what());
      continue;
    }
    if (cycle.size() > 2 && cycle[0] == FaceId(f)) {
      const auto [low, high] = std::minmax(a, b);
      std::vector<Vec3> apex;
      for (const FaceId g : cycle)
        for (const VertexId v : k.face(g).v)
          if (v != a && v != b) apex.push_back(k.point(v));
      if (!in_radial_order(k.point(low), k.point(high), apex)) {
        report.manifold = false;
        report_problem(report, "the faces around edge " + edge_name(a, b) + " stand otherwise than they are listed");
      }
    }
    for (int which = 0; which < 2; ++which) {
      const Side s{FaceId(f), which};
      if (!k.has(s)) continue;
      // The neighbour's neighbour is the side itself, and both see the same surface vertices at the
      // edge.
      const Side n = k.neighbor(s, e);
      const auto& g = k.face(n.face);
      const int na = corner_at(g, a), nb = corner_at(g, b);
      const int back = (na + 1) % 3 == nb ? na : nb;
      if (!k.has(n) || k.neighbor(n, back) != s || k.surface_vertex(n, na) != k.surface_vertex(s, e) ||
          k.surface_vertex(n, nb) != k.surface_vertex(s, (e + 1) % 3)) {
        report.manifold = false;
        report_problem(report,
                       "the two sides at edge " + edge_name(a, b) + " of face " + std::to_string(f) + " do not fit");
      }
      // Oriented: across the edge the derived triangles run in opposite directions.
      const bool up_s = runs_upwards(face, a, b) == (which == 0), up_n = runs_upwards(g, a, b) == (n.which == 0);
      if (up_s == up_n) {
        report.oriented = false;
        report_problem(report, "the derived surface is not oriented at edge " + edge_name(a, b));
      }
    }
  }
}

}  // namespace

SurfaceReport check_near(const Complex& k, std::span<const FaceId> faces) {
  SurfaceReport report;
  for (const FaceId f : faces) {
    if (!k.alive(f)) continue;
    check_face(k, f.value, report);
    for (const VertexId v : k.face(f).v)
      for (const FaceId g : k.faces_at(v)) check_face(k, g.value, report);
  }
  return report;
}

SurfaceReport check_complex(const Complex& k, SelfIntersections crossings) {
  SurfaceReport report;
  for (std::uint32_t f = 0; f < k.face_count(); ++f)
    if (k.alive(FaceId(f))) check_face(k, f, report);
  if (crossings == SelfIntersections::find) {
    const auto pairs = self_intersections(k);
    report.self_intersections = pairs.size();
    if (!pairs.empty())
      report_problem(report,
                     "faces " + pair_name(pairs[0].first.value, pairs[0].second.value) + " intersect each other");
    if (report.good()) check_shells(skin_of(k), report);
  }
  return report;
}

void require_solid(const TriangleMesh& mesh) {
  const SurfaceReport report = check_surface(mesh, SelfIntersections::find);
  if (!report.good()) throw InputError(report.first_problem);
}

}  // namespace geo
