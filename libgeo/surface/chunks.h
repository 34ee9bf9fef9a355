// Pieces as a game or a renderer wants them: closed meshes, and the bonds that held them together (§ 7).
#pragma once

#include <span>

#include "surface/pieces.h"

namespace geo {

/// What two pieces share: crack faces with one piece on either side.
struct Bond {
  std::uint32_t a = 0, b = 0;     ///< pieces, a < b
  double area = 0;                ///< model units²
  Vec3 normal = Vec3::Zero();     ///< mean, a unit vector from a to b; zero where the wall closes round one of them
  Vec3 centroid = Vec3::Zero();   ///< of the shared area
};

/// The bonds of a cut body, by (a, b). `moved`: where each surface vertex of a deformed body is; then normals and centroids are those
/// of the shared area where it is now, half way between its two sides, and areas still those of the undeformed material, which held.
std::vector<Bond> find_bonds(const Complex& complex, const Pieces& pieces, std::span<const Vec3> moved = {});

struct Chunk {
  TriangleMesh mesh;              ///< closed; patch 0: skin, else inner. Site is empty
  double volume = 0;
  Vec3 centroid = Vec3::Zero();   ///< of the material
};

/// The pieces, in descending order of volume, with the attributes of `original`, the surface that `complex` was made
/// from, or none where it is empty. Each triangle has a group, inner ones "crack", all others "skin" where the original has no groups. Inner
/// triangles without texture coordinates (0 0) get them along the mean plane of the wall that they belong to, one for
/// `tile` model units; skin that had none has 0 0. `moved`: where each surface vertex of a deformed body is; then volumes and
/// centroids are those of the deformed pieces.
std::vector<Chunk> make_chunks(const Complex& complex, const Pieces& pieces, const TriangleMesh& original, double tile, std::span<const Vec3> moved = {});

}  // namespace geo
