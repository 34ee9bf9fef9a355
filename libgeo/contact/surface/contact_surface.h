// The derived two-sided surface in the form that contact needs: triangles and sites.
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "contact/detection/vertex_fans.h"
#include "contact/surface/coincident_vertices.h"
#include "kerf/complex.h"

namespace geo {

/// Triangles of the derived surface. Coincident vertices have the same site.
struct ContactSurface {
  std::vector<Triangle> triangles;  ///< of surface vertices
  std::vector<std::uint32_t> side;  ///< per triangle: 2 · face + which of its two sides; ascending
  std::vector<std::uint32_t> site;  ///< per surface vertex; for dead ones a number that occurs once
  double edge = 0;                  ///< mean length of edges at rest, model units

  /// The triangles of a face: the index of the first, and one past the last.
  std::pair<std::size_t, std::size_t> triangles_of(FaceId f) const;
};

/// The contact surface of a complex. The cost follows the whole surface.
ContactSurface contact_surface(const Complex& complex);
/// The contact surface, except for `edge`, of the complex `after` a crack step, given that of the
/// complex before it. Unchanged triangles are copied.
ContactSurface updated_contact_surface(const ContactSurface& before, const Complex& after, const CrackDelta& crack);
/// ContactSurface::edge. Adds lengths in a fixed order; the cost follows the whole surface.
double mean_edge(const ContactSurface& surface, const Complex& complex);

/// A third of the area, at rest, of the triangles around a surface vertex, model units².
double vertex_area(const Complex& complex, SurfaceVertexId v);

/// For each coincident vertex the sum of its triangles' normals at the given positions, each twice
/// the area long. Zero for vertices that coincide with no other. `fans`: of the surface.
std::vector<Vec3> vertex_normals(const ContactSurface& surface, const VertexFans& fans,
                                 const CoincidentVertices& coincident, const std::vector<Vec3>& positions);
/// As vertex_normals(), only over triangles that coincide with the other side of their face; zero
/// if there are none. `representative`: coincident_representatives().
std::vector<Vec3> coincident_side_normals(const ContactSurface& surface, std::span<const std::uint32_t> representative,
                                          const std::vector<Vec3>& positions);
/// For each coincident vertex the normal of the sheet that is closed there:
/// coincident_side_normals() where it is not zero; else the sum of the normals of its triangles on
/// faces with two sides, each twice the area long; else that in `of_all`, vertex_normals(). At the
/// rim of a sheet, triangles of the skin tell nothing of where the other side is.
std::vector<Vec3> normals_across_sheets(const ContactSurface& surface, std::span<const std::uint32_t> representative,
                                        const std::vector<Vec3>& of_all, const std::vector<Vec3>& positions);

}  // namespace geo
