// The container of `.kerf` files: writing, reading, appending and compacting.
#include <sys/stat.h>

#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>
#include <thread>

#include "cases.h"
#include "io/kerf_bytes.h"
#include "io/kerf_delta.h"
#include "io/kerf_update.h"
#include "io/kerf_values.h"
#include "kerf/error.h"
#include "kerf/parallel.h"

using namespace geo;

namespace {

std::vector<std::byte> applied(const std::vector<kerf::Run>& runs, std::span<const std::byte> before,
                               std::span<const std::byte> after, std::size_t width) {
  std::vector<std::byte> result;
  std::uint64_t used = 0;
  for (const auto& run : runs) {
    REQUIRE(run.count > 0);
    const bool given = run.from == kerf::literal;
    if (!given) {
      REQUIRE(run.from >= used);
      used = run.from + run.count;
    }
    const auto source =
        given ? after.subspan(result.size(), run.count * width) : before.subspan(run.from * width, run.count * width);
    result.insert(result.end(), source.begin(), source.end());
  }
  return result;
}

}  // namespace

TEST_CASE("what changed in an array is found, in place or moved") {
  const Seeds which = seeds(300);
  for (int c = 0; c < which.count; ++c) {
    const std::uint64_t seed = which.first + static_cast<std::uint64_t>(c);
    CAPTURE(seed);
    Random random(seed);
    const std::size_t width = std::size_t(1) << random.below(5), rows = random.below(random.below(2) ? 40 : 20000);
    const std::uint32_t kinds = 1 + random.below(2) * random.below(1000000);  // of values: some arrays are all alike
    const auto row = [&](std::vector<std::byte>& out) {
      const std::uint64_t x = random.below(kinds);
      for (std::size_t k = 0; k < width; ++k) out.push_back(std::byte(x * 0x9e3779b97f4a7c15ull >> (8 * (k % 8))));
    };
    std::vector<std::byte> before, after;
    for (std::size_t i = 0; i < rows; ++i) row(before);
    after = before;
    const int edits = static_cast<int>(random.below(6));
    for (int e = 0; e < edits; ++e) {
      const std::size_t at = width * random.below(static_cast<std::uint32_t>(after.size() / width + 1)),
                        n = std::min(after.size() - at, width * random.below(30));
      std::vector<std::byte> more;
      for (auto k = random.below(30); k-- > 0;) row(more);
      if (random.below(3))
        after.erase(after.begin() + static_cast<std::ptrdiff_t>(at),
                    after.begin() + static_cast<std::ptrdiff_t>(at + n));
      if (random.below(3)) after.insert(after.begin() + static_cast<std::ptrdiff_t>(at), more.begin(), more.end());
    }
    const auto runs = kerf::difference(before, after, width);
    REQUIRE(applied(runs, before, after, width) == after);
    std::uint64_t given = 0;
    for (const auto& run : runs) given += run.from == kerf::literal ? run.count * width : 0;
    if (kinds > 1000 && width >= 4) CHECK(given <= static_cast<std::uint64_t>(edits) * (30 * width + 600));
    if (edits == 0) CHECK(given == 0);
  }
}

TEST_CASE("arrays of every type come back from memory, a file and a pipe") {
  Random random(5);
  Values v = random_values(random, 30000);
  const std::vector<std::uint64_t> big{~std::uint64_t(0), 1};
  const std::vector<std::uint16_t> small{1, 65535, 3};
  const std::vector<std::int32_t> negative{-1, 7};
  auto arrays = v.arrays();
  arrays.push_back(kerf_array("big", std::span<const std::uint64_t>(big)));
  arrays.push_back(kerf_array("small", std::span<const std::uint16_t>(small), 3));
  arrays.push_back(kerf_array("negative", std::span<const std::int32_t>(negative)));
  std::ostringstream out;
  write_kerf(out, arrays);
  const std::string bytes = out.str();
  const Folder folder;
  const std::string path = folder.file("a.kerf", bytes), pipe = folder.file("pipe");
  REQUIRE(::mkfifo(pipe.c_str(), 0600) == 0);
  std::thread writer([&] { std::ofstream(pipe, std::ios::binary) << bytes; });
  const KerfFile streamed{Input(pipe)};
  writer.join();
  const KerfFile file{Input(path)};
  CHECK(state_of(streamed) == state_of(bytes));
  CHECK(state_of(file) == state_of(bytes));
  for (const int count : {1, 2, 4}) {
    set_threads(count);
    CHECK(file.read<double>("position", 3) == v.position);
    CHECK(file.read<std::uint32_t>("to") == v.to);
  }
  set_threads(0);
  CHECK(file.read<std::uint64_t>("big") == big);
  CHECK(file.read<std::uint16_t>("small", 3) == small);
  CHECK(file.read<float>("none").empty());
  CHECK_THAT(refusal([&] { file.read<float>("to"); }), Catch::Contains("type and shape"));
  CHECK_THAT(refusal([&] { file.read<double>("position"); }), Catch::Contains("type and shape"));
  CHECK_THAT(refusal([&] { file.read<double>("nothing"); }), Catch::Contains("has no section 'nothing'"));
}

TEST_CASE("states that follow each other are appended and folded") {
  const Seeds which = seeds(20);
  for (int c = 0; c < which.count; ++c) {
    const std::uint64_t seed = which.first + static_cast<std::uint64_t>(c);
    CAPTURE(seed);
    Random random(seed);
    const Folder folder;
    Values v = random_values(random, 1 + random.below(3000));
    const std::string path = folder.file("a.kerf", v.bytes());
    for (int step = 0; step < 6; ++step) {
      if (step != 3) change(v, random, 1 + static_cast<int>(random.below(20)));
      const auto size = std::filesystem::file_size(path);
      const auto written = update(path, v);
      const KerfFile file{Input(path)};
      REQUIRE(state_of(file) == state_of(v.bytes()));
      REQUIRE(file.committed() == std::filesystem::file_size(path));
      CHECK(file.committed() == (file.updates() > 0 ? size + written : written));
      CHECK(file.committed() <= 2 * v.bytes().size());
    }
    std::ostringstream folded;
    const KerfFile file{Input(path)};
    write_compacted(folded, file);
    CHECK(state_of(folded.str()) == state_of(v.bytes()));
    CHECK(folded.str().size() == v.bytes().size());
  }
}

TEST_CASE("what is appended follows what changed") {
  Random random(11);
  const Folder folder;
  Values v = random_values(random, 50000);
  const std::string path = folder.file("a.kerf", v.bytes());
  change(v, random, 20);
  const auto written = update(path, v);
  CHECK(KerfFile(Input(path)).updates() == 1);
  CHECK(written < v.bytes().size() / 100);
  CHECK(written < 20 * 4000);
}

TEST_CASE("a file that loses a section, or grows too long, is written whole") {
  Random random(12);
  const Folder folder;
  Values v = random_values(random, 100);
  const std::string path = folder.file("a.kerf", v.bytes());
  auto arrays = v.arrays();
  arrays.pop_back();
  UpdatedFile(path).commit(arrays);
  CHECK(KerfFile(Input(path)).updates() == 0);
  CHECK(KerfFile(Input(path)).sections().size() == 4);
  UpdatedFile(path).commit(v.arrays());  // a section more
  CHECK(KerfFile(Input(path)).updates() == 1);
  CHECK(state_of(read_all(path)) == state_of(v.bytes()));
  for (int i = 0; i < 3; ++i) update(path, v = random_values(random, 100));
  CHECK(state_of(read_all(path)) == state_of(v.bytes()));
  CHECK(std::filesystem::file_size(path) <= 2 * v.bytes().size());
}

TEST_CASE("two updates of a file at a time, and files put in its place, are refused") {
  Random random(31);
  const Folder folder;
  Values v = random_values(random, 300);
  const std::string path = folder.file("a.kerf", v.bytes());
  {
    KerfUpdate first(path);
    CHECK_THROWS_WITH(KerfUpdate(path), Catch::Contains("a.kerf: is being updated by another program"));
    CHECK(state_of(KerfFile(Input(path))) == state_of(v.bytes()));  // readers are not locked out
    change(v, random, 3);
    folder.file("a.kerf", v.bytes());
    CHECK_THROWS_WITH(UpdatedFile::of(first).commit(v.arrays()), Catch::Contains("was replaced by another program"));
  }
  change(v, random, 3);
  update(path, v);
  CHECK(state_of(KerfFile(Input(path))) == state_of(v.bytes()));
  CHECK_THROWS_AS(KerfUpdate(folder.file("none.kerf")), MissingInputError);
}
