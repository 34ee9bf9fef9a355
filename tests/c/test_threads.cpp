// Two threads with a solid each, two with one, and handles that are freed while a call uses them.
#include <atomic>
#include <catch2/catch.hpp>
#include <cstring>
#include <string>
#include <thread>
#include <vector>

#include "kerf.h"

namespace {

kerf_mesh block() {
  const double size[3] = {1, 1, 1};
  kerf_mesh mesh = nullptr;
  REQUIRE(kerf_shape_block(size, 0.2, &mesh) == KERF_OK);
  return mesh;
}

// The bytes of all parts of a break with enough time for all at once; "" where a call fails.
std::string broken(kerf_solid solid, double x) {
  const double point[3] = {x, 0.5, 1}, direction[3] = {0, 0, -1};
  kerf_breaking breaking = nullptr;
  std::int32_t finished = 0;
  if (kerf_break(solid, point, direction, 700, 1e9, nullptr, &breaking, &finished) != KERF_OK) return {};
  std::size_t count = 0;
  std::string all;
  kerf_breaking_count(breaking, &count);
  for (std::size_t i = 0; i < count; ++i) {
    kerf_mesh mesh = nullptr;
    kerf_bytes bytes = nullptr;
    const std::uint8_t* data = nullptr;
    std::size_t length = 0;
    if (kerf_breaking_mesh(breaking, i, &mesh) != KERF_OK || kerf_mesh_write(mesh, "ply", &bytes) != KERF_OK ||
        kerf_bytes_data(bytes, &data, &length) != KERF_OK)
      return {};
    all.append(reinterpret_cast<const char*>(data), length);
    kerf_free(bytes);
    kerf_free(mesh);
  }
  kerf_free(breaking);
  return all;
}

}  // namespace

TEST_CASE("two threads break a solid each, and both break one, as one thread does", "[c]") {
  kerf_mesh mesh = block();
  kerf_solid solids[2] = {};
  for (kerf_solid& solid : solids) REQUIRE(kerf_solid_create(mesh, &solid) == KERF_OK);
  const std::string left = broken(solids[0], 0.2), right = broken(solids[1], 0.8);
  REQUIRE(left.size() > 1000);
  REQUIRE(left != right);
  for (const int shared : {0, 1}) {
    std::string results[2];
    std::vector<std::thread> threads;
    for (int i = 0; i < 2; ++i)
      threads.emplace_back([&, i] {
        for (int run = 0; run < 5; ++run) results[i] = broken(solids[shared ? 0 : i], i == 0 ? 0.2 : 0.8);
      });
    for (std::thread& thread : threads) thread.join();
    CHECK(results[0] == left);
    CHECK(results[1] == right);
  }
  for (kerf_solid solid : solids) CHECK(kerf_free(solid) == KERF_OK);
  CHECK(kerf_free(mesh) == KERF_OK);
  CHECK(kerf_free(mesh) == KERF_HANDLE);
}

TEST_CASE("a complex that one thread cuts is busy for another, and may be freed", "[c]") {
  kerf_mesh mesh = block();
  kerf_complex complex = nullptr;
  REQUIRE(kerf_complex_create(mesh, &complex) == KERF_OK);
  std::atomic<int> good{0}, busy{0}, freed{0}, other{0};
  const auto count = [&](kerf_status status) {
    ++(status == KERF_OK ? good : status == KERF_BUSY ? busy : status == KERF_HANDLE ? freed : other);
  };
  std::vector<std::thread> threads;
  for (int i = 0; i < 3; ++i)
    threads.emplace_back([&, i] {
      for (int k = 0; k < 40; ++k) {
        const double point[3] = {0.01 + 0.008 * (3 * k + i), 0.5, 0.5}, normal[3] = {1, 0.1 * i, 0.01 * k};
        count(kerf_complex_cut_plane(complex, point, normal));
        if (i == 0 && k == 30) count(kerf_free(complex));
      }
    });
  for (std::thread& thread : threads) thread.join();
  CHECK(good + busy + freed + other == 121);
  CHECK(good > 1);
  CHECK(freed >= 9);  // of the thread that freed it
  CHECK(other == 0);
  CHECK(kerf_free(mesh) == KERF_OK);
}

TEST_CASE("messages belong to a thread, and name what is wrong", "[c]") {
  CHECK(kerf_mesh_measures(nullptr, nullptr) == KERF_ARGUMENT);
  CHECK(std::strstr(kerf_last_message(), "measures is null"));
  std::thread([] { CHECK(std::strlen(kerf_last_message()) == 0); }).join();
  kerf_measures measures;
  CHECK(kerf_mesh_measures(nullptr, &measures) == KERF_HANDLE);
  kerf_mesh mesh = block();
  CHECK(kerf_complex_undo(reinterpret_cast<kerf_complex>(mesh)) == KERF_HANDLE);
  CHECK(std::strstr(kerf_last_message(), "give a kerf_complex"));
  kerf_free(mesh);
  CHECK(kerf_status_name(KERF_BUSY) == std::string("KERF_BUSY"));
  CHECK(kerf_status_name(static_cast<kerf_status>(12)) == std::string());
  CHECK(kerf_abi() == KERF_ABI);
  CHECK(kerf_set_threads(-1) == KERF_ARGUMENT);
  CHECK(kerf_set_portable(2) == KERF_ARGUMENT);
  CHECK(kerf_set_portable(1) == KERF_OK);
  CHECK(kerf_set_portable(0) == KERF_OK);
}
