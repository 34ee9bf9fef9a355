// self_union() of kerf/repair.h. The triangles cut a box into cells. The generalized winding number
// at a point of each cell decides whether it is solid (Jacobson, Kavan and Sorkine-Hornung 2013).
// Faces that do not separate solid from empty cells are removed from the crack complex.
#include <algorithm>
#include <cmath>

#include "crack/part_touching.h"
#include "crack/winding_number.h"
#include "kerf/check.h"
#include "kerf/crack.h"
#include "kerf/error.h"
#include "kerf/parallel.h"
#include "kerf/pieces.h"
#include "kerf/repair.h"
#include "surface/piece_sides.h"

namespace geo {
namespace {

// The box around a surface, half its diagonal away from it on each side: its faces cross nothing.
TriangleMesh box_around(const Box3& box) {
  const Vec3 margin = Vec3::Constant(box.diagonal() / 2);
  const Vec3 size = box.hi - box.lo + 2 * margin;
  TriangleMesh around = make_block(size, size.maxCoeff());
  for (Vec3& p : around.vertices) p += box.lo - margin;
  return around;
}

// A point inside a cell: half way from the centroid of its largest triangle to the next one along
// the normal inwards.
Vec3 point_inside(const TriangleMesh& cell) {
  std::size_t largest = 0;
  double most = -1;
  const auto corner = [&](std::size_t t, int k) -> const Vec3& { return cell.vertices[cell.triangles[t][k]]; };
  const auto doubled = [&](std::size_t t) -> Vec3 {
    return (corner(t, 1) - corner(t, 0)).cross(corner(t, 2) - corner(t, 0));
  };
  for (std::size_t t = 0; t < cell.triangles.size(); ++t)
    if (const double area = doubled(t).squaredNorm(); area > most) {
      most = area;
      largest = t;
    }
  const Vec3 from = (corner(largest, 0) + corner(largest, 1) + corner(largest, 2)) / 3;
  const Vec3 along = -doubled(largest).stableNormalized();
  double nearest = bounding_box(cell).diagonal();
  for (std::size_t t = 0; t < cell.triangles.size(); ++t) {
    if (t == largest) continue;
    // Möller and Trumbore 1997.
    const Vec3 a = corner(t, 1) - corner(t, 0), b = corner(t, 2) - corner(t, 0), across = along.cross(b);
    const double det = a.dot(across);
    if (det == 0) continue;
    const Vec3 to = from - corner(t, 0), turned = to.cross(a);
    const double u = to.dot(across) / det, v = along.dot(turned) / det, s = b.dot(turned) / det;
    if (u >= 0 && v >= 0 && u + v <= 1 && s > 0) nearest = std::min(nearest, s);
  }
  return from + nearest / 2 * along;
}

// Which cells are solid: those where the winding number exceeds a half, but for the outermost one.
std::vector<std::uint8_t> solid_cells(const Complex& complex, const Pieces& cells, const TriangleMesh& mesh) {
  const auto sides = sides_by_piece(cells);
  const crack::WindingNumber winding(corners_of(mesh));
  std::vector<std::uint8_t> solid(cells.count);
  std::vector<std::uint32_t> index(complex.surface_vertex_count(), ~0u);
  std::vector<SurfaceVertexId> vertex_of;
  std::vector<Vec3> points;
  for (const auto& cell : sides) points.push_back(point_inside(mesh_of_sides(complex, cell, index, vertex_of)));
  parallel_for(points.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      solid[i] =
          std::none_of(sides[i].begin(), sides[i].end(), [&](Side s) { return complex.face(s.face).crack == 0; }) &&
          winding.exceeds_half(points[i]);
  });
  return solid;
}

// Refuses a mesh most of whose triangles are shorter than `least`: some vertices are far from all
// others.
void require_resolution(const TriangleMesh& mesh, double least) {
  std::size_t shorter = 0;
  for (const auto& [a, b, c] : corners_of(mesh))
    shorter += std::max({(b - a).norm(), (c - b).norm(), (a - c).norm()}) < least;
  if (2 * shorter > mesh.triangles.size())
    throw GeometryError(
        "most triangles are too small for double precision beside the whole surface, as some vertices are far from all "
        "others");
}

// Indices of the triangles of `mesh` that contain the triangles of `part`; parts of a triangle lie
// in it up to rounding.
void find_sources(const TriangleMesh& mesh, TriangleMesh& part) {
  std::vector<Vec3> centroids;
  for (const auto& [a, b, c] : corners_of(part)) centroids.push_back((a + b + c) / 3);
  part.source = nearest_triangles(mesh, centroids);
}

// The sides that bound solid cells, as a surface; `in`: per face, which of its sides do.
crack::PairedSurface boundary_of(const Complex& complex, const std::vector<std::array<std::uint8_t, 2>>& in) {
  std::vector<Side> sides;
  std::vector<std::uint32_t> triangle_of(2 * in.size(), ~0u);
  const auto number = [](Side s) { return 2 * s.face.index() + s.which; };
  for (std::uint32_t f = 0; f < in.size(); ++f)
    for (std::uint8_t w : {0, 1})
      if (complex.alive(FaceId(f)) && in[f][w] != 0) {
        triangle_of[number({FaceId(f), w})] = static_cast<std::uint32_t>(sides.size());
        sides.push_back({FaceId(f), w});
      }
  std::vector<std::uint32_t> index(complex.surface_vertex_count(), ~0u);
  std::vector<SurfaceVertexId> vertex_of;
  crack::PairedSurface surface{mesh_of_sides(complex, sides, index, vertex_of), {}};
  surface.mesh.patch.clear();
  surface.mesh.source.clear();
  surface.beside.resize(sides.size());
  for (std::size_t t = 0; t < sides.size(); ++t)
    for (int k = 0; k < 3; ++k) {
      const auto a = complex.surface_vertex(sides[t], k), b = complex.surface_vertex(sides[t], (k + 1) % 3);
      const Triangle& corners = surface.mesh.triangles[t];
      std::size_t edge = 0;  // the side's edge among those of the triangle, which may run the other way
      while (std::minmax(vertex_of[corners[edge]], vertex_of[corners[(edge + 1) % 3]]) != std::minmax(a, b)) ++edge;
      surface.beside[t][edge] = triangle_of[number(complex.neighbor(sides[t], k))];
    }
  return surface;
}

}  // namespace

TriangleMesh self_union(const TriangleMesh& mesh, const CrackOptions& options, SelfUnionStats* stats) {
  if (mesh.triangles.empty()) throw InputError("the surface has no triangles");
  Complex complex = Complex::from_skin(box_around(bounding_box(mesh)));
  require_resolution(mesh, options.clearance * complex.extent().diagonal());
  TriangleMesh bare;
  bare.vertices = mesh.vertices;
  bare.triangles = mesh.triangles;
  insert_sheet(complex, bare, 1, options);
  const Pieces cells = find_pieces(complex);
  const auto solid = solid_cells(complex, cells, mesh);
  ComplexEdit edit;
  std::vector<std::array<std::uint8_t, 2>> in(complex.face_count());
  for (std::uint32_t f = 0; f < complex.face_count(); ++f) {
    if (!complex.alive(FaceId(f)) || complex.face(FaceId(f)).crack == 0) continue;
    for (std::size_t w : {0, 1}) in[f][w] = solid[static_cast<std::size_t>(cells.of_side[2 * f + w])];
    if (in[f][0] == in[f][1]) edit.removed_faces.push_back(FaceId(f));
  }
  if (!edit.empty()) complex.apply(edit);
  crack::PairedSurface surface = boundary_of(complex, in);
  if (surface.mesh.triangles.empty()) throw GeometryError("the surface encloses no volume");
  crack::part_touching(surface);
  TriangleMesh& result = surface.mesh;
  result.site.clear();
  find_sources(mesh, result);
  transfer_attributes(mesh, result);
  if (stats) *stats = {cells.count - 1, edit.removed_faces.size()};
  return std::move(result);
}

TriangleMesh self_union(const TriangleMesh& mesh, SelfUnionStats* stats) { return self_union(mesh, {}, stats); }

TriangleMesh repaired_solid(TriangleMesh mesh, const RepairOptions& options, SolidRepairStats* stats) {
  SolidRepairStats done;
  done.repair = repair(mesh, options);
  if (mesh.triangles.empty()) throw InputError("has no triangles that bound anything");
  try {
    require_solid(mesh);
  } catch (const InputError&) {
    mesh = self_union(mesh, &done.united.emplace());
    require_solid(mesh);
  }
  if (stats) *stats = done;
  return mesh;
}

}  // namespace geo
