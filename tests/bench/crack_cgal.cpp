#define CGAL_NO_CDT_2_WARNING
#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/corefinement.h>
#include <CGAL/Projection_traits_3.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/intersections.h>

#include <array>
#include <unordered_map>

#include "bench.h"
#include "crack_peers.h"
#include "geometry/bvh.h"

namespace bench {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_3;
using Mesh = CGAL::Surface_mesh<Point>;
namespace PMP = CGAL::Polygon_mesh_processing;

Point point(const geo::Vec3& p) { return {p.x(), p.y(), p.z()}; }

Mesh to_cgal(const geo::TriangleMesh& m) {
  Mesh mesh;
  std::vector<Mesh::Vertex_index> v;
  for (const auto& p : m.vertices) v.push_back(mesh.add_vertex(point(p)));
  for (const auto& t : m.triangles) mesh.add_face(v[t[0]], v[t[1]], v[t[2]]);
  return mesh;
}

}  // namespace

double corefine_seconds(const geo::TriangleMesh& solid, const std::vector<geo::TriangleMesh>& sheets, int runs) {
  const Mesh whole = to_cgal(solid);
  std::vector<Mesh> given;
  for (const auto& s : sheets) given.push_back(to_cgal(s));
  double best = 1e300;
  for (int r = 0; r < runs; ++r) {
    double sum = 0;
    for (const Mesh& g : given) {
      Mesh a = whole, s = g;
      const double start = cpu_seconds();
      PMP::corefine(a, s);
      sum += cpu_seconds() - start;
    }
    best = std::min(best, sum);
  }
  return best;
}

double floor_seconds(const geo::TriangleMesh& solid, const geo::TriangleMesh& sheet, int runs, std::size_t& cut) {
  using Traits = CGAL::Projection_traits_3<Kernel>;
  using Plane =
      CGAL::Constrained_Delaunay_triangulation_2<Traits, CGAL::Default,
                                                 CGAL::No_constraint_intersection_requiring_constructions_tag>;
  const geo::TriangleMesh* mesh[2] = {&solid, &sheet};
  std::vector<Kernel::Triangle_3> triangles[2];
  std::vector<std::array<geo::Vec3, 3>> soup;
  for (int i = 0; i < 2; ++i)
    for (const auto& t : mesh[i]->triangles) {
      const auto &a = mesh[i]->vertices[t[0]], &b = mesh[i]->vertices[t[1]], &c = mesh[i]->vertices[t[2]];
      triangles[i].emplace_back(point(a), point(b), point(c));
      if (i == 0) soup.push_back({a, b, c});
    }
  const geo::TriangleBvh tree(soup);
  double best = 1e300;
  for (int r = 0; r < runs; ++r) {
    const double start = cpu_seconds();
    std::vector<std::array<std::uint32_t, 2>> pairs;
    std::vector<std::uint32_t> near;
    for (std::uint32_t s = 0; s < triangles[1].size(); ++s) {
      const auto& y = triangles[1][s];
      geo::Box3 box;
      for (const auto v : sheet.triangles[s]) box.add(sheet.vertices[v]);
      near.clear();
      tree.near(box, near);
      for (const auto f : near) {
        const auto& x = triangles[0][f];
        const auto o = CGAL::orientation(y[0], y[1], y[2], x[0]);
        if (o != CGAL::COPLANAR && CGAL::orientation(y[0], y[1], y[2], x[1]) == o &&
            CGAL::orientation(y[0], y[1], y[2], x[2]) == o)
          continue;
        if (CGAL::do_intersect(x, y)) pairs.push_back({f, s});
      }
    }
    // Each point once, named by edge and triangle.
    std::unordered_map<std::uint64_t, Point> points;
    points.reserve(2 * pairs.size());
    std::unordered_map<std::uint32_t, std::vector<std::array<Point, 2>>> segments[2];
    for (const auto& pair : pairs) {
      std::vector<Point> ends;
      for (int i = 0; i < 2; ++i) {
        const auto& t = triangles[1 - i][pair[1 - i]];
        const auto& rows = mesh[i]->triangles[pair[static_cast<std::size_t>(i)]];
        for (int k = 0; k < 3; ++k) {
          auto a = rows[k], b = rows[(k + 1) % 3];
          if (a > b) std::swap(a, b);
          const Point p = point(mesh[i]->vertices[a]), q = point(mesh[i]->vertices[b]);
          const auto op = CGAL::orientation(t[0], t[1], t[2], p), oq = CGAL::orientation(t[0], t[1], t[2], q);
          if (op == oq) continue;
          const auto a0 = CGAL::orientation(p, q, t[0], t[1]), a1 = CGAL::orientation(p, q, t[1], t[2]),
                     a2 = CGAL::orientation(p, q, t[2], t[0]);
          if (!((a0 >= 0 && a1 >= 0 && a2 >= 0) || (a0 <= 0 && a1 <= 0 && a2 <= 0))) continue;
          const std::uint64_t key =
              std::uint64_t(i) << 63 | std::uint64_t(a) << 42 | std::uint64_t(b) << 21 | pair[1 - i];
          auto it = points.find(key);
          if (it == points.end()) {
            const auto n = CGAL::normal(t[0], t[1], t[2]);
            const double dp = (p - t[0]) * n, dq = (q - t[0]) * n;
            it = points.emplace(key, p + dp / (dp - dq) * (q - p)).first;
          }
          ends.push_back(it->second);
        }
      }
      if (ends.size() == 2)
        for (int i = 0; i < 2; ++i) segments[i][pair[static_cast<std::size_t>(i)]].push_back({ends[0], ends[1]});
    }
    std::size_t faces = 0;
    for (int i = 0; i < 2; ++i)
      for (const auto& [t, list] : segments[i]) {
        const auto& x = triangles[i][t];
        Plane plane{Traits(CGAL::normal(x[0], x[1], x[2]))};
        for (int k = 0; k < 3; ++k) plane.insert(x[k]);
        for (const auto& s : list) try {
            const auto a = plane.insert(s[0]), b = plane.insert(s[1]);
            if (a != b) plane.insert_constraint(a, b);
          } catch (const Plane::Intersection_of_constraints_exception&) {  // rounded points: a floor need not be right
          }
        faces += plane.number_of_faces();
      }
    best = std::min(best, cpu_seconds() - start);
    cut = segments[0].size();
    if (faces == 0) return 0;
  }
  return best;
}

}  // namespace bench
