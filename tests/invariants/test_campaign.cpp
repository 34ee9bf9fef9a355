// Random fronts of every kind through every closed model there is: planes, curved, jagged, rings,
// the same sheet again, a third of them through vertices, edges and faces of what they cut.
#include <algorithm>
#include <catch2/catch.hpp>
#include <filesystem>
#include <map>
#include <numeric>

#include "invariants/models.h"
#include "invariants/random_sweeps.h"
#include "kerf/error.h"

using namespace geo;

namespace {

struct Model {
  std::string name;
  Complex complex;
  double volume = 0;
};

// All solids that the archive holds, the smallest first, and two of ours.
std::vector<Model> all_models(std::size_t largest) {
  std::vector<Model> models;
  const auto add = [&](const std::string& name, const TriangleMesh& mesh) {
    try {
      if (mesh.triangles.size() > largest) return;
      require_solid(mesh);
      models.push_back({name, Complex::from_skin(mesh), signed_volume(mesh)});
    } catch (const InputError&) {  // open, crossing itself, inside out: not a solid
    }
  };
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(std::string(KERF_MODEL_FOLDER) + "/unpacked"))
    if (entry.path().extension() == ".off") files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  for (const auto& file : files) try {
      add(file.stem().string(), read_surface(file.string()).mesh);
    } catch (const InputError&) {  // no triangle mesh
    }
  add("pumpkin", make_pumpkin(8));
  add("block", make_block({2, 1, 1}, 0.25));
  std::stable_sort(models.begin(), models.end(), [](const Model& a, const Model& b) {
    return a.complex.live_face_count() < b.complex.live_face_count();
  });
  return models;
}

double volume_of(const Complex& k) {
  const Pieces pieces = find_pieces(k);
  return std::accumulate(pieces.volume.begin(), pieces.volume.end(), 0.0);
}

}  // namespace

TEST_CASE("Every kind of front through every model keeps every invariant after every step", "[campaign]") {
  // A campaign: KERF_CASES=300 KERF_SEED=2 test_invariants '[campaign]'
  const char* first = std::getenv("KERF_SEED");
  const std::uint64_t base = first ? std::strtoull(first, nullptr, 10) * 1000000 : 0;
  const auto models = all_models(random_cuts::cases(1) > 1 ? 60000 : 9000);
  CHECK(models.size() >= 30);
  std::size_t fronts = 0, steps = 0, repairs = 0, retries = 0;
  std::map<std::string, std::size_t> refused;
  for (const Model& model : models)
    if (!std::getenv("KERF_ONLY") || model.name == std::getenv("KERF_ONLY"))
      for (int c = 0; c < random_cuts::cases(1); ++c) {
        const std::uint64_t seed = base + static_cast<std::uint64_t>(c) * 1000 + 1;
        Random random(seed * 7919 + model.complex.live_face_count());
        Complex k = model.complex;
        std::vector<random_sweeps::Sweep> sweeps;
        for (std::int32_t crack = 1; crack <= 3; ++crack) {
          // The same sheet again, or a new one.
          if (sweeps.empty() || random.below(4))
            sweeps.push_back(random_sweeps::make_sweep(k, random));
          else {
            sweeps.push_back(sweeps.back());
            sweeps.back().kind = "again " + sweeps.back().kind;
          }
          const auto& sweep = sweeps.back();
          INFO(model.name << ", seed " << seed << ", crack " << crack << ", " << sweep.kind);
          FrontState front = begin_front(sweep.rows[0], sweep.closed, crack);
          ++fronts;
          for (std::size_t s = 1; s < sweep.rows.size(); ++s) {
            INFO("step " << s << " of " << sweep.rows.size() - 1);
            ++steps;
            CrackStats work;
            const auto before = k.live_face_count();
            try {
              const CrackDelta delta = advance(k, front, sweep.rows[s], {}, &work);
              const auto crossing = self_intersections(k, &delta.new_faces);
              if (!crossing.empty())
                FAIL("faces " << crossing[0].first.value << " and " << crossing[0].second.value << " cross");
              if (const auto report = check_near(k, delta.new_faces); !report.good()) FAIL(report.first_problem);
            } catch (const GeometryError& e) {
              const std::string why = e.what();
              ++refused[why.substr(why.find(": ") + 2, 48)];
              if (std::getenv("KERF_TELL"))
                WARN(model.name << " seed " << seed << " crack " << crack << " " << sweep.kind << ": " << why);
              if (k.live_face_count() != before) FAIL("a refused step changed the complex");
              break;
            }
            repairs += work.repairs;
            retries += work.attempts - 1;
          }
          const auto report = check_complex(k, SelfIntersections::ignore);
          if (!report.good()) FAIL(report.first_problem);
          if (std::abs(volume_of(k) - model.volume) > 1e-11 * model.volume)
            FAIL("volume " << volume_of(k) << " of " << model.volume);
        }
        const auto report = check_complex(k, SelfIntersections::find);
        if (!report.good()) FAIL(model.name << ", seed " << seed << ": " << report.first_problem);
      }
  std::size_t sum = 0;
  for (const auto& [why, times] : refused) {
    WARN(times << " of " << steps << " steps refused: " << why);
    sum += times;
  }
  if (random_cuts::cases(1) > 1)
    WARN(models.size() << " models, " << fronts << " fronts, " << steps << " steps, " << sum << " refused, " << repairs
                       << " repaired, " << retries << " redone");
  CHECK(sum * 1000 <= std::max<std::size_t>(5 * steps, 4000));
}
