// rounded_solid() of kerf/repair.h. Snap rounding in rounds: vertices are rounded, triangles that
// then cross are divided where they meet, and the new vertices are rounded.
//
// New vertices may round to where their triangles cross again. Vertices of such triangles go to a
// grid that is twice as coarse in each round, so that what is thinner than the grid closes.
#include <cmath>

#include "base/single_precision.h"
#include "kerf/check.h"
#include "kerf/error.h"
#include "kerf/repair.h"
#include "surface/crossing_triangles.h"

namespace geo {
namespace {

// The last grid has cells of 2⁻¹³ of the largest coordinate: coarser would be seen.
constexpr int max_rounds = 10;
constexpr int float_digits = 24;  // binary digits of a float

void round_to_floats(TriangleMesh& mesh) {
  for (Vec3& p : mesh.vertices)
    for (double& x : p) x = to_single(x);
}

// The distance of floats at the largest coordinate.
double spacing_of_floats(const TriangleMesh& mesh) {
  double largest = 0;
  for (const Vec3& p : mesh.vertices) largest = std::max(largest, p.cwiseAbs().maxCoeff());
  return largest > 0 ? std::exp2(std::ilogb(largest) + 1 - float_digits) : 0;
}

// Moves the vertices of triangles that cross, or have no area, to multiples of `cell`.
void coarsen(TriangleMesh& mesh, double cell) {
  const auto move = [&](std::uint32_t triangle) {
    for (const auto v : mesh.triangles[triangle])
      mesh.vertices[v] = (mesh.vertices[v] / cell).array().round().matrix() * cell;
  };
  std::vector<std::uint32_t> faulty;
  for (const auto& [i, j] : crossing_triangles(mesh)) faulty.insert(faulty.end(), {i, j});
  for (const auto t : faulty) move(t);
}

}  // namespace

TriangleMesh rounded_solid(const TriangleMesh& solid, RoundingStats* stats) {
  RoundingStats done;
  TriangleMesh mesh = solid;
  round_to_floats(mesh);
  const double spacing = spacing_of_floats(mesh);
  for (;; ++done.rounds) {
    repair(mesh);           // vertices that are one now, triangles that have no area
    round_to_floats(mesh);  // a hole that these leave may be filled with new vertices
    const SurfaceReport report = check_surface(mesh, SelfIntersections::find);
    if (done.rounds == 0) done.crossings = report.self_intersections.value_or(0);
    if (report.good()) break;
    if (done.rounds == max_rounds) throw GeometryError("is no solid in single precision: " + report.first_problem);
    if (done.rounds > 0) coarsen(mesh, std::ldexp(spacing, done.rounds));
    mesh = self_union(mesh);
    mesh.source.clear();
    round_to_floats(mesh);
  }
  if (stats) *stats = done;
  return mesh;
}

}  // namespace geo
