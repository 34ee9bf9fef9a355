// The Brazilian test: a disk pressed between two plates breaks along the diameter between them.
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "kerf/files.h"
#include "kerf/simulation.h"
#include "mechanics/disk.h"

using namespace geo;

TEST_CASE("the first crack of a pressed disk runs along the loaded diameter, at the load that its strength asks for",
          "[fracture]") {
  const double strength = 2e4, thickness = 0.2;
  // Cracks begin where theory has the disk pulled, away from the plates.
  const Scene scene = parse_scene(
      "gravity = [0, 0, 0]\n[body]\nmesh = 'a'\nspacing = 0.05\nlevels = 1\n[material]\nyoung = 2e6\ndensity = "
      "1000\ndamping = 30\n"
      "[fracture]\nstrength = 2e4\nvariation = 0\ncracks = 1\noff = [[-1, -1, -1, 2, 2, 0.2], [-1, -1, 0.8, 2, 2, 2]]\n"
      "[time]\nframes = 60\nframe_rate = 60\nstep = 0.00417\n[[obstacle]]\nname = 'below'\nnormal = [0, 0, "
      "1]\nstiffness = 1e7\nfriction = 0\n"
      "[[obstacle]]\nname = 'above'\nnormal = [0, 0, -1]\nposition = [0, 0, 1]\nstiffness = 1e7\nfriction = 0\nkeys = "
      "[[0, 0, 0, 0, 0, 0, 1, 0], [1, 0, 0, -0.08, 0, 0, 1, 0]]\n",
      "s.toml");
  Simulation sim(scene, make_disk(thickness, 0.05));
  double force = 0;
  std::size_t begun = 0;
  for (int i = 0; i < 60 && begun == 0; ++i) {
    const FrameStats work = sim.advance_frame();
    begun += work.fracture.begun;
    if (begun == 0) force = work.obstacle_force.at(1).z();
  }
  REQUIRE(begun == 1);
  CHECK(2 * force / (std::numbers::pi * thickness) == Approx(strength).epsilon(0.15));
  for (int i = 0; i < 14; ++i) sim.advance_frame();  // it may wait for a little more load
  const Complex& k = sim.body().surface;
  Vec3 normal = Vec3::Zero(), middle = Vec3::Zero();
  double area = 0;
  Box3 box;
  for (std::uint32_t f = 0; f < k.face_count(); ++f) {
    const FaceId id(f);
    if (!k.has({id, 0}) || k.face(id).crack == 0) continue;
    const auto c = k.corners(id);
    Vec3 n = 0.5 * (c[1] - c[0]).cross(c[2] - c[0]);
    if (n.x() < 0) n = -n;
    normal += n;
    area += n.norm();
    middle += n.norm() * (c[0] + c[1] + c[2]) / 3;
    for (const Vec3& p : c) box.add(p);
  }
  REQUIRE(area > 0);
  CHECK(normal.x() > 0.97 * normal.norm());
  CHECK(middle.x() / area == Approx(0.5).margin(0.1));
  CHECK(box.hi.z() - box.lo.z() > 0.4);
}
