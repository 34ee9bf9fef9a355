// `.kerf` files truncated at every byte, with every bit flipped, with impossible tables, on a full
// disk.
#include <sys/resource.h>

#include <catch2/catch.hpp>
#include <csignal>
#include <filesystem>
#include <optional>

#include "cases.h"
#include "io/kerf_bytes.h"
#include "io/kerf_values.h"
#include "kerf/error.h"

using namespace geo;

namespace {

// The state that the bytes hold, or nothing where they are refused.
std::optional<KerfState> state_or_refusal(const std::string& bytes) {
  try {
    return state_of(bytes);
  } catch (const InputError& e) {
    REQUIRE(std::string(e.what()).rfind("f.kerf: ", 0) == 0);
    return std::nullopt;
  }
}

struct Appended {
  std::string before, after;
  KerfState old_state, new_state;
};
Appended appended(std::uint64_t seed) {
  Random random(seed);
  const Folder folder;
  Values v = random_values(random, 200);
  Appended a;
  const std::string path = folder.file("a.kerf", v.bytes());
  change(v, random, 2);
  update(path, v);
  a.before = read_all(path);
  a.old_state = state_of(a.before);
  change(v, random, 2);
  update(path, v);
  a.after = read_all(path);
  a.new_state = state_of(v.bytes());
  REQUIRE(a.after.compare(0, a.before.size(), a.before) == 0);
  REQUIRE(a.old_state != a.new_state);
  return a;
}

}  // namespace

TEST_CASE("an appended file cut off at any byte is in the state before, and can be updated again") {
  const Appended a = appended(21);
  for (std::size_t n = a.before.size(); n < a.after.size(); ++n) {
    CAPTURE(n);
    REQUIRE(state_of(a.after.substr(0, n)) == a.old_state);
    // Space that the system has allocated and not filled.
    if (n + 64 <= a.after.size() && n % 64 == 0)
      REQUIRE(state_of(a.after.substr(0, n) + std::string(a.after.size() - n, '\0')) == a.old_state);
  }
  CHECK(state_of(a.after) == a.new_state);
  for (std::size_t n = 64; n < a.before.size(); n += 97) {
    const auto state = state_or_refusal(a.after.substr(0, n));
    if (state) CHECK(n >= last_segment(a.before).start);  // of the first state of the three
  }
  const Folder folder;
  for (const std::size_t n : {a.before.size() + 1, a.before.size() + 100, a.after.size() - 1}) {
    Random random(n);
    Values v = random_values(random, 190);
    const std::string path = folder.file("cut.kerf", a.after.substr(0, n));
    update(path, v);
    CHECK(state_of(read_all(path)) == state_of(v.bytes()));
  }
}

TEST_CASE("no changed bit brings back another state") {
  const Appended a = appended(22);
  Random random(3);
  std::size_t refused = 0;
  const auto attempt = [&](const std::string& bytes) {
    const auto state = state_or_refusal(bytes);
    if (state) REQUIRE(*state == a.new_state);
    refused += !state;
  };
  for (std::size_t at = a.before.size(); at < a.after.size(); ++at) {
    std::string bytes = a.after;
    bytes[at] = static_cast<char>(bytes[at] ^ 1 << random.below(8));
    CAPTURE(at);
    attempt(bytes);
  }
  CHECK(refused > (a.after.size() - a.before.size()) / 2);
  for (int i = 0; i < cases(4000); ++i) {
    std::string bytes = a.after;
    for (auto flips = 1 + random.below(4); flips-- > 0;) {
      const std::size_t at = random.below(static_cast<std::uint32_t>(bytes.size()));
      bytes[at] = static_cast<char>(bytes[at] ^ 1 << random.below(8));
    }
    attempt(bytes);
  }
}

TEST_CASE("where the disk is full the file stays as it was") {
  Random random(41);
  const Folder folder;
  Values v = random_values(random, 300);
  const std::string path = folder.file("a.kerf", v.bytes()), before = read_all(path);
  change(v, random, 10);
  rlimit unlimited{};
  REQUIRE(::getrlimit(RLIMIT_FSIZE, &unlimited) == 0);
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  std::string said;
  for (const std::size_t room : {0, 1, 64, 700, 2000}) {
    const rlimit limit{before.size() + room, unlimited.rlim_max};
    ::setrlimit(RLIMIT_FSIZE, &limit);
    said = refusal([&] { update(path, v); });
    ::setrlimit(RLIMIT_FSIZE, &unlimited);
    CHECK_THAT(said, Catch::Contains("a.kerf: cannot be written (File too large)"));
    CHECK(read_all(path) == before);
  }
  std::signal(SIGXFSZ, handler);
  update(path, v);
  CHECK(state_of(read_all(path)) == state_of(v.bytes()));
}

TEST_CASE("a file that becomes shorter while it is read is refused") {
  Random random(51);
  const Folder folder;
  const Values v = random_values(random, 30000);
  const std::string path = folder.file("a.kerf", v.bytes());
  const KerfFile file{Input(path)};
  std::filesystem::resize_file(path, 5000);
  CHECK_THAT(refusal([&] { file.read<double>("position", 3); }), Catch::Contains("a.kerf: became shorter"));
}

TEST_CASE("impossible tables are refused") {
  Random random(61);
  const Values v = random_values(random, 100);
  const std::string good = v.bytes(), table = last_segment(good).table;
  const Appended a = appended(62);
  const std::string delta = last_segment(a.after).table;
  const auto with = [](const std::string& bytes, std::string text, const std::string& from, const std::string& to) {
    const auto at = text.find(from);
    REQUIRE(at != std::string::npos);
    return refusal([&] { state_of(with_table(bytes, text.replace(at, from.size(), to))); });
  };
  CHECK(with(good, table, "f8", "f8") == "read");
  CHECK(with(good, table, "\"name\":\"mark\",\"dtype\":\"u1\"", "\"name\":\"mark\",\"dtype\":\"c16\"") ==
        "read");  // unknown, perhaps of a later version
  CHECK_THAT(with(good, table, "\"shape\":[100,3]", "\"shape\":[18446744073709551615,3]"),
             Catch::Contains("larger than"));
  CHECK_THAT(with(good, table, "\"shape\":[100,3]", "\"shape\":[4294967296,4294967296]"),
             Catch::Contains("larger than"));
  CHECK_THAT(with(good, table, "\"shape\":[100,3]", "\"shape\":[-1,3]"), Catch::Contains("malformed"));
  CHECK_THAT(with(good, table, "\"shape\":[100,3]", "\"shape\":[99,3]"), Catch::Contains("another size"));
  CHECK_THAT(with(good, table, "\"offset\":64", "\"offset\":0"), Catch::Contains("outside"));
  CHECK_THAT(with(good, table, "\"offset\":64", "\"offset\":65"), Catch::Contains("not aligned"));
  CHECK_THAT(with(good, table, "\"offset\":64", "\"offset\":18446744073709551552"), Catch::Contains("outside"));
  CHECK_THAT(with(good, table, "\"offset\":64", "\"offset\":1e300"), Catch::Contains("malformed"));
  CHECK_THAT(with(good, table, "\"offset\":64", "\"offset\":128"), Catch::Contains("overlap"));
  CHECK_THAT(with(good, table, "\"length\":2400", "\"length\":18446744073709551615"), Catch::Contains("outside"));
  CHECK_THAT(with(good, table, "\"count\"", "\"position\""), Catch::Contains("there twice"));
  CHECK_THAT(with(good, table, "\"xxh3\":\"", "\"xxh3\":\"zz"), Catch::Contains("malformed hash"));
  CHECK_THAT(with(good, table, "\"xxh3\"", "\"runs\":1,\"xxh3\""), Catch::Contains("is not there"));
  CHECK_THAT(with(good, table, "[{", "[{\"a\":"), Catch::Contains("malformed"));
  CHECK(with(a.after, delta, "f8", "f8") == "read");
  CHECK_THAT(with(a.after, delta, "\"runs\":", "\"runs\":9"), Catch::Contains("section"));
  CHECK_THAT(with(a.after, delta, "\"runs\":", "\"runs\":18446744073709551616,\"x\":"), Catch::Contains("malformed"));
  CHECK_THAT(with(a.after, delta, "\"dtype\":\"f8\"", "\"dtype\":\"u8\""), Catch::Contains("another kind"));
  CHECK_THAT(with(a.after, delta, "\"name\":\"to\"", "\"name\":\"too\""), Catch::Contains("is not there"));
}

TEST_CASE("impossible runs are refused") {
  const Appended a = appended(63);
  const std::string table = last_segment(a.after).table;
  const auto offset = std::stoull(table.substr(table.find("\"offset\":") + 9));
  const auto with = [&](std::size_t run, const kerf::Run& r) {
    std::string bytes = a.after;
    std::memcpy(bytes.data() + offset + run * sizeof r, &r, sizeof r);
    return refusal([&] { state_of(bytes); });
  };
  kerf::Run first;
  std::memcpy(&first, a.after.data() + offset, sizeof first);
  CHECK(with(0, first) == "read");
  const std::uint64_t huge = ~std::uint64_t(0);
  for (const auto& run : std::vector<kerf::Run>{{0, 0},
                                                {0, huge},
                                                {1, huge},
                                                {huge - 1, 1},
                                                {huge, huge / 24},
                                                {huge, 1u << 30},
                                                {0, 1u << 30},
                                                {1u << 30, 1}})
    for (const std::size_t which : {0, 1}) CHECK_THAT(with(which, run), Catch::Contains("section 'position'"));
}
