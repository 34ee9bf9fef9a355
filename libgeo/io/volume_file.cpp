// read_volume() and write_level_set() of kerf/files.h, wrapped() of kerf/repair.h. Through OpenVDB:
// volumeToMesh() gives the surface at an iso-value, meshToLevelSet() a level set from a closed
// surface, meshToUnsignedDistanceField() distances from open sheets.
#include "kerf/files.h"

#include <openvdb/io/Stream.h>
#include <openvdb/openvdb.h>
#include <openvdb/tools/ChangeBackground.h>
#include <openvdb/tools/Composite.h>
#include <openvdb/tools/LevelSetUtil.h>
#include <openvdb/tools/MeshToVolume.h>
#include <openvdb/tools/VolumeToMesh.h>

#include <algorithm>
#include <atomic>
#include <optional>
#include <sstream>

#include "geometry/bvh.h"
#include "kerf/check.h"
#include "kerf/crack.h"
#include "kerf/error.h"
#include "kerf/parallel.h"
#include "kerf/progress.h"
#include "kerf/repair.h"
#include "surface/shells.h"

namespace geo {
namespace {

openvdb::GridBase::Ptr choose(const openvdb::GridPtrVec& grids, const std::string& name, const std::string& path) {
  openvdb::GridBase::Ptr found;
  std::string names;
  std::size_t fit = 0;
  for (const auto& grid : grids) {
    if (!grid || !(grid->isType<openvdb::FloatGrid>() || grid->isType<openvdb::DoubleGrid>())) continue;
    names += (names.empty() ? "'" : ", '") + grid->getName() + "'";
    if (name.empty() || grid->getName() == name) {
      found = grid;
      ++fit;
    }
  }
  if (names.empty()) throw InputError(path + ": holds no grid of numbers");
  if (fit == 0) throw InputError(path + ": holds no grid of numbers named '" + name + "' but " + names);
  if (fit > 1)
    throw InputError(path + ": holds several grids, " + names +
                     (name.empty() ? "; choose one by its name" : "; they cannot be told apart by name"));
  return found;
}

// Stops OpenVDB where the caller does. Its threads ask.
class Interrupter : public openvdb::util::NullInterrupter {
 public:
  explicit Interrupter(const Progress& progress) : progress_(progress) {}
  bool wasInterrupted(int = -1) override {
    if (!stopped_ && progress_ && !progress_("distances", 0, 1)) stopped_ = true;
    return stopped_;
  }
  // A distance field that is interrupted is incomplete.
  void throw_if_stopped() const {
    if (stopped_) throw Interrupted();
  }

 private:
  const Progress& progress_;
  std::atomic<bool> stopped_ = false;
};

openvdb::FloatGrid::Ptr level_set_of(const TriangleMesh& solid, double voxel, const Progress& progress = {}) {
  openvdb::initialize();
  std::vector<openvdb::Vec3s> points;
  std::vector<openvdb::Vec3I> triangles;
  for (const Vec3& p : solid.vertices) points.emplace_back(float(p.x()), float(p.y()), float(p.z()));
  for (const auto& [a, b, c] : solid.triangles) triangles.emplace_back(a, b, c);
  Interrupter interrupter(progress);
  auto grid = openvdb::tools::meshToLevelSet<openvdb::FloatGrid>(
      interrupter, *openvdb::math::Transform::createLinearTransform(voxel), points, triangles);
  interrupter.throw_if_stopped();
  return grid;
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

// The triangles of one mesh after those of another. Both have the same arrays of attributes, unless
// one is empty.
TriangleMesh joined(TriangleMesh to, const TriangleMesh& from) {
  if (to.triangles.empty()) return from;
  const auto first = static_cast<std::uint32_t>(to.vertices.size());
  const auto append = [](auto& values, const auto& more) { values.insert(values.end(), more.begin(), more.end()); };
  append(to.vertices, from.vertices);
  for (const auto& [a, b, c] : from.triangles) to.triangles.push_back({a + first, b + first, c + first});
  append(to.source, from.source);
  append(to.attributes.uv, from.attributes.uv);
  append(to.attributes.normal, from.attributes.normal);
  append(to.attributes.color, from.attributes.color);
  append(to.attributes.group, from.attributes.group);
  return to;
}

// The shells that voxels of this edge do not resolve: those of a smaller mean thickness, which is
// twice the volume over the area.
TriangleMesh thin_shells(const TriangleMesh& closed, double voxel) {
  TriangleMesh thin;
  thin.vertices = closed.vertices;
  const auto shell_of = shell_of_triangles(closed);
  const std::size_t count = shell_of.empty() ? 0 : *std::max_element(shell_of.begin(), shell_of.end()) + 1u;
  std::vector<double> volume(count, 0), surface(count, 0);
  const Vec3 middle = bounding_box(closed).center();
  const auto corners = corners_of(closed);
  for (std::size_t t = 0; t < corners.size(); ++t) {
    const Vec3 a = corners[t][0] - middle, b = corners[t][1] - middle, c = corners[t][2] - middle;
    volume[shell_of[t]] += a.dot(b.cross(c)) / 6;
    surface[shell_of[t]] += (b - a).cross(c - a).norm() / 2;
  }
  for (std::size_t t = 0; t < corners.size(); ++t)
    if (2 * std::abs(volume[shell_of[t]]) < voxel * surface[shell_of[t]]) thin.triangles.push_back(closed.triangles[t]);
  return thin;
}

using FloatGrid = openvdb::FloatGrid;

// A mesh in units of voxels about a centre, where single precision is enough.
TriangleMesh in_voxels(const TriangleMesh& mesh, const Vec3& middle, double voxel) {
  TriangleMesh scaled;
  for (const Vec3& p : mesh.vertices) scaled.vertices.push_back((p - middle) / voxel);
  scaled.triangles = mesh.triangles;
  return scaled;
}

// A level set of plates around triangles, which reach `offset` voxels to both sides. Distances are
// linear but at the triangles themselves, so that with an offset of a voxel or more interpolation
// is exact.
FloatGrid::Ptr plate_of(const TriangleMesh& sheets, double offset, const Progress& progress) {
  std::vector<openvdb::Vec3s> points;
  std::vector<openvdb::Vec3I> triangles;
  for (const Vec3& p : sheets.vertices) points.emplace_back(float(p.x()), float(p.y()), float(p.z()));
  for (const auto& [a, b, c] : sheets.triangles) triangles.emplace_back(a, b, c);
  const auto half_width = float(openvdb::LEVEL_SET_HALF_WIDTH);
  Interrupter interrupter(progress);
  const auto grid = openvdb::tools::meshToUnsignedDistanceField<FloatGrid>(
      interrupter, *openvdb::math::Transform::createLinearTransform(1.0), points, triangles, {},
      half_width + float(offset));
  interrupter.throw_if_stopped();
  for (auto value = grid->beginValueOn(); value; ++value) value.setValue(*value - float(offset));
  openvdb::tools::changeBackground(grid->tree(), half_width);
  grid->setGridClass(openvdb::GRID_LEVEL_SET);
  return grid;
}

// Halves the distance of vertices from the triangles that a plate is around.
void halve_plate(TriangleMesh& plate, const TriangleMesh& sheets) {
  const TriangleBvh tree(corners_of(sheets));
  parallel_for(plate.vertices.size(), 256, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v) {
      Vec3& p = plate.vertices[v];
      p = (p + tree.closest(p).point) / 2;
    }
  });
}

// Plates as voxels of their own thickness make them: twice as thick at first. Nothing where they
// cross then, as in folds narrower than a voxel.
std::optional<TriangleMesh> coarse_plate(const TriangleMesh& sheets, double voxel, const Progress& progress) {
  const Vec3 middle = bounding_box(sheets).center();
  const TriangleMesh scaled = in_voxels(sheets, middle, voxel);
  TriangleMesh mesh = surface_of(*plate_of(scaled, 1, progress), {}, "the level set");
  halve_plate(mesh, scaled);
  for (Vec3& p : mesh.vertices) p = middle + voxel * p;
  return check_surface(mesh, SelfIntersections::find).good() ? std::optional(std::move(mesh)) : std::nullopt;
}

// The surface around closed parts and open sheets, without attributes. Where there are sheets,
// voxels have half the edge, so that a plate is two of them thick.
TriangleMesh surface_around(const TriangleMesh& closed, TriangleMesh sheets, double voxel, const Progress& progress) {
  openvdb::initialize();
  sheets = joined(std::move(sheets), thin_shells(closed, voxel));
  const bool plates = !sheets.triangles.empty();
  // Half voxels of more sheets than this take gigabytes.
  constexpr double most = 1 << 22;
  if (plates && closed.triangles.empty() && area(sheets) / (voxel * voxel / 4) > most)
    if (auto mesh = coarse_plate(sheets, voxel, progress)) return std::move(*mesh);
  const double edge = plates ? voxel / 2 : voxel;
  const Vec3 middle = bounding_box(joined(closed, sheets)).center();
  FloatGrid::Ptr grid;
  if (!closed.triangles.empty()) grid = level_set_of(in_voxels(closed, middle, edge), 1, progress);
  if (plates) {
    const FloatGrid::Ptr plate = plate_of(in_voxels(sheets, middle, edge), 1, progress);
    if (grid)
      openvdb::tools::csgUnion(*grid, *plate);
    else
      grid = plate;
  }
  if (!grid) throw InputError("has no triangles that bound anything");
  report(progress, "surface", 0, 1);
  TriangleMesh mesh = surface_of(*grid, {}, "the level set");
  report(progress, "surface", 1, 1);
  for (Vec3& p : mesh.vertices) p = middle + edge * p;
  return mesh;
}

// Gives each triangle the attributes of the nearest one of `from`, which becomes its source.
void take_attributes(const TriangleMesh& from, TriangleMesh& mesh, const Progress& progress) {
  const TriangleBvh tree(corners_of(from));
  for (const auto& [a, b, c] : mesh.triangles) {
    report(progress, "attributes", mesh.source.size(), mesh.triangles.size());
    mesh.source.push_back(tree.closest((mesh.vertices[a] + mesh.vertices[b] + mesh.vertices[c]) / 3).triangle);
  }
  transfer_attributes(from, mesh);
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

TriangleMesh wrapped(const TriangleMesh& mesh, double voxel, OpenParts open, const Progress& progress) {
  TriangleMesh closed = mesh;
  const TriangleMesh sheets = take_sheets(closed, 0, open);
  TriangleMesh result = surface_around(closed, sheets, voxel, progress);
  take_attributes(mesh, result, progress);
  return result;
}

TriangleMesh wrapped_solid(TriangleMesh mesh, double voxel, const RepairOptions& options, OpenParts open,
                           WrapStats* stats, const Progress& progress) {
  WrapStats done;
  const TriangleMesh sheets = take_sheets(mesh, options.weld_distance, open, &done.sheets);
  done.repair = repair(mesh, options);
  if (mesh.triangles.empty() && sheets.triangles.empty()) throw InputError("has no triangles that bound anything");
  TriangleMesh solid = surface_around(mesh, sheets, voxel, progress);
  take_attributes(joined(std::move(mesh), sheets), solid, progress);
  // In ambiguous cells OpenVDB's surface may touch itself.
  report(progress, "check", 0, 1);
  if (!check_surface(solid, SelfIntersections::find).good()) solid = repaired_solid(std::move(solid));
  if (stats) *stats = done;
  return solid;
}

void write_level_set(const std::string& path, const TriangleMesh& solid, double voxel, bool fog) {
  const auto grid = level_set_of(solid, voxel);
  if (fog) openvdb::tools::sdfToFogVolume(*grid);
  grid->setName(fog ? "density" : "surface");
  write_all(path, [&](std::ostream& out) { openvdb::io::Stream(out).write({grid}); });
}

}  // namespace geo
