// Bodies cut at random: after every step graph, rows and binding are those of scratch, components
// are pieces, nodes are inside, whatever the number of threads and the vectors.
//
// A campaign: KERF_CASES=25 KERF_SEED=7 test_invariants '[bodies]'; one case of it:
// KERF_CASE=7000123 and the name of the test; KERF_TELL=1 tells of every step.
#include <catch2/catch.hpp>
#include <cstring>
#include <filesystem>
#include <map>

#include "cases.h"
#include "invariants/body_case.h"
#include "invariants/body_faults.h"
#include "invariants/random_sweeps.h"
#include "kerf/error.h"
#include "kerf/files.h"
#include "kerf/parallel.h"
#include "simd_targets.h"

using namespace geo;

namespace {

struct Outcome {
  std::string fault;                ///< empty: every invariant held after every step
  std::size_t crack = 0, step = 0;  ///< where it did not
  std::size_t steps = 0, cutting = 0, refused = 0, parted = 0, resized = 0;
  Body body;
};

// `check` every step, or none.
Outcome cut(const BodyCase& c, bool check) {
  Outcome result;
  const Body& model = body_cases::body_of(c);
  result.body = model;
  const double volume = body_faults::total(model.nodes.volume);
  for (result.crack = 0; result.crack < c.cracks.size(); ++result.crack) {
    const GridCrack& crack = c.cracks[result.crack];
    FrontState front = begin_front(crack.rows[0], crack.closed, static_cast<std::int32_t>(result.crack + 1));
    for (result.step = 1; result.step < crack.rows.size(); ++result.step) {
      const Body before = check ? result.body : Body();
      ++result.steps;
      SplitStats work;
      try {
        const BodyDelta delta = split(result.body, front, crack.rows[result.step], {}, &work);
        result.parted += delta.detached.size();
        if (check && std::getenv("KERF_TELL"))
          WARN("crack " << result.crack + 1 << " step " << result.step << ": " << delta.crack.new_crack_faces.size()
                        << " crack faces, " << result.body.nodes.size() << " nodes, " << delta.detached.size()
                        << " pieces more, " << work.resample_seconds << " + " << work.graph_seconds << " + "
                        << work.binding_seconds << " s");
        if (delta.crack.empty()) continue;
        ++result.cutting;
        if (check) result.fault = body_faults::fault_of(before, result.body, delta, work.repair_nodes, volume);
        if (c.resize && result.fault.empty()) {
          const Body uncut = check ? result.body : Body();
          const BodyDelta other = resize_nodes(
              result.body,
              body_cases::other_radii(result.body, static_cast<std::uint64_t>(c.resize) * 1000 + result.steps));
          result.resized += other.resized_nodes.size();
          if (check) result.fault = body_faults::fault_of(uncut, result.body, other, 0, volume);
          if (!result.fault.empty()) result.fault = "other radii: " + result.fault;
        }
      } catch (const GeometryError&) {
        ++result.refused;
        if (!check ||
            (result.body.nodes.position == before.nodes.position && result.body.graph == before.graph &&
             result.body.binding == before.binding && result.body.surface.face_count() == before.surface.face_count()))
          break;
        result.fault = "a refused step changed the body";
      }
      if (!result.fault.empty()) return result;
    }
  }
  return result;
}

// Vectors as doubles may differ in more than value.
bool same(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(Vec3)) == 0);
}

bool same(const Body& a, const Body& b) {
  return same(a.nodes.position, b.nodes.position) && a.nodes.volume == b.nodes.volume &&
         a.nodes.radius == b.nodes.radius && a.graph == b.graph && a.binding == b.binding && a.debris == b.debris;
}

class Campaign {
 public:
  ~Campaign() {
    if (std::getenv("KERF_CASES"))
      WARN(cases_ << " sequences, " << steps_ << " steps, " << cutting_ << " of them cut something, " << refused_
                  << " refused, " << parted_ << " pieces came off, " << resized_ << " other radii, " << guided_
                  << " sequences with guides, " << varied_ << " runs with other threads and vectors");
  }

  /// Cuts with two threads, and with one and four and other vectors again.
  void run(const BodyCase& c, std::uint64_t seed) {
    set_threads(2);
    INFO("KERF_CASE=" << seed << ", " << c.recipe());
    if (made_.insert(c.recipe()).second) require_good_model(c);
    const Outcome two = cut(c, true);
    ++cases_;
    steps_ += two.steps;
    cutting_ += two.cutting;
    refused_ += two.refused;
    parted_ += two.parted;
    guided_ += c.guides > 0;
    resized_ += two.resized;
    if (!two.fault.empty()) keep(c, seed, two);
    if (two.fault.empty()) vary([&] { CHECK(same(two.body, cut(c, false).body)); });
    set_threads(0);
  }

 private:
  // Nothing is wrong with it yet, and it is the same however it is built.
  void require_good_model(const BodyCase& c) {
    const Body& model = body_cases::body_of(c);
    REQUIRE(body_faults::fault_of(model, body_faults::total(model.nodes.volume)) == "");
    vary([&] { CHECK(same(model, body_cases::make_body(c))); });
    set_threads(2);
  }

  // With one and with four threads, and of the kinds of vectors there are two in turn.
  void vary(const std::function<void()>& check) {
    static const auto targets = hwy::SupportedAndGeneratedTargets();
    for (const int threads : {1, 4}) {
      set_threads(threads);
      use_simd_target(targets[varied_++ % targets.size()]);
      check();
      use_simd_target(0);
    }
  }

  // Shrinks what fails, where it is not known yet, into a file.
  void keep(const BodyCase& c, std::uint64_t seed, const Outcome& outcome) {
    const std::string kind = kind_of(outcome.fault),
                      where = "crack " + std::to_string(outcome.crack + 1) + ", step " + std::to_string(outcome.step);
    if (++kinds_[kind] > 2) {
      FAIL_CHECK(where << ": " << outcome.fault);
      return;
    }
    const std::string file = "body-" + std::to_string(seed) + ".front";
    BodyCase small = c;
    small.cracks.resize(outcome.crack + 1);
    small.cracks.back().rows.resize(outcome.step + 1);
    if (!std::getenv("KERF_WHOLE"))
      small = body_cases::shrink(small, [&](const BodyCase& s) { return fails_alike(s, kind); });
    write_all(file, [&](std::ostream& out) {
      body_cases::write_body_case(out, small, "found with seed " + std::to_string(seed) + ": " + outcome.fault);
    });
    FAIL_CHECK(where << ": " << outcome.fault << "; the smallest such case is in " << file);
  }

  static bool fails_alike(const BodyCase& c, const std::string& kind) {
    try {
      return kind_of(cut(c, true).fault) == kind;
    } catch (const InputError&) {  // no such model
      return false;
    }
  }

  std::size_t cases_ = 0, steps_ = 0, cutting_ = 0, refused_ = 0, parted_ = 0, guided_ = 0, varied_ = 0, resized_ = 0;
  std::set<std::string> made_;
  std::map<std::string, int> kinds_;
};

// The steps that come near the model, no more than ten.
std::vector<std::vector<Vec3>> near_steps(const Complex& surface, std::vector<std::vector<Vec3>> rows) {
  const auto is_near = [&](std::size_t s) {
    Box3 box;
    for (const auto row : {s, s + 1})
      for (const Vec3& p : rows[row]) box.add(p);
    return box.meets(surface.extent());
  };
  while (rows.size() > 2 && !is_near(0)) rows.erase(rows.begin());
  while (rows.size() > 2 && !is_near(rows.size() - 2)) rows.pop_back();
  if (rows.size() > 11) rows.resize(11);
  return rows;
}

/// Up to three cracks of up to ten steps; some run along the sheet of an earlier one.
std::vector<GridCrack> random_cracks(const Complex& surface, Random& random) {
  std::vector<GridCrack> cracks;
  for (int c = 1 + static_cast<int>(random.below(3)); c > 0; --c) {
    if (!cracks.empty() && random.below(5) == 0) {
      cracks.push_back(GridCrack(cracks.back()));
      continue;
    }
    const auto sweep = random_sweeps::make_sweep(surface, random, 16);
    cracks.push_back({sweep.closed, near_steps(surface, sweep.rows)});
  }
  return cracks;
}

const std::vector<std::string> model_names{"bear",  "elephant", "dino",  "hand",         "femur",  "bull",
                                           "homer", "knot1",    "eight", "couplingdown", "pumpkin"};

/// Thin slits beside each other: what lies between two of them holds few nodes or none.
std::vector<GridCrack> random_slits(const Complex& surface, Random& random) {
  const Box3& box = surface.extent();
  const double size = box.diagonal();
  const Vec3 n = random.direction(), u = n.unitOrthogonal(), v = n.cross(u);
  const Vec3 middle = box.center() + random.uniform(0, 0.15) * size * random.direction();
  std::vector<GridCrack> cracks;
  double at = 0;
  const int steps = 1 + static_cast<int>(random.below(6));
  const bool complete = random.below(2);
  for (int c = 0; c < 4; ++c) {
    GridCrack crack;
    at += std::pow(10, random.uniform(-5, -1.2)) * size;
    const double depth = complete ? 2.4 : random.uniform(0.9, 1.5),
                 tilt = random.below(3) ? 0.0 : random.uniform(-0.01, 0.01);
    for (int s = 0; s <= steps; ++s) {
      crack.rows.emplace_back();
      for (int i = 0; i < 3; ++i)
        crack.rows.back().push_back(middle + (at + tilt * i * size) * n + 1.2 * size * (i - 1) * u +
                                    size * (depth * s / steps - 1.2) * v);
    }
    cracks.push_back(crack);
  }
  return cracks;
}

// Every third body has guides along its concave edges and the fronts of its cracks.
double guides_for(std::uint64_t seed) { return seed / model_names.size() % 3 == 0 ? 0.7 : 0.0; }

// In every other sequence some nodes get other radii after each step.
int resize_for(std::uint64_t seed) { return seed / model_names.size() % 2 == 0 ? static_cast<int>(seed % 1000000) : 0; }

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr int share = 1;  // each costs several times as much here
#else
constexpr int share = 2;
#endif

}  // namespace

TEST_CASE("Cut bodies are as from scratch after every step: real models", "[bodies][models]") {
  const Seeds which = seeds(11 * share);
  Campaign campaign;
  for (std::size_t m = 0; m < model_names.size(); ++m)
    for (int i = 0; i < which.count; ++i) {
      const std::uint64_t seed = which.first + static_cast<std::uint64_t>(i);
      if (seed % model_names.size() != m) continue;
      BodyCase c{.model = model_names[m], .guides = guides_for(seed), .resize = resize_for(seed), .cracks = {}};
      if (seed / model_names.size() % 4 != 0) {
        c.faces = 800;
        c.nodes = 500;
      }
      Random random(seed * 104729);
      c.cracks = random_cracks(body_cases::body_of(c).surface, random);
      campaign.run(c, seed);
    }
}

TEST_CASE("Cut bodies are as from scratch after every step: slits beside each other", "[bodies][slits]") {
  const Seeds which = seeds(6 * share);
  Campaign campaign;
  for (int i = 0; i < which.count; ++i) {
    const std::uint64_t seed = which.first + static_cast<std::uint64_t>(i);
    BodyCase c{.model = "pumpkin",
               .faces = 800,
               .nodes = 700,
               .jitter = 0.3,
               .guides = guides_for(seed),
               .resize = resize_for(seed),
               .cracks = {}};
    Random random(seed * 15485863);
    c.cracks = random_slits(body_cases::body_of(c).surface, random);
    campaign.run(c, seed);
  }
}

TEST_CASE("Cut bodies are as from scratch after every step: cracks through nodes of a grid", "[bodies][aligned]") {
  const Seeds which = seeds(15 * share);
  Campaign campaign;
  for (int i = 0; i < which.count; ++i) {
    const std::uint64_t seed = which.first + static_cast<std::uint64_t>(i);
    const GridCase grid = random_case(seed);
    campaign.run({.faces = grid.divisions,
                  .nodes = 343,
                  .guides = guides_for(seed),
                  .resize = resize_for(seed),
                  .cracks = grid.cracks},
                 seed);
  }
}

TEST_CASE("Kept cases of cut bodies are as from scratch after every step", "[bodies]") {
  // Each failed once: files that the tests above left behind.
  int count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(KERF_KEPT_BODIES)) {
    const std::string name = entry.path().filename().string();
    CAPTURE(name);
    const Outcome result = cut(body_cases::read_body_case(read_all(entry.path().string()), name), true);
    CHECK(result.fault == "");
    CHECK(result.refused == 0);
    ++count;
  }
  CHECK(count >= 1);
}
