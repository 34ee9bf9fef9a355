#include "io/volume_file.h"

#include <openvdb/io/Stream.h>
#include <openvdb/openvdb.h>
#include <openvdb/tools/MeshToVolume.h>
#include <openvdb/tools/VolumeToMesh.h>

#include <sstream>

#include "base/error.h"
#include "io/stream.h"

namespace geo {

TriangleMesh read_volume(const std::string& path) {
  openvdb::initialize();
  std::istringstream bytes(read_all(path));
  openvdb::FloatGrid::Ptr grid;
  try {
    openvdb::io::Stream stream(bytes);
    for (const auto& g : *stream.getGrids())
      if (!grid && g) grid = openvdb::gridPtrCast<openvdb::FloatGrid>(g->isType<openvdb::FloatGrid>() ? g : nullptr);
  } catch (const std::exception&) {
    throw InputError(path + ": is not a readable OpenVDB file; it may be truncated");
  }
  if (!grid) throw InputError(path + ": holds no grid of single-precision numbers");
  const bool fog = grid->getGridClass() == openvdb::GRID_FOG_VOLUME;
  std::vector<openvdb::Vec3s> points;
  std::vector<openvdb::Vec3I> triangles;
  std::vector<openvdb::Vec4I> quads;
  openvdb::tools::volumeToMesh(*grid, points, triangles, quads, fog ? 0.5 : 0.0);
  TriangleMesh mesh;
  for (const auto& p : points) mesh.vertices.push_back({p.x(), p.y(), p.z()});
  // OpenVDB winds faces clockwise seen from outside.
  for (const auto& t : triangles) mesh.triangles.push_back({t[0], t[2], t[1]});
  for (const auto& q : quads) {
    mesh.triangles.push_back({q[0], q[2], q[1]});
    mesh.triangles.push_back({q[0], q[3], q[2]});
  }
  if (mesh.triangles.empty()) throw InputError(path + ": has no surface at its level");
  if (signed_volume(mesh) < 0)
    for (auto& t : mesh.triangles) std::swap(t[1], t[2]);
  return mesh;
}

void write_level_set(const std::string& path, const TriangleMesh& solid, double voxel) {
  openvdb::initialize();
  std::vector<openvdb::Vec3s> points;
  std::vector<openvdb::Vec3I> triangles;
  for (const Vec3& p : solid.vertices) points.emplace_back(float(p.x()), float(p.y()), float(p.z()));
  for (const auto& [a, b, c] : solid.triangles) triangles.emplace_back(a, b, c);
  const auto grid = openvdb::tools::meshToLevelSet<openvdb::FloatGrid>(*openvdb::math::Transform::createLinearTransform(voxel), points, triangles);
  write_all(path, [&](std::ostream& out) { openvdb::io::Stream(out).write({grid}); });
}

}  // namespace geo
