// core_bytes: what the library computes, as one line of a name and a hash each. The core and the
// full library must print the same lines.
#include <cstdio>
#include <functional>
#include <sstream>
#include <string>

#include "kerf/check.h"
#include "kerf/complex.h"
#include "kerf/crack.h"
#include "kerf/files.h"
#include "kerf/jobs.h"
#include "kerf/parallel.h"
#include "kerf/pieces.h"
#include "kerf/repair.h"
#include "kerf/score.h"

using namespace geo;

namespace {

void print_hash(const std::string& name, const std::string& bytes) {
  std::printf("%-40s %016llx\n", name.c_str(), static_cast<unsigned long long>(fingerprint(bytes)));
}

std::string written(const std::function<void(std::ostream&)>& write) {
  std::ostringstream out;
  write(out);
  return out.str();
}

// A score of a model, the crack along it, the pieces with their hulls and bonds, in every format.
void print_fracture(const std::string& name, const TriangleMesh& model, Pattern pattern) {
  ScoreOptions options;
  options.pattern.pattern = pattern;
  options.pattern.seed = 7;
  options.pieces = 12;
  options.jagged.amplitude = 0.02;
  Complex complex = Complex::from_skin(model);
  const Score score = make_score(complex, options);
  insert_sheet(complex, score.sheet, 1);
  const std::string title = name + " " + pattern_names[static_cast<std::size_t>(pattern)];
  print_hash(title + " score", written([&](std::ostream& out) { write_ply(out, score.sheet); }));
  print_hash(title + " crack", written([&](std::ostream& out) { write_ply(out, complex.two_sided()); }));
  const PieceSet pieces = fracture(model, options);
  print_hash(title + " glb", written([&](std::ostream& out) {
               write_glb(out, pieces.chunks, pieces.bonds, pieces.labels, {.hull_corners = 64, .hull_parts = 2});
             }));
  print_hash(title + " obj", written([&](std::ostream& out) { write_obj(out, pieces.chunks[0].mesh); }));
  print_hash(title + " off", written([&](std::ostream& out) { write_off(out, pieces.chunks[1].mesh); }));
  print_hash(title + " stl", written([&](std::ostream& out) { write_stl(out, pieces.chunks[2].mesh); }));
}

// Progressive cuts on the integer grid, where predicates are degenerate and decided exactly.
void print_grid_cuts() {
  Complex complex = Complex::from_skin(make_block(Vec3(4, 4, 4), 1));
  for (int crack = 1; crack <= 12; ++crack) {
    const double at = 1 + crack % 3, slope = crack / 4;
    TriangleMesh sheet;
    sheet.vertices = {{at, -1, -1}, {at, 5, -1 + slope}, {at, 5, 5}, {at, -1, 5 - slope}};
    if (crack % 2)
      for (Vec3& p : sheet.vertices) p = Vec3(p.y(), p.x(), p.z());
    sheet.triangles = {{0, 1, 2}, {0, 2, 3}};
    try {
      insert_sheet(complex, sheet, crack);
    } catch (const std::exception& e) {
      std::printf("grid %d: %s\n", crack, e.what());
    }
  }
  print_hash("grid cuts", written([&](std::ostream& out) { write_ply(out, complex.two_sided()); }));
}

void print_repair() {
  TriangleMesh two = make_sphere(6);
  const TriangleMesh other = make_sphere(5);
  const auto first = static_cast<std::uint32_t>(two.vertices.size());
  for (const Vec3& p : other.vertices) two.vertices.push_back(p + Vec3(0.5, 0.25, 0.125));
  for (const auto& [a, b, c] : other.triangles) two.triangles.push_back({a + first, b + first, c + first});
  print_hash("union", written([&](std::ostream& out) { write_ply(out, repaired_solid(two)); }));
}

void print_simulation() {
  const Scene scene = parse_scene(R"(
[time]
frames = 4
[body]
mesh = "block"
nodes = 200
[material]
young = 5e4
[ground]
point = [0, 0, -0.2]
[[blade]]
points = [[0, -1, 0], [0, 2, 0]]
divide = 4
keys = [[0, 0.45, 0, 1.2, 0, 0, 1, 4], [0.15, 0.45, 0, 0.2, 0, 0, 1, 4]]
)",
                                  "scene");
  const Simulation run =
      simulate(scene, {make_block(Vec3(1, 1, 1), 0.2)}, [](const Simulation&, const FrameStats&) { return true; });
  print_hash("simulation", written([&](std::ostream& out) { write_ply(out, run.surface()); }));
}

}  // namespace

int main(int count, char** arguments) {
  if (count > 1) set_threads(std::atoi(arguments[1]));
  for (const Pattern pattern : {Pattern::voronoi, Pattern::glass, Pattern::bricks}) {
    print_fracture("pumpkin", make_pumpkin(12), pattern);
    print_fracture("block", make_block(Vec3(1, 2, 3), 0.5), pattern);
  }
  print_fracture("letter", make_letter('R', 0.3, 14), Pattern::planes);
  print_grid_cuts();
  print_repair();
  print_simulation();
}
