// The effort of frames: within its bounds, less where frames take too long, the scene's own again
// where they do not.
#include <catch2/catch.hpp>

#include "base/random.h"
#include "cases.h"
#include "live/pace.h"

using live::Effort;
using live::Pacer;

namespace {

constexpr double period = 1.0 / 60;

// Frames that take `load` of their time at the effort `full`, and less with fewer steps.
class Frames {
 public:
  explicit Frames(Pacer& pacer) : pacer_(pacer) {}
  // Computes one frame, and decides on the effort of the next.
  Effort one(double load, const Effort& full, const Effort& now) {
    const double time = load * period * now.steps / full.steps;
    const auto begin = now_;
    now_ += std::chrono::duration_cast<Pacer::Clock::duration>(std::chrono::duration<double>(time));
    pacer_.add(begin, now_);
    return pacer_.effort();
  }

 private:
  Pacer& pacer_;
  Pacer::Clock::time_point now_ = Pacer::Clock::now();
};

}  // namespace

TEST_CASE("frames that take too long relax accuracy up to its bound, then have fewer steps, and both come back") {
  const Effort own{0.01, 4};
  Pacer pacer(period, own, {0.04, 1});
  Frames frames(pacer);
  Effort now = own;
  for (int i = 0; i < 29; ++i) now = frames.one(3, own, now);
  CHECK(now == own);  // patience
  bool relaxed_first = true;
  for (int i = 0; i < 600; ++i) {
    now = frames.one(3, own, now);
    relaxed_first = relaxed_first && (now.steps == own.steps || now.accuracy == 0.04);
  }
  CHECK(relaxed_first);
  CHECK(now == Effort{0.04, 1});
  for (int i = 0; i < 600; ++i) now = frames.one(0.4, own, now);
  CHECK(now == own);
}

TEST_CASE("a load that the scene's effort bears changes nothing, and no load goes below the least effort") {
  const Effort own{0.01, 3};
  Pacer bears(period, own, {0.04, 1}), is_fixed(period, own, own);
  Frames light(bears), heavy(is_fixed);
  for (int i = 0; i < 300; ++i) {
    CHECK(light.one(0.85, own, own) == own);
    CHECK(heavy.one(5, own, own) == own);
  }
}

TEST_CASE("effort stays within its bounds whatever frames cost, and settles where cost is constant") {
  const Seeds run = seeds(200);
  for (std::uint64_t seed = run.first; seed < run.first + static_cast<std::uint64_t>(run.count); ++seed) {
    CAPTURE(seed);
    geo::Random random(seed);
    const Effort own{random.uniform(1e-4, 0.1), 1 + int(random.uniform(0, 12))};
    const Effort least{own.accuracy * random.uniform(1, 5), 1 + int(random.uniform(0, own.steps))};
    Pacer pacer(period, own, least);
    Frames frames(pacer);
    Effort now = own;
    const auto require_bounds = [&] {
      REQUIRE(now.accuracy >= own.accuracy);
      REQUIRE(now.accuracy <= least.accuracy);
      REQUIRE((now.steps >= least.steps && now.steps <= own.steps));
    };
    for (int i = 0; i < 400; ++i) {
      now = frames.one(random.uniform(0.1, 4), own, now);
      require_bounds();
    }
    const double load = random.uniform(0.1, 4);
    for (int i = 0; i < 2000; ++i) {
      now = frames.one(load, own, now);
      require_bounds();
    }
    const Effort settled = now;
    for (int i = 0; i < 300; ++i) now = frames.one(load, own, now);
    CHECK(now == settled);
  }
}
