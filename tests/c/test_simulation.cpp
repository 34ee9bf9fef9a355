// Blows in a running simulation.
#include <catch2/catch.hpp>
#include <cmath>
#include <cstring>
#include <limits>
#include <string>
#include <vector>

#include "base/random.h"
#include "cases.h"
#include "kerf.h"

namespace {

const std::string scene =
    "[[body]]\nmesh = \"given\"\nnodes = 60\n[material]\nyoung = 1e5\n[ground]\npoint = [0, 0, 0]\n"
    "[contact]\nself = true\n[time]\nframe_rate = 24\nstep = 0.03\n";

kerf_simulation begin(const std::string& text) {
  const double size[3] = {1, 1, 1};
  kerf_mesh block = nullptr;
  kerf_simulation run = nullptr;
  REQUIRE(kerf_shape_block(size, 0.25, &block) == KERF_OK);
  const kerf_status status =
      kerf_simulation_create(text.data(), text.size(), nullptr, &block, 1, nullptr, nullptr, &run);
  CAPTURE(kerf_last_message());
  REQUIRE(status == KERF_OK);
  kerf_free(block);
  return run;
}

std::vector<double> positions(kerf_simulation run) {
  std::size_t needed = 0;
  REQUIRE(kerf_simulation_positions(run, nullptr, 0, &needed) == KERF_OK);
  std::vector<double> values(needed);
  REQUIRE(kerf_simulation_positions(run, values.data(), needed, nullptr) == KERF_OK);
  return values;
}

std::size_t vertices(kerf_simulation run) {
  kerf_mesh surface = nullptr;
  kerf_mesh_arrays arrays{};
  REQUIRE(kerf_simulation_surface(run, &surface) == KERF_OK);
  REQUIRE(kerf_mesh_get(surface, &arrays) == KERF_OK);
  const std::size_t count = arrays.vertices_length / 3;
  kerf_free(surface);
  return count;
}

}  // namespace

TEST_CASE("a blow gives the frames of a scene that has it", "[c][simulation]") {
  const auto [first, count] = seeds(2);
  for (int i = 0; i < count; ++i) {
    const std::uint64_t seed = first + static_cast<std::uint64_t>(i);
    CAPTURE(seed);
    geo::Random random(seed);
    const double point[3] = {random.uniform(0, 1), random.uniform(0, 1), 1};
    std::string text = scene + "[[blow]]\ntime = 0\ncells = 5\npoint = [";
    for (int k = 0; k < 3; ++k) {
      char digits[40];
      std::snprintf(digits, sizeof digits, "%s%.17g", k ? ", " : "", point[k]);
      text += digits;
    }
    const kerf_simulation struck = begin(scene), given = begin(text + "]\n");
    const std::size_t before = vertices(struck);
    REQUIRE(kerf_simulation_strike(struck, point, 5) == KERF_OK);
    CHECK(vertices(struck) > before);
    for (int frame = 0; frame < 3; ++frame) {
      kerf_frame one{}, other{};
      REQUIRE(kerf_simulation_step(struck, nullptr, nullptr, &one) == KERF_OK);
      REQUIRE(kerf_simulation_step(given, nullptr, nullptr, &other) == KERF_OK);
      CHECK(one.elastic == other.elastic);
      CHECK(one.kinetic == other.kinetic);
    }
    CHECK(positions(struck) == positions(given));
    kerf_free(struck);
    kerf_free(given);
  }
}

TEST_CASE("a blow that cannot be leaves a run as it was", "[c][simulation]") {
  const kerf_simulation run = begin(scene);
  const auto before = positions(run);
  const double top[3] = {0.5, 0.5, 1}, none[3] = {0.5, std::numeric_limits<double>::quiet_NaN(), 1};
  CHECK(kerf_simulation_strike(run, top, 1) == KERF_ARGUMENT);
  CHECK(std::strstr(kerf_last_message(), "from 2 to 1000"));
  CHECK(kerf_simulation_strike(run, top, 1001) == KERF_ARGUMENT);
  CHECK(kerf_simulation_strike(run, none, 5) == KERF_ARGUMENT);
  CHECK(kerf_simulation_strike(run, nullptr, 5) == KERF_ARGUMENT);
  CHECK(kerf_simulation_strike(nullptr, top, 5) == KERF_HANDLE);

  // While a blade is in the body.
  const double edge[6] = {0.5, -1, 0, 0.5, 2, 0};
  kerf_pose pose = {{0, 0, 1.1}, {1, 0, 0, 0}};
  kerf_blade_options knife;
  std::uint32_t blade = 0;
  kerf_blade_defaults(&knife);
  knife.points = edge;
  knife.points_length = 6;
  REQUIRE(kerf_simulation_add_blade(run, &knife, &pose, &blade) == KERF_OK);
  pose.position[2] = 0.5;
  REQUIRE(kerf_simulation_move_blade(run, blade, &pose) == KERF_OK);
  REQUIRE(kerf_simulation_step(run, nullptr, nullptr, nullptr) == KERF_OK);
  const auto cut = positions(run);
  CHECK(kerf_simulation_strike(run, top, 5) == KERF_INPUT);
  CHECK(std::strstr(kerf_last_message(), "a blade is in the body"));
  CHECK(positions(run) == cut);
  CHECK(kerf_simulation_step(run, nullptr, nullptr, nullptr) == KERF_OK);
  CHECK(before.size() <= cut.size());
  kerf_free(run);
}
