// Fuzzing of readers: valid files with random damage are read, or refused in one line.
//   KERF_CASES=100 KERF_SEED=3 test_io '[fuzz]'; one case: KERF_CASE=3000123 test_io '[fuzz]'.
#include "io/fuzz.h"

#include <memory>

#include "io/kerf_bytes.h"
#include "io/kerf_sections.h"
#include "io/samples.h"
#include "kerf/body_file.h"
#include "kerf/check.h"
#include "kerf/crack.h"
#include "kerf/files.h"
#include "kerf/pieces.h"

using namespace geo;
using fuzz::Use;

namespace {

fuzz::Damage damage_to(std::vector<std::string> files) {
  return [files = std::move(files)](Random& random) {
    const std::string& file = files[random.below(static_cast<std::uint32_t>(files.size()))];
    return Mutator(random).damaged(file, files);
  };
}

// A container whose hashes fit although its sections, or its table, were damaged.
std::string sealed(Random& random, const std::string& good) {
  Mutator mutator(random);
  KerfSections sections = parse_kerf(good, "good");
  if (random.below(4) == 0) {
    const std::string table = last_segment(good).table;
    return with_table(good, mutator.damaged(table, {table}));
  }
  for (auto changes = 1 + random.below(2); changes-- > 0;) {
    const auto pick = [&] {
      return std::next(sections.begin(), random.below(static_cast<std::uint32_t>(sections.size())));
    };
    auto& [name, s] = *pick();
    const std::size_t size = s.bytes.size();
    switch (random.below(10)) {
      case 3:
      case 4:
      case 5:
      case 6:
        mutator.damage_number(s.bytes, s.dtype == "f8" ? 8 : s.dtype == "u1" || s.dtype == "json" ? 1 : 4);
        break;
      case 0:
        s.bytes = pick()->second.bytes;
        break;
      case 1:
        s = pick()->second;
        break;
      case 2:
        s.dtype = random.below(2) ? "u4" : "f8";
        break;
      default:
        s.bytes = mutator.damaged(s.bytes, {s.bytes, pick()->second.bytes});
    }
    // Most keep their size; what fits no shape is for the table above.
    if (random.below(4)) s.bytes.resize(size);
    const std::size_t width = kerf::size_of(s.dtype) * (s.shape.size() > 1 ? s.shape[1] : 1);
    s.bytes.resize(s.bytes.size() / width * width);
    s.shape[0] = s.bytes.size() / width;
  }
  return bytes_of([&](auto& out) { write_kerf(out, sections); });
}

void continue_fronts(Complex& k, std::vector<FrontState> fronts) {
  for (auto& front : fronts) {
    std::vector<Vec3> next;
    for (const auto& p : front.points) next.push_back(p.position + Vec3(0.11, 0.07, 0.23));
    advance(k, front, next);
  }
}

Use use_surface(SurfaceFile file) {
  return [file = std::move(file)] {
    const auto report = check_surface(file.mesh, SelfIntersections::find);
    Complex k = Complex::from_two_sided(file.mesh);
    if (!report.good()) return;
    find_pieces(k);
    continue_fronts(k, file.fronts);
  };
}

Use use_fronts(std::vector<Front> fronts) {
  return [fronts = std::move(fronts)] {
    Complex k = Complex::from_skin(make_block({4, 4, 4}, 2));
    for (const auto& f : fronts) {
      if (f.is_sheet()) {
        TriangleMesh sheet;
        sheet.vertices = f.steps[0];
        sheet.triangles = f.triangles;
        insert_sheet(k, sheet, k.crack_count() + 1);
        continue;
      }
      FrontState state = begin_front(f.steps[0], f.closed, k.crack_count() + 1);
      auto at = f.steps[0];
      for (std::size_t s = 1; s < f.steps.size(); ++s) advance(k, state, at = resample_front(at, f.steps[s], f.closed));
    }
    if (const auto report = check_complex(k, SelfIntersections::find); !report.good())
      throw std::logic_error(report.first_problem);
  };
}

}  // namespace

TEST_CASE("damaged surfaces are read or refused", "[fuzz]") {
  fuzz::campaign(
      "surface", 3000, [](const auto& bytes, const auto& name) { return use_surface(parse_surface(bytes, name)); },
      damage_to(sample_surfaces()));
}

TEST_CASE("damaged fronts are read or refused", "[fuzz]") {
  fuzz::campaign(
      "front", 3000, [](const auto& bytes, const auto& name) { return use_fronts(parse_fronts(bytes, name)); },
      damage_to(sample_fronts()));
}

TEST_CASE("damaged nodes are read or refused", "[fuzz]") {
  const Body body = cut_body();
  const Complex skin = Complex::from_skin(make_block({1, 1, 1}, 0.5));
  fuzz::campaign(
      "nodes", 3000,
      [&](const auto& bytes, const auto& name) -> Use {
        return [&skin, nodes = parse_nodes(bytes, name)] { build_body(skin, nodes); };
      },
      damage_to(sample_nodes_files(body.nodes)));
}

TEST_CASE("damaged scenes are read or refused", "[fuzz]") {
  fuzz::campaign(
      "scene", 3000,
      [](const auto& bytes, const auto& name) -> Use {
        return [scene = parse_scene(bytes, name)] {
          for (const auto& blade : scene.blades)
            for (const auto& key : blade.motion.keys) blade.at(key.time);
        };
      },
      damage_to(sample_scenes()));
}

TEST_CASE("damaged bodies are read or refused", "[fuzz]") {
  const auto [whole, appended] = sample_body_files();
  REQUIRE(KerfFile(Input(appended, "a.kerf")).updates() == 1);
  const fuzz::Read read = [](const auto& bytes, const auto& name) -> Use {
    return [body = std::make_shared<Body>(parse_body(bytes, name))] {
      check_body(*body);
      bytes_of([&](auto& out) { write_body(out, *body); });
    };
  };
  fuzz::campaign("kerf", 1000, read, damage_to({whole, appended}));
  fuzz::campaign("body", 3000, read, [&, good = whole](Random& random) { return sealed(random, good); });
  fuzz::campaign("delta", 3000, read, [&, good = appended, begin = whole.size()](Random& random) {
    // Where the last update is: its head, runs, rows and table.
    Mutator mutator(random);
    std::string update = good.substr(begin);
    if (random.below(4) == 0) return with_table(good, mutator.damaged(last_segment(good).table, {update}));
    for (auto changes = 1 + random.below(3); changes-- > 0;) mutator.damage_number(update, random.below(2) ? 8 : 4);
    return resealed(good.substr(0, begin) + update);
  });
}

TEST_CASE("damaged checkpoints are read or refused", "[fuzz]") {
  const std::string good = sample_checkpoint(cut_body());
  fuzz::campaign(
      "run", 3000,
      [](const auto& bytes, const auto& name) -> Use {
        return [c = read_checkpoint(KerfFile(Input(bytes, name)))] {
          bytes_of([&](auto& out) { write_checkpoint(out, c.body, c.state, c.scene); });
        };
      },
      [&](Random& random) { return sealed(random, good); });
}
