// An indexed triangle mesh with attributes (texture coordinates, normals, colours, groups): the
// content of surface files, and the form in which the derived surface is exported. Procedural
// models.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "kerf/vec.h"

namespace geo {

using Color = Eigen::Vector4d;  ///< red, green, blue, alpha; 0 … 1

/// Materials with their images, as a .glb (glTF 2.0) without nodes and meshes: a material for each
/// of some groups, with the group's name. It goes unchanged from a .glb that is read to one that is
/// written; the reader of .mtl files makes one, too. Copies share the bytes.
struct MaterialLibrary {
  std::shared_ptr<const std::string> glb;  ///< null: none
  /// Whether both have equal bytes, or none.
  friend bool operator==(const MaterialLibrary& a, const MaterialLibrary& b) {
    return a.glb == b.glb || (a.glb && b.glb && *a.glb == *b.glb);
  }
};

/// Attributes have one value for each corner of each triangle, so that seams and hard edges need no
/// vertices of their own. Each array is as long as the mesh's list of triangles, or empty.
struct Attributes {
  std::vector<std::array<Vec2, 3>> uv;
  std::vector<std::array<Vec2, 3>> uv2;  ///< a second set, as materials of a library use it
  std::vector<std::array<Vec3, 3>> normal;
  std::vector<std::array<Color, 3>> color;
  std::vector<std::int32_t> group;       ///< per triangle: index into group_names
  std::vector<std::string> group_names;  ///< one line of text each
  std::string materials;                 ///< the file that describes materials of these names (OBJ's mtllib), or empty
  MaterialLibrary library = {};          ///< materials of these names, where a .glb or .mtl brought them

  /// True when no array has values.
  bool empty() const { return uv.empty() && uv2.empty() && normal.empty() && color.empty() && group.empty(); }
  /// Names of the arrays that have values: "uv", "uv2", "normal", "color", "group".
  std::vector<std::string> names() const;
  /// Whether all values are equal.
  friend bool operator==(const Attributes&, const Attributes&) = default;
};

/// A plain mesh has vertices and triangles alone. A two-sided surface, derived from a crack
/// complex, also has `patch` and `site`: which crack a triangle belongs to, and which vertex of the
/// complex each vertex copies.
struct TriangleMesh {
  std::vector<Vec3> vertices;
  std::vector<Triangle> triangles;
  std::vector<std::int32_t> patch;  ///< per triangle: 0 skin, +c and −c the two sides of crack c; or empty
  std::vector<std::uint32_t> site;  ///< per vertex: vertex of the crack complex; or empty
  /// Per triangle: index of the triangle that contains it in the surface that was cut. ~0u: none,
  /// the triangle belongs to a crack. Empty array: unknown.
  std::vector<std::uint32_t> source;
  Attributes attributes;
  double unit = 0;  ///< the metres that one unit of its coordinates is; 0: nothing says so
  /// Whether this is a two-sided surface.
  bool two_sided() const { return !site.empty(); }
};

// ---- Measures

/// The corners of each triangle, in order of triangles.
std::vector<std::array<Vec3, 3>> corners_of(const TriangleMesh& mesh);
/// The box around all vertices that triangles use; empty without triangles.
Box3 bounding_box(const TriangleMesh& mesh);
/// Signed volume (divergence theorem), in model units³; positive when the normals point outwards.
double signed_volume(const TriangleMesh& mesh);
/// Total area of the triangles, in model units².
double area(const TriangleMesh& mesh);
/// The unit normal of triangle abc; zero when it has no area.
Vec3 face_normal(const Vec3& a, const Vec3& b, const Vec3& c);
/// The index of the triangle nearest to each point. Precondition: the mesh has triangles.
std::vector<std::uint32_t> nearest_triangles(const TriangleMesh& mesh, std::span<const Vec3> points);

// ---- Attributes across a cut

/// Default colour of a crack's triangles: mid grey.
inline const Color crack_color{0.5, 0.5, 0.5, 1};
/// Default group of a crack's triangles.
inline constexpr const char* crack_group = "crack";

/// Gives `derived`, a surface or piece of the complex made from `original`, the attributes of
/// `original`.
///
/// Precondition: `derived.source` holds indices of triangles of `original`, as Complex::two_sided()
/// and piece_mesh() fill it. Afterwards it is composed with the source of `original`: it names
/// triangles of the surface that `original` was cut from, ~0u for all triangles of cracks.
///
/// A corner at a corner of its source triangle copies that corner's values exactly. At other
/// corners values are interpolated linearly over the triangle, and normals normalised again.
/// Triangles that meet in an edge of equal values get equal values there. Sides of cracks that
/// `original` has keep their values. Sides made since get defaults: uv 0, the triangle's own normal
/// (out of its material), crack_color, crack_group.
///
/// Positions are undeformed. Cost follows `derived`. Throws InputError when a source is missing.
void transfer_attributes(const TriangleMesh& original, TriangleMesh& derived);

// ---- Refinement

/// A plain mesh with edges of at most `longest`. Longer edges are bisected repeatedly, for both
/// triangles of each. The shape stays to rounding, vertices keep their indices, triangles come in
/// the order of those that contain them; attributes are interpolated. An edge whose midpoint rounds
/// to one of its ends stays.
/// \param mesh  a plain mesh, without sites
/// \param longest  model units
/// \throws InputError where more than 20 million triangles would result
TriangleMesh refined(const TriangleMesh& mesh, double longest);

// ---- Procedural models at any resolution: closed, oriented outwards, free of self-intersection.
// Samples and tests use them.

/// A geodesic sphere of 20·frequency² triangles whose point in unit direction d is radius(d)·d.
/// Star-shaped, hence free of self-intersection, for any positive continuous radius.
/// \param frequency  at least 1
/// \throws InputError for a lower frequency
TriangleMesh make_star(int frequency, const std::function<double(const Vec3&)>& radius);

/// A unit sphere of 20·frequency² triangles.
TriangleMesh make_sphere(int frequency);
/// A pumpkin with nine lobes, flattened poles and a dimple at each, about 2 units across;
/// 20·frequency² triangles.
TriangleMesh make_pumpkin(int frequency);
/// An apple with a deep dimple at the stem and a shallow one below, about 2 units across;
/// 20·frequency² triangles.
TriangleMesh make_apple(int frequency);
/// A polyp: a bulb on a thin stalk that widens into its base; z upwards, about 2 units tall;
/// 20·frequency² triangles.
TriangleMesh make_polyp(int frequency);

/// An axis-aligned block [0, size] with faces divided so that no edge along an axis is longer than
/// `edge`.
/// \param size  of the block, model units
/// \param edge  model units
/// \throws InputError unless size and edge are positive
TriangleMesh make_block(const Vec3& size, double edge);

/// A capital letter A–Z of height 1, drawn with a pen of width 0.2 and extruded along z.
/// \param depth  of the extrusion, model units
/// \param resolution  number of cells per unit of height, at least 12
/// \throws InputError for a character that is not in the alphabet
TriangleMesh make_letter(char letter, double depth, int resolution);

}  // namespace geo
