// PCL reads our point clouds as we wrote them: an independent reader of node files.
#include <pcl/io/pcd_io.h>

#include <catch2/catch.hpp>
#include <cstring>
#include <filesystem>
#include <random>

#include "kerf/files.h"

TEST_CASE("PCL reads the nodes that are written") {
  geo::NodeSet nodes;
  for (int i = 0; i < 5; ++i) {
    nodes.position.push_back({0.1 * i, 1.0 / (i + 1), -2.0 * i});
    nodes.radius.push_back(0.5 + i);
    nodes.spacing.push_back(0.25);
    nodes.volume.push_back(1e-3 * (i + 1));
  }
  const auto path =
      (std::filesystem::temp_directory_path() / ("kerf-pcl-" + std::to_string(std::random_device{}()) + ".pcd"))
          .string();
  geo::write_all(path, [&](std::ostream& out) { geo::write_pcd(out, nodes); });
  pcl::PCLPointCloud2 cloud;
  const int result = pcl::PCDReader().read(path, cloud);
  std::filesystem::remove(path);
  REQUIRE(result == 0);
  REQUIRE(cloud.width * cloud.height == nodes.size());
  REQUIRE(cloud.fields.size() == 6);
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    double row[6];
    for (std::size_t k = 0; k < 6; ++k)
      std::memcpy(&row[k], &cloud.data[i * cloud.point_step + cloud.fields[k].offset], 8);
    CHECK(row[0] == nodes.position[i].x());
    CHECK(row[2] == nodes.position[i].z());
    CHECK(row[3] == nodes.radius[i]);
    CHECK(row[5] == nodes.volume[i]);
  }
}
