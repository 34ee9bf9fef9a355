// The main jobs in one call each: repairs, breaks and cuts a model, and simulates a scene.
#include <cstdio>
#include <fstream>

#include <kerf/files.h>
#include <kerf/jobs.h>
#include <kerf/mesh.h>
#include <kerf/repair.h>

int main() {
  {
    std::ofstream file("pumpkin.obj");
    geo::write_obj(file, geo::make_pumpkin(8));
  }
  const geo::TriangleMesh model = geo::repaired_solid(geo::read_surface("pumpkin.obj").mesh);

  const geo::PieceSet pieces = geo::fracture(model, {.pieces = 8});
  geo::save("pieces.glb", pieces);

  const geo::Front knife{.steps = {{{-2, 0.1, 2}, {2, 0.1, 2}}, {{-2, 0.1, -2}, {2, -0.1, -2}}}};
  const geo::PieceSet halves = geo::cut(model, knife);

  geo::TriangleMesh sheet;
  sheet.vertices = {{-2, -2, 0.1}, {2, -2, 0.1}, {2, 2, 0.1}, {-2, 2, 0.1}};
  sheet.triangles = {{0, 1, 2}, {0, 2, 3}};
  const geo::PieceSet layers = geo::cut(model, sheet);

  {
    std::ofstream file("fall.toml");
    file << "[[body]]\nmesh = \"pumpkin.obj\"\nspacing = 0.4\n[time]\nframes = 3\n";
  }
  const auto tell = [](const geo::Simulation& run, const geo::FrameStats& frame) {
    std::printf("frame %d: elastic energy %.3g J\n", run.state().frame, frame.energy);
    return true;  // false ends the run
  };
  const geo::Simulation run = geo::simulate(geo::read_scene("fall.toml"), tell);

  std::printf("%zu pieces, %zu halves, %zu layers, %zu triangles after %d frames\n", pieces.chunks.size(),
              halves.chunks.size(), layers.chunks.size(), run.surface().triangles.size(), run.state().frame);
  return pieces.chunks.size() == 8 && halves.chunks.size() == 2 && layers.chunks.size() == 2 ? 0 : 1;
}
