#include "sampling/signed_distance.h"

#include <openvdb/openvdb.h>
#include <openvdb/tools/Interpolation.h>
#include <openvdb/tools/MeshToVolume.h>

#include <limits>

namespace geo {

struct SignedDistance::Grid {
  openvdb::FloatGrid::Ptr values;
};

SignedDistance::SignedDistance(const TriangleMesh& solid, double voxel) : grid_(std::make_unique<Grid>()) {
  openvdb::initialize();
  std::vector<openvdb::Vec3s> points;
  std::vector<openvdb::Vec3I> triangles;
  points.reserve(solid.vertices.size());
  for (const Vec3& p : solid.vertices) points.emplace_back(static_cast<float>(p.x() / voxel), static_cast<float>(p.y() / voxel), static_cast<float>(p.z() / voxel));
  for (const auto& [a, b, c] : solid.triangles) triangles.emplace_back(a, b, c);
  openvdb::tools::QuadAndTriangleDataAdapter<openvdb::Vec3s, openvdb::Vec3I> mesh(points, triangles);
  const auto transform = openvdb::math::Transform::createLinearTransform(voxel);
  grid_->values = openvdb::tools::meshToVolume<openvdb::FloatGrid>(mesh, *transform, 3.0f, std::numeric_limits<float>::max());
}

SignedDistance::~SignedDistance() = default;

double SignedDistance::at(const Vec3& p) const {
  const auto accessor = grid_->values->getConstUnsafeAccessor();
  return openvdb::tools::BoxSampler::sample(accessor, grid_->values->transform().worldToIndex(openvdb::Vec3d(p.x(), p.y(), p.z())));
}

}  // namespace geo
