// place_models() and place_obstacles() of kerf/simulation.h. A vertex x of a model stands at pose ·
// (scale · x). Models that stay where they were modelled keep their coordinates bit for bit.
#include <algorithm>

#include "kerf/error.h"
#include "kerf/simulation.h"
#include "simulation/touching_bodies.h"

namespace geo {
namespace {

// Appends vertices and triangles, without attributes.
void append(TriangleMesh& to, const TriangleMesh& from) {
  const auto first = static_cast<std::uint32_t>(to.vertices.size());
  to.vertices.insert(to.vertices.end(), from.vertices.begin(), from.vertices.end());
  for (const Triangle& t : from.triangles) to.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
}

// A square that stands for a plane in pictures, in the coordinates of the obstacle. Its centre is
// the foot of the bodies' centre, its sides are 1.5 diagonals of their box.
TriangleMesh square_of(const SceneObstacle& plane, const Box3& bodies) {
  const Pose placed = plane.pose(0);
  const Vec3 n = plane.normal.normalized(),
             middle = (placed.rotation.conjugate() * (bodies.center() - placed.position)) / plane.scale;
  const Vec3 level = n.cross(Vec3::UnitZ()).norm() > 1e-6 ? n.cross(Vec3::UnitZ()).normalized() : Vec3::UnitX();
  const Vec3 foot = middle - n.dot(middle) * n, a = 0.75 * bodies.diagonal() / plane.scale * level, b = n.cross(a);
  TriangleMesh square;
  square.vertices = {foot - a - b, foot + a - b, foot + a + b, foot - a + b};
  square.triangles = {{0, 1, 2}, {0, 2, 3}};
  return square;
}

bool is_identity(const SceneBody& body) {
  return body.scale == 1 && body.place.position == Vec3::Zero() &&
         body.place.rotation.isApprox(Eigen::Quaterniond::Identity(), 0);
}

}  // namespace

PlacedModels place_models(const Scene& scene, std::vector<TriangleMesh> meshes) {
  if (meshes.size() != scene.bodies.size())
    throw InputError("the scene has " + std::to_string(scene.bodies.size()) + " bodies, but " +
                     std::to_string(meshes.size()) + " models were given");
  PlacedModels models;
  models.bodies = std::move(meshes);
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
    const SceneBody& body = scene.bodies[b];
    if (!is_identity(body))  // else the vertices stay as they are, to the bit
      for (Vec3& p : models.bodies[b].vertices) p = body.place * (body.scale * p);
    if (body.refine > 0) models.bodies[b] = refined(models.bodies[b], body.refine);
  }
  if (models.bodies.size() == 1) {
    models.all = models.bodies[0];
    return models;
  }
  for (const TriangleMesh& body : models.bodies) append(models.all, body);
  part_touching_bodies(scene, models);
  return models;
}

TriangleMesh place_obstacles(const Scene& scene, const PlacedModels& models, double time) {
  TriangleMesh all;
  for (const SceneObstacle& o : scene.obstacles) {
    TriangleMesh mesh = o.mesh.triangles.empty() ? square_of(o, bounding_box(models.all)) : o.mesh;
    for (Vec3& p : mesh.vertices) p = o.pose(time) * (o.scale * p);
    append(all, mesh);
  }
  return all;
}

}  // namespace geo
