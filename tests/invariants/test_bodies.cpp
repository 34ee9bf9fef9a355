// Bodies cut at random: after every step graph, rows and binding are those of scratch, components are pieces, nodes are
// inside. A campaign: KERF_CASES=25 KERF_SEED=7 test_invariants '[bodies]'; one case of it: KERF_CASE=7000123 and the
// name of the test; KERF_TELL=1 tells of every step.
#include <catch2/catch.hpp>
#include <filesystem>
#include <optional>

#include "base/error.h"
#include "base/parallel.h"
#include "cases.h"
#include "crack/decimate.h"
#include "crack/grid_case.h"
#include "crack/shrink.h"
#include "invariants/body_faults.h"
#include "invariants/models.h"
#include "invariants/random_sweeps.h"
#include "io/stream.h"
#include "sampling/sample.h"

using namespace geo;

namespace {

struct Crack {
  std::string kind;
  bool closed = false;
  std::vector<std::vector<Vec3>> rows;
};

struct Outcome {
  std::string fault, where;  ///< empty: every invariant held after every step
  std::size_t steps = 0, refused = 0, parted = 0;
  Body body;
};

// `check` every step, or none.
Outcome cut(const Body& model, const std::vector<Crack>& cracks, bool check) {
  Outcome result;
  result.body = model;
  const double volume = body_faults::total(model.nodes.volume);
  for (std::size_t c = 0; c < cracks.size(); ++c) {
    FrontState front = begin_front(cracks[c].rows[0], cracks[c].closed, static_cast<std::int32_t>(c + 1));
    for (std::size_t s = 1; s < cracks[c].rows.size(); ++s) {
      const Body before = check ? result.body : Body();
      ++result.steps;
      std::string fault;
      SplitWork work;
      try {
        const BodyDelta delta = split(result.body, front, cracks[c].rows[s], {}, &work);
        result.parted += delta.parted.size();
        if (check && std::getenv("KERF_TELL"))
          WARN("crack " << c + 1 << " step " << s << ": " << delta.crack.new_crack_faces.size() << " crack faces, " << result.body.nodes.size() << " nodes, "
                        << delta.parted.size() << " pieces more, " << work.resample_seconds << " + " << work.graph_seconds << " + " << work.binding_seconds << " s");
        if (check && !delta.crack.empty()) fault = body_faults::fault_of(before, result.body, delta, volume);
      } catch (const GeometryError&) {
        ++result.refused;
        if (check && (result.body.nodes.position != before.nodes.position || !(result.body.graph == before.graph) ||
                      !(result.body.binding == before.binding) || result.body.surface.face_count() != before.surface.face_count()))
          fault = "a refused step changed the body";
        else
          break;
      }
      if (fault.empty()) continue;
      result.fault = fault, result.where = "crack " + std::to_string(c + 1) + " (" + cracks[c].kind + "), step " + std::to_string(s);
      return result;
    }
  }
  return result;
}

bool same(const Body& a, const Body& b) {
  if (a.nodes.position != b.nodes.position || a.nodes.volume != b.nodes.volume || !(a.graph == b.graph) || !(a.binding == b.binding)) return false;
  return true;
}

struct Tally {
  std::size_t cases = 0, steps = 0, refused = 0, parted = 0;
  // Every fifth case again with other numbers of threads.
  void run(const Body& model, const std::vector<Crack>& cracks, const std::string& name) {
    set_threads(2);
    const Outcome two = cut(model, cracks, true);
    INFO(name << ", " << two.where);
    CHECK(two.fault == "");
    for (const int threads : {1, 4}) {
      if (cases % 5 != 0 || !two.fault.empty()) continue;
      set_threads(threads);
      CHECK(same(two.body, cut(model, cracks, false).body));
    }
    set_threads(0);
    ++cases, steps += two.steps, refused += two.refused, parted += two.parted;
  }
  ~Tally() {
    if (std::getenv("KERF_CASES")) WARN(cases << " sequences, " << steps << " steps, " << refused << " refused, " << parted << " pieces came off");
  }
};

/// A real model with about 1,500 faces and some hundred nodes.
Body make_model(const std::string& name) {
  Complex k = Complex::from_skin(invariants::model(name));
  decimate(k, {}, {.deviation = 0.02, .faces = 1500});
  auto coarse = k.two_sided();
  coarse.site.clear(), coarse.source.clear();
  require_solid(coarse);
  k = Complex::from_skin(coarse);
  SampleOptions sampling;
  sampling.count = 900;
  NodeSet nodes = sample_nodes(coarse, sampling);
  return build_body(std::move(k), std::move(nodes));
}

/// Up to three cracks of up to ten steps; some run along the sheet of an earlier one.
std::vector<Crack> random_cracks(const Body& model, Random& random) {
  std::vector<Crack> cracks;
  for (int c = 1 + static_cast<int>(random.below(3)); c > 0; --c) {
    if (!cracks.empty() && random.below(5) == 0) {
      cracks.push_back(cracks.back());
      cracks.back().kind = "again " + cracks.back().kind;
      continue;
    }
    const auto sweep = random_sweeps::make_sweep(model.surface, random, 10);
    cracks.push_back({sweep.kind, sweep.closed, sweep.rows});
  }
  return cracks;
}

const std::vector<std::string> model_names{"bear", "elephant", "dino", "hand", "femur", "bull", "homer", "knot1", "eight", "couplingdown", "pumpkin"};

/// A block of 4 × 4 × 4 with nodes on a regular grid, those of whole coordinates included: cracks run exactly through
/// nodes and the planes between them.
Body make_grid_body(int divisions) {
  const TriangleMesh block = make_block({4, 4, 4}, 4.0 / divisions);
  NodeSet nodes;
  for (int z = 1; z < 8; ++z)
    for (int y = 1; y < 8; ++y)
      for (int x = 1; x < 8; ++x) {
        nodes.position.push_back(0.5 * Vec3(x, y, z));
        nodes.spacing.push_back(0.5), nodes.radius.push_back(1.0), nodes.volume.push_back(64.0 / 343);
      }
  return build_body(Complex::from_skin(block), nodes);
}

Outcome cut_grid(const GridCase& grid) {
  static const std::array<Body, 2> models{make_grid_body(1), make_grid_body(2)};
  std::vector<Crack> cracks;
  for (const auto& c : grid.cracks) cracks.push_back({"grid", c.closed, c.rows});
  return cut(models[grid.divisions == 1 ? 0 : 1], cracks, true);
}

/// Thin slits beside each other, the nodes jittered: what lies between two of them holds few nodes or none.
std::vector<Crack> random_slits(const Body& model, Random& random) {
  const Box3& box = model.surface.extent();
  const double size = box.diagonal();
  const Vec3 n = random.direction(), u = n.unitOrthogonal(), v = n.cross(u);
  const Vec3 middle = box.center() + random.uniform(0, 0.15) * size * random.direction();
  std::vector<Crack> cracks;
  double at = 0;
  const int steps = 1 + static_cast<int>(random.below(6));
  const bool complete = random.below(2);
  for (int c = 0; c < 4; ++c) {
    Crack crack;
    crack.kind = complete ? "cut" : "slit";
    at += std::pow(10, random.uniform(-5, -1.2)) * size;
    const double depth = complete ? 2.4 : random.uniform(0.9, 1.5), tilt = random.below(3) ? 0.0 : random.uniform(-0.01, 0.01);
    for (int s = 0; s <= steps; ++s) {
      crack.rows.emplace_back();
      for (int i = 0; i < 3; ++i)
        crack.rows.back().push_back(middle + (at + tilt * i * size) * n + 1.2 * size * (i - 1) * u + size * (depth * s / steps - 1.2) * v);
    }
    cracks.push_back(crack);
  }
  return cracks;
}

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr int share = 1;  // each costs several times as much here
#else
constexpr int share = 2;
#endif

}  // namespace

TEST_CASE("Cut bodies are as from scratch after every step: real models", "[bodies][models]") {
  const Seeds which = seeds(11 * share);
  Tally tally;
  for (std::size_t m = 0; m < model_names.size(); ++m) {
    std::optional<Body> model;
    for (int c = 0; c < which.count; ++c) {
      const std::uint64_t seed = which.first + static_cast<std::uint64_t>(c);
      if (seed % model_names.size() != m) continue;
      INFO("KERF_CASE=" << seed << ", " << model_names[m]);
      if (!model) {
        model = make_model(model_names[m]);
        REQUIRE(body_faults::fault_of(*model, body_faults::total(model->nodes.volume)) == "");
      }
      Random random(seed * 104729);
      tally.run(*model, random_cracks(*model, random), "KERF_CASE=" + std::to_string(seed) + ", " + model_names[m]);
    }
  }
}

TEST_CASE("Cut bodies are as from scratch after every step: slits beside each other", "[bodies][slits]") {
  const Seeds which = seeds(6 * share);
  const auto mesh = make_pumpkin(5);
  SampleOptions sampling;
  sampling.count = 700, sampling.jitter = 0.3;
  const Body model = build_body(Complex::from_skin(mesh), sample_nodes(mesh, sampling));
  Tally tally;
  for (int c = 0; c < which.count; ++c) {
    const std::uint64_t seed = which.first + static_cast<std::uint64_t>(c);
    Random random(seed * 15485863);
    tally.run(model, random_slits(model, random), "KERF_CASE=" + std::to_string(seed));
  }
}

TEST_CASE("Cut bodies are as from scratch after every step: cracks through nodes of a grid", "[bodies][aligned]") {
  const Seeds which = seeds(14 * share);
  std::size_t steps = 0, refused = 0;
  for (int c = 0; c < which.count; ++c) {
    const std::uint64_t seed = which.first + static_cast<std::uint64_t>(c);
    const Outcome result = cut_grid(random_case(seed));
    steps += result.steps, refused += result.refused;
    if (result.fault.empty()) continue;
    if (std::getenv("KERF_TELL")) WARN("KERF_CASE=" << seed << ", " << result.where << ": " << result.fault);
    const std::string kind = kind_of(result.fault), file = "body-" + std::to_string(seed) + ".front";
    const GridCase small = shrink(random_case(seed), [&](const GridCase& g) { return kind_of(cut_grid(g).fault) == kind; });
    write_all(file, [&](std::ostream& out) { write_case(out, small, "found with seed " + std::to_string(seed) + ": " + result.fault); });
    FAIL_CHECK("KERF_CASE=" << seed << ", " << result.where << ": " << result.fault << "; the smallest such case is in " << file);
  }
  if (std::getenv("KERF_CASES")) WARN(which.count << " sequences, " << steps << " steps, " << refused << " refused");
}
