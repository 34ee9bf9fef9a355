// Differences of bytes lead back to the bytes, and are short where little has changed.
#include <catch2/catch.hpp>

#include <string>
#include <vector>

#include "base/random.h"
#include "cases.h"
#include "live/history.h"

using namespace live;
using geo::Random;

namespace {

std::size_t below(Random& random, std::size_t n) { return static_cast<std::size_t>(random.uniform(0, double(n))); }

std::string random_bytes(Random& random, std::size_t size) {
  std::string bytes;
  const double kinds = random.uniform(0, 1) < 0.3 ? 2 : 256;  // few kinds have many equal blocks
  for (std::size_t i = 0; i < size; ++i) bytes += static_cast<char>(static_cast<int>(random.uniform(0, kinds)));
  return bytes;
}

// Parts moved, left out, changed and added, as arrays of a checkpoint are.
std::string changed(Random& random, std::string bytes) {
  for (std::size_t k = below(random, 6); k > 0 && !bytes.empty(); --k) {
    const std::size_t at = below(random, bytes.size()), size = below(random, 300);
    switch (below(random, 4)) {
      case 0:
        bytes.insert(at, random_bytes(random, size));
        break;
      case 1:
        bytes.erase(at, size);
        break;
      case 2:
        bytes += bytes.substr(at, size);
        break;
      default:
        bytes[at] = static_cast<char>(bytes[at] + 1);
        break;
    }
  }
  return bytes;
}

}  // namespace

TEST_CASE("a difference leads to the bytes that it was made for") {
  const Seeds run = seeds(300);
  for (std::uint64_t seed = run.first; seed < run.first + static_cast<std::uint64_t>(run.count); ++seed) {
    CAPTURE(seed);
    Random random(seed);
    const std::string from = random_bytes(random, below(random, 4000)), to = changed(random, from);
    REQUIRE(follow_difference(from, difference(from, to)) == to);
    const std::string other = random_bytes(random, below(random, 500));
    REQUIRE(follow_difference(from, difference(from, other)) == other);
  }
  CHECK(follow_difference("", difference("", "")).empty());
  Random random(1);
  const std::string bytes = random_bytes(random, 100000);
  CHECK(difference(bytes, bytes.substr(0, 40000) + "new" + bytes.substr(40100)).size() < 200);
}

TEST_CASE("a stack of states gives each of them back, whatever was erased") {
  const Seeds run = seeds(60);
  for (std::uint64_t seed = run.first; seed < run.first + static_cast<std::uint64_t>(run.count); ++seed) {
    CAPTURE(seed);
    Random random(seed);
    StateStack stack;
    std::vector<std::string> states;
    std::string now = random_bytes(random, 3000);
    for (int act = 0; act < 40; ++act) {
      const std::size_t kind = below(random, 4);
      if (kind < 2 || states.empty()) {
        now = changed(random, now);
        stack.push(now);
        states.push_back(now);
      } else if (kind == 2) {
        REQUIRE(stack.pop() == states.back());
        states.pop_back();
      } else {
        const std::size_t at = below(random, states.size());
        stack.erase(at);
        states.erase(states.begin() + static_cast<std::ptrdiff_t>(at));
      }
      REQUIRE(stack.size() == states.size());
    }
    for (; !states.empty(); states.pop_back()) REQUIRE(stack.pop() == states.back());
    CHECK(stack.bytes() == 0);
  }
}
