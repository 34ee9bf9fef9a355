// nearest_triangles() of kerf/mesh.h, faces_on_segment() of kerf/complex.h. Nearest triangles come
// from a box tree over the mesh. Faces on a segment are candidates of K's spatial index that pass
// the exact test.
#include "geometry/bvh.h"
#include "geometry/predicates.h"
#include "kerf/complex.h"
#include "kerf/mesh.h"

namespace geo {

std::vector<std::uint32_t> nearest_triangles(const TriangleMesh& mesh, std::span<const Vec3> points) {
  const TriangleBvh tree(corners_of(mesh));
  std::vector<std::uint32_t> nearest;
  nearest.reserve(points.size());
  for (const Vec3& p : points) nearest.push_back(static_cast<std::uint32_t>(tree.closest(p).triangle));
  return nearest;
}

std::vector<FaceId> faces_on_segment(const Complex& complex, const Vec3& p, const Vec3& q) {
  Box3 box;
  box.add(p);
  box.add(q);
  std::vector<FaceId> near;
  complex.faces_near(box, near);
  std::erase_if(near, [&](FaceId f) {
    const auto c = complex.corners(f);
    return !segment_meets_triangle(p, q, c[0], c[1], c[2]);
  });
  return near;
}

}  // namespace geo
