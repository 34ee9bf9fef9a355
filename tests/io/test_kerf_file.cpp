// The container of `.kerf` files: what is written is read, appended, cut off at every byte, damaged at every bit.
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <catch2/catch.hpp>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <functional>
#include <optional>
#include <random>
#include <thread>

#include "base/error.h"
#include "base/parallel.h"
#include "base/random.h"
#include "cases.h"
#include "io/kerf_append.h"
#include "io/kerf_bytes.h"
#include "io/kerf_delta_internal.h"
#include "io/stream.h"

using namespace geo;

namespace {

// Arrays as a body has them: some of fixed rows, some of rows of any length.
struct Values {
  std::vector<double> position;
  std::vector<std::uint32_t> count, to;
  std::vector<std::uint8_t> mark;
  std::vector<float> none;
  std::vector<KerfArray> arrays() const {
    return {kerf_array("position", std::span<const double>(position), 3), kerf_array("count", std::span<const std::uint32_t>(count)),
            kerf_array<std::uint32_t>("to", to.size(), 1, [this](KerfSink& sink) { for (const auto x : to) sink.put(x); }),
            kerf_array("mark", std::span<const std::uint8_t>(mark)), kerf_array("none", std::span<const float>(none))};
  }
  std::string bytes() const {
    std::ostringstream out;
    write_kerf(out, arrays());
    return out.str();
  }
};

Values random_values(Random& random, std::size_t rows) {
  Values v;
  for (std::size_t i = 0; i < rows; ++i) {
    for (int k = 0; k < 3; ++k) v.position.push_back(random.uniform());
    v.count.push_back(random.below(60));
    for (std::uint32_t k = 0; k < v.count.back(); ++k) v.to.push_back(random.below(static_cast<std::uint32_t>(rows)));
    v.mark.push_back(0);
  }
  return v;
}

// A few rows become longer, shorter or others; some are appended.
void change(Values& v, Random& random, int changes) {
  while (changes-- > 0) {
    const std::uint32_t row = random.below(static_cast<std::uint32_t>(v.count.size()));
    std::size_t at = 0;
    for (std::uint32_t i = 0; i < row; ++i) at += v.count[i];
    const std::uint32_t count = random.below(60);
    v.to.erase(v.to.begin() + static_cast<std::ptrdiff_t>(at), v.to.begin() + static_cast<std::ptrdiff_t>(at + v.count[row]));
    std::vector<std::uint32_t> other(v.count[row] = count);
    for (auto& x : other) x = random.below(1000000);
    v.to.insert(v.to.begin() + static_cast<std::ptrdiff_t>(at), other.begin(), other.end());
    v.position[3 * row + random.below(3)] = random.uniform();
    v.mark[row] = 1;
    if (random.below(3) == 0) v.position.insert(v.position.end(), {1, 2, 3}), v.count.push_back(1), v.to.push_back(row), v.mark.push_back(0);
  }
}

class Folder {
 public:
  Folder() : path_(std::filesystem::temp_directory_path() / ("kerf-file-" + std::to_string(std::random_device{}()))) { std::filesystem::create_directory(path_); }
  ~Folder() { std::filesystem::remove_all(path_); }
  std::string file(const std::string& name, const std::string& bytes = {}) const {
    const std::string path = (path_ / name).string();
    if (!bytes.empty()) write_all(path, [&](std::ostream& out) { out << bytes; });
    return path;
  }

 private:
  std::filesystem::path path_;
};

std::uint64_t update(const std::string& path, const Values& v) { return KerfUpdate(path).commit(v.arrays()); }

std::string refusal(const std::function<void()>& call) {
  try {
    call();
  } catch (const std::runtime_error& e) {
    return e.what();
  }
  return "read";
}

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
  a.before = read_all(path), a.old_state = state_of(a.before);
  change(v, random, 2);
  update(path, v);
  a.after = read_all(path), a.new_state = state_of(v.bytes());
  REQUIRE(a.after.compare(0, a.before.size(), a.before) == 0);
  REQUIRE(a.old_state != a.new_state);
  return a;
}

std::vector<std::byte> applied(const std::vector<kerf::Run>& runs, std::span<const std::byte> before, std::span<const std::byte> after, std::size_t width) {
  std::vector<std::byte> result;
  std::uint64_t used = 0;
  for (const auto& run : runs) {
    REQUIRE(run.count > 0);
    const bool given = run.from == kerf::literal;
    if (!given) {
      REQUIRE(run.from >= used);
      used = run.from + run.count;
    }
    const auto source = given ? after.subspan(result.size(), run.count * width) : before.subspan(run.from * width, run.count * width);
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
      const std::size_t at = width * random.below(static_cast<std::uint32_t>(after.size() / width + 1)), n = std::min(after.size() - at, width * random.below(30));
      std::vector<std::byte> more;
      for (auto k = random.below(30); k-- > 0;) row(more);
      if (random.below(3)) after.erase(after.begin() + static_cast<std::ptrdiff_t>(at), after.begin() + static_cast<std::ptrdiff_t>(at + n));
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
  KerfUpdate(path).commit(arrays);
  CHECK(KerfFile(Input(path)).updates() == 0);
  CHECK(KerfFile(Input(path)).sections().size() == 4);
  KerfUpdate(path).commit(v.arrays());  // a section more
  CHECK(KerfFile(Input(path)).updates() == 1);
  CHECK(state_of(read_all(path)) == state_of(v.bytes()));
  for (int i = 0; i < 3; ++i) update(path, v = random_values(random, 100));
  CHECK(state_of(read_all(path)) == state_of(v.bytes()));
  CHECK(std::filesystem::file_size(path) <= 2 * v.bytes().size());
}

TEST_CASE("an appended file cut off at any byte is in the state before, and can be updated again") {
  const Appended a = appended(21);
  for (std::size_t n = a.before.size(); n < a.after.size(); ++n) {
    CAPTURE(n);
    REQUIRE(state_of(a.after.substr(0, n)) == a.old_state);
    // Room that the system made, and did not fill.
    if (n + 64 <= a.after.size() && n % 64 == 0) REQUIRE(state_of(a.after.substr(0, n) + std::string(a.after.size() - n, '\0')) == a.old_state);
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

TEST_CASE("two updates of a file at a time, and files put in its place, are refused") {
  Random random(31);
  const Folder folder;
  Values v = random_values(random, 300);
  const std::string path = folder.file("a.kerf", v.bytes());
  {
    KerfUpdate first(path);
    CHECK_THROWS_WITH(KerfUpdate(path), Catch::Contains("a.kerf: is being updated by another program"));
    CHECK(state_of(KerfFile(Input(path))) == state_of(v.bytes()));  // readers are not kept out
    change(v, random, 3);
    folder.file("a.kerf", v.bytes());
    CHECK_THROWS_WITH(first.commit(v.arrays()), Catch::Contains("was replaced by another program"));
  }
  change(v, random, 3);
  update(path, v);
  CHECK(state_of(KerfFile(Input(path))) == state_of(v.bytes()));
  CHECK_THROWS_AS(KerfUpdate(folder.file("none.kerf")), MissingInputError);
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
  CHECK(with(good, table, "\"name\":\"mark\",\"dtype\":\"u1\"", "\"name\":\"mark\",\"dtype\":\"c16\"") == "read");  // unknown, perhaps of a later version
  CHECK_THAT(with(good, table, "\"shape\":[100,3]", "\"shape\":[18446744073709551615,3]"), Catch::Contains("larger than"));
  CHECK_THAT(with(good, table, "\"shape\":[100,3]", "\"shape\":[4294967296,4294967296]"), Catch::Contains("larger than"));
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
  for (const auto& run : std::vector<kerf::Run>{{0, 0}, {0, huge}, {1, huge}, {huge - 1, 1}, {huge, huge / 24}, {huge, 1u << 30}, {0, 1u << 30}, {1u << 30, 1}})
    for (const std::size_t which : {0, 1}) CHECK_THAT(with(which, run), Catch::Contains("section 'position'"));
}
