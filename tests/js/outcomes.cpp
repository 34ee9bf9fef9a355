// Prints hashes of scores, cracks, pieces, hulls and progressive cuts, and energies of a run. Built
// natively and for WebAssembly, it must print the same lines (tests/js/run).
//   outcomes break MODEL...       three patterns each
//   outcomes cut COUNT MODEL...   progressive cuts of these in turn
//   outcomes run SCENE FRAMES     energies and crossings of each frame, with portable vectors
#include <cinttypes>
#include <cstdio>
#include <cstdlib>
#include <string>

#include <kerf/kerf.h>
#include "base/random.h"

using namespace geo;

namespace {

std::uint64_t hash_of(const TriangleMesh& mesh) {
  std::string bytes(reinterpret_cast<const char*>(mesh.vertices.data()), mesh.vertices.size() * sizeof(Vec3));
  bytes.append(reinterpret_cast<const char*>(mesh.triangles.data()), mesh.triangles.size() * sizeof(Triangle));
  return fingerprint(bytes);
}

template <class Meshes>
std::uint64_t hash_of_all(const Meshes& meshes) {
  std::string bytes;
  for (const TriangleMesh& mesh : meshes) {
    const std::uint64_t hash = hash_of(mesh);
    bytes.append(reinterpret_cast<const char*>(&hash), sizeof hash);
  }
  return fingerprint(bytes);
}

void print_pieces(const Complex& complex, const TriangleMesh& original, bool with_hulls) {
  const Pieces pieces = find_pieces(complex);
  const auto chunks = make_chunks(complex, pieces, original, 1);
  std::vector<TriangleMesh> meshes, hulls;
  for (const Chunk& chunk : chunks) {
    meshes.push_back(chunk.mesh);
    if (!with_hulls) continue;
    for (TriangleMesh& hull : convex_decomposition(chunk.mesh, 8, 64)) hulls.push_back(std::move(hull));
  }
  std::printf(" surface %016" PRIx64 " pieces %u %016" PRIx64, hash_of(complex.two_sided()), pieces.count,
              hash_of_all(meshes));
  if (with_hulls) std::printf(" hulls %zu %016" PRIx64, hulls.size(), hash_of_all(hulls));
  std::printf("\n");
  std::fflush(stdout);
}

void print_broken(const std::string& name) {
  const TriangleMesh solid = read_surface(name).mesh;
  require_solid(solid);
  ScoreOptions options[3];
  options[0].pattern.pattern = Pattern::voronoi;
  options[0].jagged.amplitude = 0.02;
  options[1].pattern.pattern = Pattern::glass;
  options[2].pattern.pattern = Pattern::wood;
  for (ScoreOptions& o : options) {
    o.pieces = 8;
    o.attempts = 6;
    o.pattern.seed = o.jagged.seed = 7;
    Complex complex = Complex::from_skin(solid);
    std::printf("%s %s", name.substr(name.rfind('/') + 1).c_str(),
                std::string(pattern_names[std::size_t(o.pattern.pattern)]).c_str());
    try {
      const Score score = make_score(complex, o);
      std::printf(" score %016" PRIx64, hash_of(score.sheet));
      insert_sheet(complex, score.sheet, 1);
      print_pieces(complex, solid, true);
    } catch (const GeometryError& error) {
      std::printf(" %s\n", error.what());
    }
  }
}

// A wavy front sweeps through a model; it turns on its way, and may end in the material.
void print_cut(int number, const std::string& name) {
  Random random(static_cast<std::uint64_t>(number) + 1);
  const TriangleMesh solid = read_surface(name).mesh;
  Complex complex = Complex::from_skin(solid);
  const Vec3 middle = complex.extent().center();
  const double size = complex.extent().diagonal();
  const Vec3 across = random.direction(), way = across.cross(random.direction()).normalized(), up = across.cross(way);
  const int steps = 12, points = 9;
  const double reach = random.uniform(-0.1, 0.7), bend = random.uniform(-0.2, 0.2), phase = random.uniform(0, 6);
  FrontState front;
  for (int s = 0; s <= steps; ++s) {
    const double along = -0.7 + (0.7 + reach) * s / steps;
    std::vector<Vec3> at;
    for (int p = 0; p < points; ++p) {
      const double aside = -0.7 + 1.4 * p / (points - 1), wave = 0.03 * aside * (aside + phase) * (1 + along);
      at.push_back(middle + size * (aside * across + along * way + (wave + bend * along * along) * up));
    }
    if (s == 0)
      front = begin_front(at, false, 1);
    else
      advance(complex, front, at);
  }
  std::printf("cut %d", number);
  print_pieces(complex, solid, false);
}

void print_run(const std::string& path, int frames) {
  set_vectors(Vectors::portable);
  Scene scene = read_scene(path);
  scene.frames = frames;
  CrossingCounter crossings;
  simulate(scene, [&](const Simulation& run, const FrameStats& frame) {
    std::printf("frame %d crossings %zu elastic %.17g kinetic %.17g\n", run.state().frame,
                crossings.count(run.surface()), frame.energy, frame.kinetic);
    std::fflush(stdout);
    return true;
  });
}

}  // namespace

int main(int argc, char** argv) {
  const std::string job = argc > 1 ? argv[1] : "";
  try {
    if (job == "break")
      for (int i = 2; i < argc; ++i) print_broken(argv[i]);
    else if (job == "cut" && argc > 3)
      for (int i = 0; i < std::atoi(argv[2]); ++i) print_cut(i, argv[3 + i % (argc - 3)]);
    else if (job == "run" && argc == 4)
      print_run(argv[2], std::atoi(argv[3]));
    else
      return 2;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "outcomes: %s\n", error.what());
    return 1;
  }
}
