// What a surface carries besides its shape: texture coordinates, normals, colours, groups; and how
// cutting keeps them.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "kerf/vec.h"

namespace geo {

struct TriangleMesh;

using Color = Eigen::Vector4d;  ///< red, green, blue, alpha; 0 … 1

/// One value for each corner of each triangle, so that seams and hard edges need no vertices of
/// their own. Each array has a row for each triangle of its mesh, or none at all.
struct Attributes {
  std::vector<std::array<Vec2, 3>> uv;
  std::vector<std::array<Vec3, 3>> normal;
  std::vector<std::array<Color, 3>> color;
  std::vector<std::int32_t> group;       ///< per triangle: a row of group_names
  std::vector<std::string> group_names;  ///< one line of text each
  std::string materials;                 ///< the file that describes materials of these names (OBJ's mtllib), or empty

  bool empty() const { return uv.empty() && normal.empty() && color.empty() && group.empty(); }
  /// The names of those that are there: "uv", "normal", "color", "group".
  std::vector<std::string> names() const;
  friend bool operator==(const Attributes&, const Attributes&) = default;
};

/// What the corners of a crack's triangle have when nothing else is known: uv 0, the triangle's own
/// normal (out of the material that it bounds), mid grey, the group "crack".
inline const Color crack_color{0.5, 0.5, 0.5, 1};
inline constexpr const char* crack_group = "crack";
/// The unit normal of triangle abc; zero when it has no area.
Vec3 face_normal(const Vec3& a, const Vec3& b, const Vec3& c);

/// Gives `derived`, a surface or piece of the complex that was made from `original`, the attributes
/// of `original`. `derived.source` must hold rows of `original`, as Complex::two_sided and
/// piece_mesh fill it; afterwards it holds what those rows name in turn: where `original` was cut
/// from another surface, rows of that one, and ~0u for all triangles of cracks. A corner that
/// stands on a corner of its source triangle gets that one's values to the bit, any other values
/// interpolated linearly over the triangle (normals made unit again). Two triangles that meet in an
/// edge of equal values get equal values there. A side of a crack that `original` has already keeps
/// its values; those made since get the ones named above. Works on undeformed positions. Cost
/// follows `derived`. Throws InputError when a source is not there.
void carry(const TriangleMesh& original, TriangleMesh& derived);

// ---- A plain indexed triangle mesh: what files hold and what the derived surface is exported as.

/// Rows of points and of triangles. `patch` and `site` are empty for a plain mesh; for a two-sided
/// surface they say which crack a triangle belongs to (0 skin, +c and −c the two sides of crack c)
/// and which vertex of the crack complex each row copies. `source` names the triangle of the
/// surface that was cut which a triangle is a part of.
struct TriangleMesh {
  std::vector<Vec3> vertices;
  std::vector<Triangle> triangles;
  std::vector<std::int32_t> patch;    ///< per triangle, or empty
  std::vector<std::uint32_t> site;    ///< per vertex, or empty
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
/// The triangle of a non-empty mesh that is nearest to each point, by its row.
std::vector<std::uint32_t> nearest_triangles(const TriangleMesh& mesh, std::span<const Vec3> points);

}  // namespace geo
