// Volumes: files of OpenVDB are read as solids that can be sampled.
#include <openvdb/io/Stream.h>
#include <openvdb/openvdb.h>

#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>
#include <random>

#include "geometry/bvh.h"
#include "kerf/check.h"
#include "kerf/error.h"
#include "kerf/files.h"
#include "kerf/mesh.h"
#include "kerf/nodes.h"
#include "kerf/repair.h"

using namespace geo;

namespace {

/// A file in a folder of its own, removed at the end.
struct Scratch {
  std::filesystem::path folder =
      std::filesystem::temp_directory_path() / ("kerf-volumes-" + std::to_string(std::random_device{}()));
  std::string file = (folder / "v.vdb").string();
  Scratch() { std::filesystem::create_directories(folder); }
  ~Scratch() { std::filesystem::remove_all(folder); }
  void write(const openvdb::GridPtrVec& grids) const {
    openvdb::initialize();
    std::ofstream out(file, std::ios::binary);
    openvdb::io::Stream(out).write(grids);
  }
};

template <class Grid>
typename Grid::Ptr ball(const char* name, double value) {
  auto grid = Grid::create(0);
  grid->setName(name);
  auto accessor = grid->getAccessor();
  for (int x = -8; x <= 8; ++x)
    for (int y = -8; y <= 8; ++y)
      for (int z = -8; z <= 8; ++z)
        if (const double d = 7 - std::sqrt(double(x * x + y * y + z * z)); d > 0)
          accessor.setValue({x, y, z}, static_cast<typename Grid::ValueType>(value * std::min(1.0, d / 4)));
  return grid;
}

}  // namespace

TEST_CASE("a level set and a fog volume come back as the solid that was written, and nodes are inside it") {
  const Scratch scratch;
  for (const auto& [name, mesh] :
       std::vector<std::pair<std::string, TriangleMesh>>{{"sphere", make_sphere(8)},
                                                         {"block", make_block({2, 1, 1}, 0.25)},
                                                         {"pumpkin", make_pumpkin(8)},
                                                         {"polyp", make_polyp(8)},
                                                         {"letter", make_letter('K', 0.25, 12)}})
    for (const bool fog : {false, true}) {
      INFO(name << (fog ? ", fog" : ", level set"));
      const double voxel = 0.012 * bounding_box(mesh).diagonal();
      write_level_set(scratch.file, mesh, voxel, fog);
      const TriangleMesh surface = read_volume(scratch.file);
      require_solid(surface);
      // A fog volume is full three voxels deep: its half-density level lies that much further in.
      if (!fog)
        CHECK(signed_volume(surface) == Approx(signed_volume(mesh)).epsilon(0.03));
      else
        CHECK(signed_volume(surface) < signed_volume(mesh));
      SampleOptions options;
      options.count = 800;
      options.across = 3;
      const NodeSet nodes = sample_nodes(surface, options);
      CHECK(nodes.size() == 800);
      const TriangleBvh tree(corners_of(surface));
      for (const Vec3& p : nodes.position) REQUIRE(tree.inside(p));
    }
}

TEST_CASE("a surface is wrapped around parts that overlap, and has their dress") {
  TriangleMesh boxes = make_block({1, 1, 1}, 0.5);
  const auto n = static_cast<std::uint32_t>(boxes.vertices.size());
  const auto rows = boxes.triangles.size();
  for (std::uint32_t v = 0; v < n; ++v) boxes.vertices.push_back(boxes.vertices[v] + Vec3(0.5, 0.5, 0.5));
  for (std::size_t t = 0; t < rows; ++t)
    boxes.triangles.push_back({boxes.triangles[t][0] + n, boxes.triangles[t][1] + n, boxes.triangles[t][2] + n});
  for (Vec3& p : boxes.vertices) p += Vec3(1e7, 0, 0);
  boxes.attributes.group_names = {"first", "second"};
  for (std::size_t t = 0; t < 2 * rows; ++t) boxes.attributes.group.push_back(t >= rows);
  const TriangleMesh mesh = wrapped(boxes, 0.04);
  CHECK(check_surface(mesh, SelfIntersections::find).first_problem == "");
  CHECK(signed_volume(mesh) == Approx(2 - 0.125).epsilon(0.01));
  REQUIRE(mesh.attributes.group.size() == mesh.triangles.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Vec3& p = mesh.vertices[mesh.triangles[t][0]];
    if (p.x() > 1e7 + 1.1) REQUIRE(mesh.attributes.group[t] == 1);
    if (p.x() < 1e7 + 0.4) REQUIRE(mesh.attributes.group[t] == 0);
  }
}

namespace {

// A grid of squares over the unit square, turned and moved by `place`.
TriangleMesh sheet_at(const Eigen::Isometry3d& place, double wave) {
  TriangleMesh mesh;
  constexpr std::uint32_t n = 20;
  for (std::uint32_t i = 0; i <= n; ++i)
    for (std::uint32_t j = 0; j <= n; ++j) {
      const double x = double(i) / n, y = double(j) / n;
      mesh.vertices.push_back(place * Vec3(x, y, wave * std::sin(6.3 * x)));
    }
  for (std::uint32_t i = 0; i < n; ++i)
    for (std::uint32_t j = 0; j < n; ++j) {
      const std::uint32_t a = i * (n + 1) + j, b = a + n + 1;
      mesh.triangles.push_back({a, b, b + 1});
      mesh.triangles.push_back({a, b + 1, a + 1});
    }
  return mesh;
}

}  // namespace

TEST_CASE("an open sheet becomes a plate one voxel thick, at every size, wherever it lies, from one side or two") {
  Eigen::Isometry3d turned = Eigen::Isometry3d::Identity();
  turned.rotate(Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()));
  turned.translation() = Vec3(100.03, -7, 0.017);
  for (const auto& place : {Eigen::Isometry3d(Eigen::Isometry3d::Identity()), turned})
    for (const double wave : {0.0, 0.1})
      for (const double share : {0.005, 0.0137, 0.02, 0.05, 0.1}) {
        TriangleMesh sheet = sheet_at(place, wave);
        const double voxel = share * bounding_box(sheet).diagonal(), surface = area(sheet);
        CAPTURE(wave, share);
        WrapStats stats;
        const TriangleMesh plate = wrapped_solid(sheet, voxel, {}, OpenParts::by_area, &stats);
        CHECK(stats.sheets.sheets == 1);
        // The rim is a half pipe of that thickness, 4 to 4.2 long, of which coarse voxels cut edges
        // off.
        const double rim = 3.1416 / 8 * voxel * voxel * (wave > 0 ? 4.1 : 4.0);
        CHECK(signed_volume(plate) > 0.95 * surface * voxel);
        CHECK(signed_volume(plate) < 1.02 * (surface * voxel + rim));
        CHECK(check_surface(plate, SelfIntersections::find).first_problem == "");
        for (const auto& [a, b, c] : std::vector(sheet.triangles)) sheet.triangles.push_back({a, c, b});
        CHECK(signed_volume(wrapped_solid(sheet, voxel)) == Approx(signed_volume(plate)).epsilon(1e-6));
      }
}

TEST_CASE("very fine voxels of a large sheet make the same plate with vertices as far apart as voxels") {
  const TriangleMesh sheet = sheet_at(Eigen::Isometry3d::Identity(), 0);
  const double voxel = 0.0009;  // more than four million half voxels
  const TriangleMesh plate = wrapped(sheet, voxel);
  CHECK(signed_volume(plate) == Approx(voxel).epsilon(0.01));
  CHECK(bounding_box(plate).hi.z() == Approx(voxel / 2).epsilon(1e-3));
}

TEST_CASE("plates, solids and shells thinner than a voxel are wrapped together") {
  TriangleMesh mesh = make_block({1, 1, 1}, 0.5);
  const double block = signed_volume(mesh);
  const auto append = [&](const TriangleMesh& other, const Vec3& place) {
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    for (const Vec3& p : other.vertices) mesh.vertices.push_back(place + p);
    for (const auto& [a, b, c] : other.triangles) mesh.triangles.push_back({a + first, b + first, c + first});
  };
  append(sheet_at(Eigen::Isometry3d::Identity(), 0), {2, 0, 0.3});
  append(make_block({1, 1, 1e-3}, 1), {0, 2, 0.3});
  const double voxel = 0.04;
  const TriangleMesh solid = wrapped_solid(mesh, voxel);
  CHECK(signed_volume(solid) == Approx(block + voxel + (voxel + 1e-3)).epsilon(0.02));
  CHECK(find_shells(solid).size() == 3);
}

TEST_CASE("a surface with a hole is closed before it is wrapped, unless all open parts are to be sheets") {
  TriangleMesh ball = make_sphere(8);
  const double whole = signed_volume(ball);
  std::erase_if(ball.triangles, [&](const Triangle& t) { return ball.vertices[t[0]].z() > 0.8; });
  CHECK(signed_volume(wrapped_solid(ball, 0.05)) == Approx(whole).epsilon(0.06));
  CHECK(signed_volume(wrapped_solid(ball, 0.05, {}, OpenParts::sheets)) == Approx(0.05 * area(ball)).epsilon(0.06));
}

TEST_CASE("a grid is chosen by name, its surface by level") {
  const Scratch scratch;
  openvdb::initialize();
  scratch.write(
      {ball<openvdb::FloatGrid>("density", 1), ball<openvdb::DoubleGrid>("heat", 5), openvdb::BoolGrid::create()});
  CHECK_THROWS_WITH(read_volume(scratch.file), Catch::Contains("several grids, 'density', 'heat'"));
  CHECK_THROWS_WITH(read_volume(scratch.file, {.grid = "smoke"}),
                    Catch::Contains("'smoke'") && Catch::Contains("'density', 'heat'"));
  const double half = signed_volume(read_volume(scratch.file, {.grid = "density"}));
  CHECK(half == Approx(4.0 / 3 * 3.14159 * 125).epsilon(0.06));  // 0.5 is two voxels deep in a ball of radius 7
  CHECK(signed_volume(read_volume(scratch.file, {.grid = "heat", .iso = 2.5})) == Approx(half).epsilon(1e-6));
  CHECK(signed_volume(read_volume(scratch.file, {.grid = "density", .iso = 0.2})) > 1.3 * half);
  CHECK_THROWS_WITH(read_volume(scratch.file, {.grid = "density", .iso = 2}),
                    Catch::Contains("no surface at the level"));
  CHECK_THROWS_WITH(read_volume(scratch.file, {.grid = "density", .iso = -1}), Catch::Contains("choose another"));
  const auto fine = read_volume(scratch.file, {.grid = "density"}),
             rough = read_volume(scratch.file, {.grid = "density", .adaptivity = 1});
  CHECK(rough.triangles.size() < fine.triangles.size());
}

TEST_CASE("volumes with nothing to sample are refused") {
  const Scratch scratch;
  openvdb::initialize();
  scratch.write({openvdb::BoolGrid::create()});
  CHECK_THROWS_WITH(read_volume(scratch.file), Catch::Contains("no grid of numbers"));
  scratch.write({openvdb::FloatGrid::create(1)});
  CHECK_THROWS_WITH(read_volume(scratch.file), Catch::Contains("empty"));
  scratch.write({});
  CHECK_THROWS_AS(read_volume(scratch.file), InputError);
  scratch.write({ball<openvdb::FloatGrid>("a", 1), ball<openvdb::FloatGrid>("a", 1)});
  CHECK_THROWS_WITH(read_volume(scratch.file, {.grid = "a"}), Catch::Contains("told apart"));
  std::ofstream(scratch.file, std::ios::binary) << "no volume";
  CHECK_THROWS_WITH(read_volume(scratch.file), Catch::Contains("OpenVDB"));
}
