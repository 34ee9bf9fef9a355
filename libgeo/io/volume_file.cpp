// read_volume(), wrapped() and write_level_set() of kerf/files.h. Through OpenVDB:
// volumeToMesh() gives the surface at an iso-value, meshToLevelSet() a level set from a closed
// surface. wrapped() does both, in coordinates scaled to voxels.
#include "kerf/files.h"

#include <openvdb/io/Stream.h>
#include <openvdb/openvdb.h>
#include <openvdb/tools/LevelSetUtil.h>
#include <openvdb/tools/MeshToVolume.h>
#include <openvdb/tools/VolumeToMesh.h>

#include <sstream>

#include "geometry/bvh.h"
#include "kerf/error.h"

namespace geo {
namespace {

openvdb::GridBase::Ptr choose(const openvdb::GridPtrVec& grids, const std::string& name, const std::string& path) {
  openvdb::GridBase::Ptr found;
  std::string names;
  std::size_t fit = 0;
  for (const auto& grid : grids) {
    if (!grid || !(grid->isType<openvdb::FloatGrid>() || grid->isType<openvdb::DoubleGrid>())) continue;
    names += (names.empty() ? "'" : ", '") + grid->getName() + "'";
    if (name.empty() || grid->getName() == name) found = grid, ++fit;
  }
  if (names.empty()) throw InputError(path + ": holds no grid of numbers");
  if (fit == 0) throw InputError(path + ": holds no grid of numbers named '" + name + "' but " + names);
  if (fit > 1)
    throw InputError(path + ": holds several grids, " + names +
                     (name.empty() ? "; choose one by its name" : "; they cannot be told apart by name"));
  return found;
}

openvdb::FloatGrid::Ptr level_set_of(const TriangleMesh& solid, double voxel) {
  openvdb::initialize();
  std::vector<openvdb::Vec3s> points;
  std::vector<openvdb::Vec3I> triangles;
  for (const Vec3& p : solid.vertices) points.emplace_back(float(p.x()), float(p.y()), float(p.z()));
  for (const auto& [a, b, c] : solid.triangles) triangles.emplace_back(a, b, c);
  return openvdb::tools::meshToLevelSet<openvdb::FloatGrid>(*openvdb::math::Transform::createLinearTransform(voxel),
                                                            points, triangles);
}

template <class Grid>
TriangleMesh surface_of(const Grid& grid, const VolumeOptions& options, const std::string& path) {
  const bool level_set = grid.getGridClass() == openvdb::GRID_LEVEL_SET;
  // A grid without a class holds distances where its background, the value far outside, is not 0.
  const bool low_inside = level_set || (grid.getGridClass() != openvdb::GRID_FOG_VOLUME && grid.background() > 0);
  const double iso = options.iso.value_or(low_inside ? 0.0 : 0.5);
  if (grid.activeVoxelCount() == 0) throw InputError(path + ": the grid is empty");
  if ((double(grid.background()) < iso) == low_inside)
    throw InputError(path + ": the level " + std::to_string(iso) +
                     " makes all space outside the grid material; choose another");
  std::vector<openvdb::Vec3s> points;
  std::vector<openvdb::Vec3I> triangles;
  std::vector<openvdb::Vec4I> quads;
  openvdb::tools::volumeToMesh(grid, points, triangles, quads, iso, options.adaptivity);
  TriangleMesh mesh;
  for (const auto& p : points) mesh.vertices.push_back({p.x(), p.y(), p.z()});
  // OpenVDB winds faces clockwise seen from outside.
  for (const auto& t : triangles) mesh.triangles.push_back({t[0], t[2], t[1]});
  for (const auto& q : quads) {
    mesh.triangles.push_back({q[0], q[2], q[1]});
    mesh.triangles.push_back({q[0], q[3], q[2]});
  }
  if (mesh.triangles.empty()) throw InputError(path + ": has no surface at the level " + std::to_string(iso));
  if (signed_volume(mesh) < 0)
    for (auto& t : mesh.triangles) std::swap(t[1], t[2]);
  return mesh;
}

}  // namespace

TriangleMesh read_volume(const std::string& path, const VolumeOptions& options) {
  openvdb::initialize();
  std::istringstream bytes(read_all(path));
  openvdb::GridPtrVecPtr grids;
  try {
    openvdb::io::Stream stream(bytes);
    grids = stream.getGrids();
  } catch (const std::exception&) {
    throw InputError(path + ": is not a readable OpenVDB file; it may be truncated");
  }
  const auto grid = choose(grids ? *grids : openvdb::GridPtrVec(), options.grid, path);
  if (const auto single = openvdb::gridPtrCast<openvdb::FloatGrid>(grid)) return surface_of(*single, options, path);
  return surface_of(*openvdb::gridPtrCast<openvdb::DoubleGrid>(grid), options, path);
}

TriangleMesh wrapped(const TriangleMesh& solid, double voxel) {
  // Coordinates in voxels about the centre, where single precision is enough.
  const Vec3 middle = bounding_box(solid).center();
  TriangleMesh scaled;
  for (const Vec3& p : solid.vertices) scaled.vertices.push_back((p - middle) / voxel);
  scaled.triangles = solid.triangles;
  TriangleMesh mesh = surface_of(*level_set_of(scaled, 1), {}, "the level set");
  const TriangleBvh tree(corners_of(solid));
  for (Vec3& p : mesh.vertices) p = middle + voxel * p;
  for (const auto& [a, b, c] : mesh.triangles)
    mesh.source.push_back(tree.closest((mesh.vertices[a] + mesh.vertices[b] + mesh.vertices[c]) / 3).triangle);
  transfer_attributes(solid, mesh);
  return mesh;
}

void write_level_set(const std::string& path, const TriangleMesh& solid, double voxel, bool fog) {
  const auto grid = level_set_of(solid, voxel);
  if (fog) openvdb::tools::sdfToFogVolume(*grid);
  grid->setName(fog ? "density" : "surface");
  write_all(path, [&](std::ostream& out) { openvdb::io::Stream(out).write({grid}); });
}

}  // namespace geo
