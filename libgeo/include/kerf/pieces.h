// Pieces of material that cracks have separated, and their export for games and renderers (§ 7).
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "kerf/complex.h"
#include "kerf/mesh.h"
#include "kerf/progress.h"

namespace geo {

/// A piece is a connected region of material. Its boundary may have several shells: an internal
/// cavity, or a crack that never reaches the skin, belongs to the piece around it.
struct Pieces {
  std::uint32_t count = 0;
  std::uint32_t shells = 0;           ///< connected components of S_A, inner shells included: at least `count`
  std::vector<std::int32_t> of_side;  ///< piece of side (face, which) at [2·face + which], −1 for no side
  std::vector<double> volume;         ///< per piece, model units³; they sum to the skin's volume
};

/// Finds the pieces, in descending order of volume (ties: by lowest face id). Cost follows the
/// whole complex.
Pieces find_pieces(const Complex& complex);

/// The closed boundary of one piece as a mesh of its own, with patch, site and source. `vertex_of`,
/// where given, receives for each vertex of the mesh the vertex of S_A.
TriangleMesh piece_mesh(const Complex& complex, const Pieces& pieces, std::uint32_t piece,
                        std::vector<SurfaceVertexId>* vertex_of = nullptr);

// ---- Chunks and bonds: pieces with attributes, and the areas that held them together

/// The crack faces that two pieces share.
struct Bond {
  std::uint32_t a = 0, b = 0;    ///< pieces, a < b
  double area = 0;               ///< model units²
  Vec3 normal = Vec3::Zero();    ///< mean, a unit vector from a to b; zero where the faces close around one piece
  Vec3 centroid = Vec3::Zero();  ///< of the shared area
  /// Elastic section modulus for the worst axis in the mean plane, model units³: bending by the
  /// moment M stresses the edge of the wall by at most M / section.
  double section = 0;
};

/// The bonds of a cut body, ordered by (a, b).
/// \param pieces  of this complex, as find_pieces() gives them
/// \param moved  where given, the deformed position of each vertex of S_A; then normals and
///   centroids are deformed ones, half way between the two sides, and areas and sections still
///   undeformed ones
std::vector<Bond> find_bonds(const Complex& complex, const Pieces& pieces, std::span<const Vec3> moved = {});

/// A piece as a mesh for export.
struct Chunk {
  TriangleMesh mesh;             ///< closed; patch 0: skin, else inner faces; without sites
  double volume = 0;             ///< model units³
  Vec3 centroid = Vec3::Zero();  ///< of the material
};

/// The pieces in descending order of volume. Each triangle has a group: inner ones "crack", and all
/// others "skin" where the original has no groups. Inner triangles without texture coordinates get
/// them by projection along the mean plane of their bond; skin without has (0, 0).
/// \param pieces  of this complex, as find_pieces() gives them
/// \param original  the surface that `complex` was made from, for its attributes; empty: none
/// \param tile  model units of one unit of uv on inner triangles
/// \param moved  where given, the deformed position of each vertex of S_A; then volumes and
///   centroids are deformed ones
std::vector<Chunk> make_chunks(const Complex& complex, const Pieces& pieces, const TriangleMesh& original, double tile,
                               std::span<const Vec3> moved = {});

// ---- Mass and collision shapes

/// Volume integrals of a closed mesh, for a density of 1.
struct MassProperties {
  double volume = 0;             ///< model units³; the mass
  Vec3 centroid = Vec3::Zero();  ///< of the material; the middle of the box where the volume is not positive
  Mat3 inertia = Mat3::Zero();   ///< tensor about the centroid, model units⁵
};
/// Integrals over the material, exact to rounding: sums over tetrahedra from the middle of the box.
MassProperties mass_properties(const TriangleMesh& mesh);

/// Approximate convex decomposition of a closed mesh. Planes across principal axes divide it
/// greedily; each division saves the most hull volume (after Mamou and Ghorbel 2009). It ends when
/// the saving is at most a hundredth of the whole hull's volume. Hulls with no limit on vertices
/// cover the mesh.
/// \param max_hulls  limit on their number
/// \param max_vertices  limit on the vertices of each
/// \return the hulls; empty for a planar mesh
/// \throws Interrupted where `progress` asks for it
std::vector<TriangleMesh> convex_decomposition(const TriangleMesh& mesh, std::size_t max_hulls,
                                               std::size_t max_vertices, const Progress& progress = {});

}  // namespace geo
