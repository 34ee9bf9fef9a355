// Fractures of a data set: ten models of about 5000 triangles, as kerf-dataset makes and writes
// them, on one core. Every fracture is checked as it is there, and some in full.
#include <cmath>
#include <cstdio>
#include <sstream>

#include "bench.h"
#include "dataset/shard_file.h"
#include "kerf/check.h"
#include "kerf/error.h"
#include "kerf/parallel.h"

namespace bench {
namespace {

using namespace ::dataset;

constexpr geo::Pattern patterns[] = {geo::Pattern::voronoi, geo::Pattern::planes, geo::Pattern::crossing,
                                     geo::Pattern::radial,  geo::Pattern::glass,  geo::Pattern::wood,
                                     geo::Pattern::bricks};

Model model_of(const char* name, const geo::TriangleMesh& mesh) {
  return {name, mesh, geo::Complex::from_skin(mesh), geo::signed_volume(mesh)};
}

// Spheres with `lobes` bumps of a height, round an axis and along it.
geo::TriangleMesh bumpy(int frequency, double lobes, double height) {
  return geo::make_star(frequency, [&](const geo::Vec3& d) {
    return 1 + height * std::sin(lobes * std::atan2(d.y(), d.x())) * std::sin(lobes * std::acos(d.z())) *
                   (1 - d.z() * d.z());
  });
}

std::vector<Model> ten_models() {
  constexpr int f = 16;  // 5120 triangles
  std::vector<Model> models;
  models.push_back(model_of("pumpkin", geo::make_pumpkin(f)));
  models.push_back(model_of("apple", geo::make_apple(f)));
  models.push_back(model_of("polyp", geo::make_polyp(f)));
  models.push_back(model_of("sphere", geo::make_sphere(f)));
  models.push_back(model_of("star 3", bumpy(f, 3, 0.3)));
  models.push_back(model_of("star 7", bumpy(f, 7, 0.15)));
  models.push_back(model_of("block", geo::make_block({2, 1, 0.6}, 0.0465)));
  models.push_back(model_of("plate", geo::make_block({2, 2, 0.1}, 0.0585)));
  models.push_back(model_of("K", geo::make_letter('K', 0.3, 30)));
  models.push_back(model_of("O", geo::make_letter('O', 0.3, 30)));
  return models;
}

struct Row {
  std::size_t made = 0, failed = 0, wrong = 0, bytes = 0, faces = 0;
  double seconds = 0;
  Row& operator+=(const Row& o) {
    made += o.made;
    failed += o.failed;
    wrong += o.wrong;
    bytes += o.bytes;
    faces += o.faces;
    seconds += o.seconds;
    return *this;
  }
};

// True where a piece crosses itself: exact, and apart from the checks of kerf-dataset.
bool is_wrong(const Fracture& fracture) {
  for (const Piece& piece : fracture.pieces) {
    geo::TriangleMesh mesh;
    mesh.vertices = piece.vertices;
    mesh.triangles = piece.faces;
    if (!geo::check_surface(mesh, geo::SelfIntersections::find).good()) return true;
  }
  return false;
}

// A shard, made and written into memory; every tenth fracture is checked in full, untimed.
Row measure(const Model& model, geo::Pattern pattern, int seeds) {
  Row row;
  Settings settings;
  settings.jagged = {.low = 0.01, .high = 0.01};
  std::vector<Outcome> outcomes(static_cast<std::size_t>(seeds));
  const double start = cpu_seconds();
  for (std::size_t s = 0; s < outcomes.size(); ++s) {
    outcomes[s].seed = s + 1;
    try {
      outcomes[s].fracture = break_model(model, recipe_of(settings, pattern, s + 1));
    } catch (const geo::GeometryError& e) {
      outcomes[s].why = e.what();
    } catch (const geo::InputError& e) {
      outcomes[s].why = e.what();
    }
  }
  std::ostringstream archive;
  write_archive(archive, outcomes, settings.single);
  row.seconds = cpu_seconds() - start;
  row.bytes = archive.str().size();
  for (std::size_t s = 0; s < outcomes.size(); ++s) {
    ++(outcomes[s].fracture ? row.made : row.failed);
    if (!outcomes[s].fracture) continue;
    for (const Piece& piece : outcomes[s].fracture->pieces) row.faces += piece.faces.size();
    if (s % 10 == 0) row.wrong += is_wrong(*outcomes[s].fracture);
  }
  return row;
}

}  // namespace

int dataset(const Options& options) {
  geo::set_threads(1);
  std::vector<Model> models = ten_models();
  for (const auto& path : options.models) models.push_back(read_model(path, path, false, {}));
  Figures figures;
  Row all;
  for (const geo::Pattern pattern : patterns) {
    Row sum;
    for (const Model& model : models) {
      const Row row = measure(model, pattern, 10);
      sum += row;
      if (!options.json)
        std::printf("%-9s %-8s %6.3f s, %zu failed, %zu wrong, %7.0f faces\n", model.name.c_str(),
                    geo::pattern_names[static_cast<std::size_t>(pattern)], row.seconds / double(row.made + row.failed),
                    row.failed, row.wrong, double(row.faces) / double(row.made));
    }
    figures[std::string("fractures_per_core_hour_") + geo::pattern_names[static_cast<std::size_t>(pattern)]] =
        3600 * double(sum.made) / sum.seconds;
    all += sum;
  }
  figures["fractures_per_core_hour"] = figures["fractures_per_core_hour_voronoi"];  // as kerf-dataset makes by default
  figures["fractures_per_core_hour_all_patterns"] = 3600 * double(all.made) / all.seconds;
  figures["failed_share"] = double(all.failed) / double(all.made + all.failed);
  figures["wrong"] = double(all.wrong);
  figures["bytes_per_fracture"] = double(all.bytes) / double(all.made);
  print(figures, options.json);
  return 0;
}

}  // namespace bench
