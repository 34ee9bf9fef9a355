// Simulates a block that a blade cuts while the program steers the blade; writes a frame and a
// checkpoint.
#include <cstdio>
#include <fstream>

#include <kerf/body_file.h>
#include <kerf/files.h>
#include <kerf/mesh.h>
#include <kerf/pieces.h>
#include <kerf/simulation.h>

int main() {
  geo::Scene scene;
  scene.bodies.resize(1);
  scene.bodies[0].sampling.spacing = 0.2;
  scene.material.young = 2e4;
  scene.gravity = geo::Vec3::Zero();
  scene.dt = 1 / scene.frame_rate;
  scene.grips.push_back({geo::Vec3(-0.01, -0.01, -0.01), geo::Vec3(0.2, 1.01, 1.01)});  // holds one side
  geo::Blade blade;
  blade.points = {{0.52, -0.2, 1.2}, {0.5, 0.5, 1.2}, {0.51, 1.2, 1.2}};
  scene.blades.push_back(blade);

  geo::Simulation simulation(scene, geo::make_block({1, 1, 1}, 0.25));
  geo::FrameStats total;
  for (int frame = 1; frame <= 8; ++frame) {
    geo::Pose pose;  // of the next frame's end; the points above are the blade at the identity
    pose.position.z() = -0.2 * frame;
    simulation.blade(0).drive_to(pose);
    total += simulation.advance_frame();
  }

  const geo::TriangleMesh surface = simulation.surface();
  std::printf("%zu steps of fronts, %zu edges cut, elastic energy %.3g J\n", total.fronts, total.split.edges_cut,
              total.energy);
  std::ofstream frame("frame.ply", std::ios::binary), checkpoint("checkpoint.kerf", std::ios::binary);
  geo::write_ply(frame, surface);
  geo::write_checkpoint(checkpoint, simulation.body(), simulation.state(), 0);
  checkpoint.close();

  geo::Checkpoint saved = geo::read_checkpoint(geo::KerfFile(geo::Input("checkpoint.kerf")));
  const geo::Simulation resumed(scene, std::move(saved.body), std::move(saved.state));
  std::printf("%u pieces at frame %d\n", geo::find_pieces(resumed.body().surface).count, resumed.state().frame);
  return geo::find_pieces(resumed.body().surface).count == 2 ? 0 : 1;
}
