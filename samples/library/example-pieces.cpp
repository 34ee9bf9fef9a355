// Cuts a pumpkin in two by a front that sweeps through it, and measures the halves.
#include <cstdio>
#include <vector>

#include <kerf/crack.h>
#include <kerf/mesh.h>
#include <kerf/pieces.h>

int main() {
  geo::Complex complex = geo::Complex::from_skin(geo::make_pumpkin(12));

  // The front: a line of three points, first above the pumpkin, at the end below it.
  std::vector<geo::Vec3> line = {{-2, 0.1, 1.5}, {0, -0.1, 1.5}, {2, 0.1, 1.5}};
  geo::FrontState front = geo::begin_front(line, false, 1);
  for (int step = 1; step <= 12; ++step) {
    for (geo::Vec3& p : line) p.z() -= 0.25;
    const geo::CrackDelta delta = geo::advance(complex, front, line);
    std::printf("step %2d: %zu faces removed, %zu new, %zu of them on the crack\n", step, delta.removed_faces.size(),
                delta.new_faces.size(), delta.new_crack_faces.size());
  }

  const geo::Pieces pieces = geo::find_pieces(complex);
  for (std::uint32_t i = 0; i < pieces.count; ++i) {
    const geo::TriangleMesh mesh = geo::piece_mesh(complex, pieces, i);
    std::printf("piece %u: volume %.6f, %zu triangles\n", i, pieces.volume[i], mesh.triangles.size());
  }
  return pieces.count == 2 ? 0 : 1;
}
