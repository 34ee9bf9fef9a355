// A plain indexed triangle mesh: what files hold and what the derived surface is exported as.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "base/vec.h"
#include "surface/attributes.h"

namespace geo {

/// Rows of points and of triangles. `patch` and `site` are empty for a plain mesh; for a two-sided surface they say
/// which crack a triangle belongs to (0 skin, +c and −c the two sides of crack c) and which vertex of the crack
/// complex each row copies. `source` names the triangle of the surface that was cut which a triangle is a part of.
struct TriangleMesh {
  std::vector<Vec3> vertices;
  std::vector<Triangle> triangles;
  std::vector<std::int32_t> patch;   ///< per triangle, or empty
  std::vector<std::uint32_t> site;   ///< per vertex, or empty
  std::vector<std::uint32_t> source;  ///< per triangle, ~0u: of none (a crack's); or empty: not known
  Attributes attributes;
  bool two_sided() const { return !site.empty(); }
};

/// The corners of each triangle, in order of rows.
std::vector<std::array<Vec3, 3>> corners_of(const TriangleMesh& mesh);
Box3 bounding_box(const TriangleMesh& mesh);
/// Signed volume (divergence theorem), in model units³; positive when the normals point outwards.
double signed_volume(const TriangleMesh& mesh);
/// Total area of the triangles, in model units².
double area(const TriangleMesh& mesh);

}  // namespace geo
