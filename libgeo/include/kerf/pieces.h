// The pieces of material that the cracks have made: which side of which face belongs to which piece.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "kerf/complex.h"
#include "kerf/mesh.h"

namespace geo {

/// A piece is a connected region of material. Its boundary may have several shells: an internal cavity, or a crack that
/// never reaches the skin, belongs to the piece around it.
struct Pieces {
  std::uint32_t count = 0;
  std::uint32_t shells = 0;           ///< closed surfaces that bound them, inner ones included: at least `count`
  std::vector<std::int32_t> of_side;  ///< piece of side (face, which) at [2·face + which], −1 where there is none
  std::vector<double> volume;         ///< per piece, model units³; they sum to the skin's volume
};

/// Pieces in descending order of volume (ties: by lowest face id).
Pieces find_pieces(const Complex& complex);

/// The closed boundary of one piece as a mesh of its own (patch, site and source filled). `of`: which surface vertex
/// each row is.
TriangleMesh piece_mesh(const Complex& complex, const Pieces& pieces, std::uint32_t piece,
                        std::vector<SurfaceVertexId>* of = nullptr);

// ---- Pieces as a game or a renderer wants them: closed meshes, and the bonds that held them together (§ 7).

/// What two pieces share: crack faces with one piece on either side.
struct Bond {
  std::uint32_t a = 0, b = 0;    ///< pieces, a < b
  double area = 0;               ///< model units²
  Vec3 normal = Vec3::Zero();    ///< mean, a unit vector from a to b; zero where the wall closes round one of them
  Vec3 centroid = Vec3::Zero();  ///< of the shared area
};

/// The bonds of a cut body, by (a, b). `moved`: where each surface vertex of a deformed body is; then normals and
/// centroids are those of the shared area where it is now, half way between its two sides, and areas still those of the
/// undeformed material, which held.
std::vector<Bond> find_bonds(const Complex& complex, const Pieces& pieces, std::span<const Vec3> moved = {});

struct Chunk {
  TriangleMesh mesh;  ///< closed; patch 0: skin, else inner. Site is empty
  double volume = 0;
  Vec3 centroid = Vec3::Zero();  ///< of the material
};

/// The pieces, in descending order of volume, with the attributes of `original`, the surface that `complex` was made
/// from, or none where it is empty. Each triangle has a group, inner ones "crack", all others "skin" where the original
/// has no groups. Inner triangles without texture coordinates (0 0) get them along the mean plane of the wall that they
/// belong to, one for `tile` model units; skin that had none has 0 0. `moved`: where each surface vertex of a deformed
/// body is; then volumes and centroids are those of the deformed pieces.
std::vector<Chunk> make_chunks(const Complex& complex, const Pieces& pieces, const TriangleMesh& original, double tile,
                               std::span<const Vec3> moved = {});

// ---- Convex bodies that stand for a piece in a physics engine.

/// The convex hulls, of `corners` corners at most each, of at most `parts` parts of a closed mesh. Parts are made by
/// planes across the principal axes of what is divided, the one first that saves most volume of hulls (after Mamou and
/// Ghorbel 2009), while that is more than a hundredth of the whole hull's. Hulls of all their corners cover the mesh.
/// None where it lies in one plane.
std::vector<TriangleMesh> convex_parts(const TriangleMesh& mesh, std::size_t parts, std::size_t corners);

}  // namespace geo
