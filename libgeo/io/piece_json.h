// Pieces, bonds and clusters as JSON, and what the writers of pieces compute from them alike.
#pragma once

#include <vector>

#include <Eigen/Geometry>
#include <nlohmann/json.hpp>

#include "kerf/export.h"

namespace geo {

/// A point as a list of three numbers.
inline nlohmann::ordered_json json_row(const Vec3& v) { return {v.x(), v.y(), v.z()}; }

/// The JSON that write_bonds() writes.
nlohmann::ordered_json pieces_json(const std::vector<Chunk>& chunks, const std::vector<Bond>& bonds,
                                   const ChunkLabels& labels);

/// Centroids of the clusters of each level, from those of the pieces, weighted by volume.
std::vector<std::vector<Vec3>> cluster_centroids(const std::vector<Chunk>& chunks,
                                                 const std::vector<ClusterLevel>& levels);

/// Mass and principal moments of a piece about its centroid.
struct RigidBody {
  double mass = 0;                                           ///< not positive: the piece has no volume
  Vec3 inertia = Vec3::Zero();                               ///< principal moments, mass times model units²
  Eigen::Quaterniond axes = Eigen::Quaterniond::Identity();  ///< turns the principal axes into the model's
};
/// The rigid body of a piece of uniform density (mass per model units³).
RigidBody rigid_body(const Chunk& chunk, double density);

/// Unit normals at the corners of a piece: the mesh's on the skin, if it has any. Others are means,
/// weighted by area, of the triangles around the vertex that are of the same kind and differ by
/// less than 45°. Precondition: the mesh has patches.
std::vector<std::array<Vec3, 3>> corner_normals(const TriangleMesh& mesh);

/// The chunk with every array that writers read: patch, texture coordinates, groups. Throws
/// InputError where it has no triangle.
Chunk completed(Chunk chunk);

}  // namespace geo
