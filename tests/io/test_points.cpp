// Scans in every format: PCD as PCL writes it, PLY, and text.
#include <pcl/io/pcd_io.h>
#include <pcl/point_types.h>
#include <unistd.h>

#include <catch2/catch.hpp>
#include <filesystem>

#include "io/fuzz.h"
#include "kerf/error.h"
#include "kerf/files.h"
#include "samples.h"

using namespace geo;

namespace {

std::string refusal(const std::string& bytes, const std::string& name) {
  try {
    parse_points(bytes, name);
  } catch (const InputError& error) {
    return error.what();
  }
  return {};
}

// The bytes of a PCD that PCL's own writer makes.
std::string pcd_of(const pcl::PointCloud<pcl::PointXYZRGBNormal>& cloud, int how) {
  const std::string path =
      (std::filesystem::temp_directory_path() / ("kerf-points-" + std::to_string(::getpid()) + ".pcd")).string();
  pcl::PCDWriter writer;
  if (how == 0) writer.writeASCII(path, cloud, 9);
  if (how == 1) writer.writeBinary(path, cloud);
  if (how == 2) writer.writeBinaryCompressed(path, cloud);
  std::string bytes = read_all(path);
  std::filesystem::remove(path);
  return bytes;
}

pcl::PointCloud<pcl::PointXYZRGBNormal> some_points() {
  pcl::PointCloud<pcl::PointXYZRGBNormal> cloud;
  for (int i = 0; i < 400; ++i) {
    pcl::PointXYZRGBNormal p;
    p.x = float(i % 7);
    p.y = float(i) / 8;
    p.z = -1;
    p.normal_x = 0;
    p.normal_y = i % 2 == 0 ? 1.0F : -1.0F;
    p.normal_z = 0;
    p.r = std::uint8_t(i % 256);
    p.g = 0;
    p.b = 255;
    cloud.push_back(p);
  }
  return cloud;
}

}  // namespace

TEST_CASE("points of a PCD are those that PCL wrote: text, binary, compressed", "[points]") {
  const auto cloud = some_points();
  for (const int how : {0, 1, 2}) {
    CAPTURE(how);
    const std::string bytes = pcd_of(cloud, how);
    CHECK(holds_points(bytes, "-"));
    const PointCloud read = parse_points(bytes, "a.pcd");
    REQUIRE(read.position.size() == cloud.size());
    REQUIRE(read.normal.size() == cloud.size());
    REQUIRE(read.color.size() == cloud.size());
    for (std::size_t i = 0; i < cloud.size(); ++i) {
      CHECK(read.position[i] == Vec3(cloud[i].x, cloud[i].y, cloud[i].z));
      CHECK(read.normal[i] == Vec3(0, cloud[i].normal_y, 0));
      CHECK(read.color[i] == Color(cloud[i].r / 255.0, 0, 1, 1));
    }
    if (how > 0) CHECK_THAT(refusal(bytes.substr(0, bytes.size() - 100), "a.pcd"), Catch::Contains("a.pcd: "));
  }
}

TEST_CASE("lines of text are places, normals and colours", "[points]") {
  const PointCloud bare = parse_points("3\n0 0 0\n1,2,3\n# comment\n4;5;6\n", "a.xyz");
  REQUIRE(bare.position.size() == 3);
  CHECK(bare.position[1] == Vec3(1, 2, 3));
  CHECK(bare.normal.empty());
  const PointCloud normals = parse_points("0 0 0 0 0 0.5\n1 0 0 0 1 0\n1 1 1 0 0 0\nnan 0 0 1 0 0\n", "a.xyz");
  REQUIRE(normals.position.size() == 2);
  CHECK(normals.left_out == 2);
  CHECK(normals.normal[0] == Vec3(0, 0, 1));
  CHECK(normals.color.empty());
  const PointCloud colors = parse_points("0 0 0 255 0 51\n1 0 0 0 0 0\n", "a.xyz");
  CHECK(colors.normal.empty());
  CHECK(colors.color.at(0) == Color(1, 0, 0.2, 1));
  const PointCloud both = parse_points("0 0 0 255 0 51 0 1 0\n", "a.xyz");
  CHECK(both.color.at(0) == Color(1, 0, 0.2, 1));
  CHECK(both.normal.at(0) == Vec3(0, 1, 0));
  CHECK(parse_points("0 0 0 17 255 0 51\n", "a.pts").color.at(0) == Color(1, 0, 0.2, 1));
  CHECK(parse_points("0 0 0 0 0 0\n1 0 0 0 0 0\n", "a.xyz").position.size() == 2);  // normals of zeros are none
  CHECK_THAT(refusal("0 0 0\n1 2\n", "a.xyz"), Catch::Contains("a.xyz:2: a point has 2 numbers, not 3"));
  CHECK_THAT(refusal("0 0 zero\n", "a.xyz"), Catch::Contains("a.xyz:1: 'zero' is not a number"));
  CHECK_THAT(refusal("a b\n", "a.xyz"), Catch::Contains("has no points"));
}

TEST_CASE("a PLY without faces is a scan, a surface and nodes are none", "[points]") {
  const std::string head =
      "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty float z\n";
  const std::string bytes =
      head + "property uchar red\nproperty uchar green\nproperty uchar blue\nend_header\n0 0 0 255 0 51\n1 2 3 0 0 0\n";
  CHECK(holds_points(bytes, "-"));
  CHECK(parse_points(bytes, "a.ply").color.at(0) == Color(1, 0, 0.2, 1));
  CHECK_FALSE(holds_points(bytes_of([](auto& out) { write_ply(out, make_sphere(2)); }), "-"));
  NodeSet nodes;
  nodes.position = {Vec3(0, 0, 0)};
  nodes.radius = nodes.spacing = nodes.volume = {1};
  CHECK_THAT(refusal(bytes_of([&](auto& out) { write_pcd(out, nodes); }), "n.pcd"),
             Catch::Contains("is a file of nodes"));
  CHECK_THAT(refusal("ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nend_header\n0\n", "a.ply"),
             Catch::Contains("has no fields x, y and z"));
}

TEST_CASE("any damage to a scan gives an error or a cloud", "[points]") {
  const auto cloud = some_points();
  for (const int how : {0, 1, 2}) {
    const std::string bytes = pcd_of(cloud, how);
    std::size_t refused = 0;
    for (std::size_t i = 0; i < bytes.size(); i += 1 + bytes.size() / 400) {
      std::string damaged = bytes;
      damaged[i] = char(damaged[i] ^ (1 << (i % 8)));
      refused += !refusal(damaged, "a.pcd").empty();
      refused += !refusal(bytes.substr(0, i), "a.pcd").empty();
    }
    CHECK(refused > 100);
  }
}

TEST_CASE("damaged scans are read or refused", "[points][fuzz]") {
  const auto cloud = some_points();
  std::vector<std::string> files = sample_nodes_files(cut_body().nodes);  // PCD and PLY
  for (const int how : {0, 1, 2}) files.push_back(pcd_of(cloud, how));
  std::string numbers = "400\n", colors, all;
  for (const auto& p : cloud) {
    const std::string place = std::to_string(p.x) + ' ' + std::to_string(p.y) + ' ' + std::to_string(p.z);
    const std::string color = std::to_string(p.r) + ' ' + std::to_string(p.g) + ' ' + std::to_string(p.b);
    numbers += place + '\n';
    colors += place + ' ' + color + '\n';
    all += place + " 0 1 0 " + color + '\n';
  }
  std::replace(colors.begin(), colors.end(), ' ', ',');
  files.insert(files.end(), {numbers, colors, all});
  fuzz::campaign(
      "scan", 3000,
      [](const auto& bytes, const auto& name) -> fuzz::Use {
        return [scan = parse_points(bytes, name)] {
          for (const Vec3& p : scan.position)
            if (!p.allFinite()) throw std::logic_error("a position that is not finite");
          for (const std::size_t size : {scan.normal.size(), scan.color.size()})
            if (size != 0 && size != scan.position.size())
              throw std::logic_error("fewer normals or colours than points");
        };
      },
      [files](Random& random) {
        const std::string& file = files[random.below(static_cast<std::uint32_t>(files.size()))];
        return Mutator(random).damaged(file, files);
      });
}
