// Reads a model with faults, repairs and refines it, and checks that the result is a solid.
#include <cstdio>
#include <fstream>

#include <kerf/check.h>
#include <kerf/files.h>
#include <kerf/mesh.h>
#include <kerf/repair.h>

int main() {
  {
    geo::TriangleMesh broken = geo::make_block({2, 1, 1}, 0.5);
    broken.triangles.pop_back();                                          // a hole
    std::swap(broken.triangles.front()[1], broken.triangles.front()[2]);  // a reversed triangle
    std::ofstream out("broken.ply", std::ios::binary);
    geo::write_ply(out, broken);
  }
  geo::TriangleMesh mesh = geo::read_surface("broken.ply").mesh;
  std::printf("%s\n", geo::check_surface(mesh, geo::SelfIntersections::find).first_problem.c_str());

  const geo::RepairStats stats = geo::repair(mesh);
  std::printf("%zu holes filled, %zu triangles reversed\n", stats.filled_holes, stats.flipped_triangles);
  mesh = geo::refined(mesh, 0.25);
  geo::require_solid(mesh);  // throws geo::InputError where the mesh is no solid
  std::printf("%zu triangles, volume %.6f\n", mesh.triangles.size(), geo::signed_volume(mesh));
  return stats.filled_holes == 1 ? 0 : 1;
}
