// The derived two-sided surface as contact looks at it: rows of triangles, and what belongs to which site.
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "contact/detection/vertex_fans.h"
#include "contact/surface/copies.h"
#include "kerf/complex.h"

namespace geo {

struct ContactSurface {
  std::vector<Triangle> triangles;  ///< of surface vertex ids
  std::vector<std::uint32_t> side;  ///< per triangle: 2 · face + which of its two sides; ascending
  std::vector<std::uint32_t> site;  ///< per surface vertex; of dead ones a number that no other has
  double edge = 0;                  ///< mean length of edges, model units, at rest
  /// The rows of a face's triangles: the first, and after the last.
  std::pair<std::size_t, std::size_t> rows_of(FaceId f) const;
};

/// Cost follows the whole surface.
ContactSurface contact_surface(const Complex& complex);
/// The same, but for `edge`, of a complex that a crack step has made of the one that `before` is of: what has not
/// changed is copied.
ContactSurface grown_surface(const ContactSurface& before, const Complex& grown, const CrackDelta& crack);
/// ContactSurface::edge. Lengths are added up one after another, so that cost follows the whole surface.
double mean_edge(const ContactSurface& surface, const Complex& complex);

/// A third of the triangles at rest about a vertex of the derived surface, model units².
double area_about(const Complex& complex, SurfaceVertexId v);

/// Per vertex that is together with others the sum of the normals of its triangles (`fans`), twice their areas long, at
/// the given positions.
std::vector<Vec3> vertex_normals(const ContactSurface& surface, const VertexFans& fans, const Copies& copies,
                                 const std::vector<Vec3>& positions);
/// The same of triangles alone that touch the other side of their face (`together`: vertices_together()); zero where
/// there is none.
std::vector<Vec3> shared_normals(const ContactSurface& surface, std::span<const std::uint32_t> together,
                                 const std::vector<Vec3>& positions);

}  // namespace geo
