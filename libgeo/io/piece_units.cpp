// in_metres() of kerf/export.h, and what single precision does to pieces.
#include <cmath>

#include "base/single_precision.h"
#include "kerf/contact.h"
#include "kerf/export.h"

namespace geo {
namespace {

std::vector<Bond> scaled(std::vector<Bond> bonds, double unit) {
  for (Bond& bond : bonds) {
    bond.area *= unit * unit;
    bond.section *= unit * unit * unit;
    bond.centroid *= unit;
  }
  return bonds;
}

}  // namespace

PieceSet in_metres(const std::vector<Chunk>& chunks, const std::vector<Bond>& bonds, const ChunkLabels& labels) {
  PieceSet set{chunks, bonds, labels};
  const double unit = chunks.empty() ? 0 : chunks[0].mesh.unit;
  if (!(unit > 0) || unit == 1) return set;
  const double cubed = unit * unit * unit;
  for (Chunk& chunk : set.chunks) {
    for (Vec3& p : chunk.mesh.vertices) p *= unit;
    chunk.mesh.unit = 1;
    chunk.volume *= cubed;
    chunk.centroid *= unit;
  }
  set.bonds = scaled(std::move(set.bonds), unit);
  for (ClusterLevel& level : set.labels.levels) {
    for (double& volume : level.volume) volume *= cubed;
    level.bonds = scaled(std::move(level.bonds), unit);
  }
  return set;
}

std::size_t crossings_in_single_precision(const Chunk& chunk) {
  TriangleMesh mesh;
  mesh.triangles = chunk.mesh.triangles;
  mesh.patch = chunk.mesh.patch;
  mesh.site = chunk.mesh.site;
  for (const Vec3& p : chunk.mesh.vertices)
    for (double& x : mesh.vertices.emplace_back(p - chunk.centroid)) x = to_single(x);
  return count_crossings(mesh);
}

Vec3 single_precision_offset(const Box3& box) {
  // A coordinate c has an error of 2⁻²⁴ |c|. Walls of neighbouring pieces fit while that is less
  // than a quarter of a pixel where a piece, a sixteenth of the model, fills a picture of 4096
  // pixels: 2⁻¹⁸ diagonals.
  constexpr double farthest = 64;  // diagonals from the origin, 2⁻¹⁸ / 2⁻²⁴
  if (!(box.diagonal() > 0)) return Vec3::Zero();
  const double largest = std::max(box.lo.cwiseAbs().maxCoeff(), box.hi.cwiseAbs().maxCoeff());
  if (!(largest > farthest * box.diagonal())) return Vec3::Zero();
  Vec3 offset = box.center();
  for (double& x : offset) x = to_single(x);
  return offset;
}

Box3 bounding_box(const std::vector<Chunk>& chunks) {
  Box3 box;
  for (const Chunk& chunk : chunks) box.add(bounding_box(chunk.mesh));
  return box;
}

}  // namespace geo
