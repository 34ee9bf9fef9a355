#include "simulation/model.h"

#include <algorithm>
#include <iterator>

#include "kerf/error.h"

namespace geo {
namespace {

template <class T>
void append(std::vector<T>& to, const std::vector<T>& from) {
  to.insert(to.end(), from.begin(), from.end());
}

// One more mesh, without attributes.
void append(TriangleMesh& to, const TriangleMesh& from) {
  const auto first = static_cast<std::uint32_t>(to.vertices.size());
  append(to.vertices, from.vertices);
  for (const Triangle& t : from.triangles) to.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
}

// Of a plane, in its own coordinates.
TriangleMesh square_of(const SceneObstacle& plane, const Box3& bodies) {
  const Pose placed = plane.pose(0);
  const Vec3 n = plane.normal.normalized(),
             middle = (placed.rotation.conjugate() * (bodies.center() - placed.position)) / plane.scale;
  const Vec3 level = n.cross(Vec3::UnitZ()).norm() > 1e-6 ? n.cross(Vec3::UnitZ()).normalized() : Vec3::UnitX();
  const Vec3 foot = middle - n.dot(middle) * n, a = 0.75 * bodies.diagonal() / plane.scale * level, b = n.cross(a);
  TriangleMesh square;
  square.vertices = {foot - a - b, foot + a - b, foot + a + b, foot - a + b}, square.triangles = {{0, 1, 2}, {0, 2, 3}};
  return square;
}

}  // namespace

Model place_models(const Scene& scene, std::vector<TriangleMesh> meshes) {
  if (meshes.size() != scene.bodies.size())
    throw InputError("the scene has " + std::to_string(scene.bodies.size()) + " bodies, but " +
                     std::to_string(meshes.size()) + " models were given");
  Model model{{}, std::move(meshes)};
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
    const SceneBody& body = scene.bodies[b];
    TriangleMesh& mesh = model.parts[b];
    if (body.scale != 1 || body.place.position != Vec3::Zero() ||
        !body.place.rotation.isApprox(Eigen::Quaterniond::Identity(), 0))
      for (Vec3& p : mesh.vertices) p = body.place * (body.scale * p);
  }
  if (model.parts.size() == 1) {
    model.mesh = model.parts[0];
    return model;
  }
  for (const TriangleMesh& part : model.parts) append(model.mesh, part);
  return model;
}

TriangleMesh place_obstacles(const Scene& scene, const Model& model, double time) {
  TriangleMesh all;
  for (const SceneObstacle& o : scene.obstacles) {
    TriangleMesh mesh = o.mesh.triangles.empty() ? square_of(o, bounding_box(model.mesh)) : o.mesh;
    for (Vec3& p : mesh.vertices) p = o.pose(time) * (o.scale * p);
    append(all, mesh);
  }
  return all;
}

Body build_model(const Scene& scene, const Model& model, std::vector<std::uint32_t>& part, const Progress& progress) {
  NodeSet nodes;
  part.clear();
  for (std::size_t b = 0; b < model.parts.size(); ++b) {
    SampleOptions sampling = scene.bodies[b].sampling;
    sampling.seed = scene.seed;
    if (sampling.spacing <= 0 && sampling.count == 0)
      sampling.spacing = scene.bodies[b].spacing_percent / 100 * bounding_box(model.parts[b]).diagonal();
    const NodeSet own = sample_nodes(model.parts[b], sampling, progress);
    append(nodes.position, own.position), append(nodes.radius, own.radius);
    append(nodes.spacing, own.spacing), append(nodes.volume, own.volume);
    part.resize(nodes.size(), static_cast<std::uint32_t>(b));
  }
  Body body =
      build_body(Complex::from_skin(model.mesh), std::move(nodes), {scene.k, NeighborMethod::automatic}, progress);
  // Nodes put into narrow passages belong to what their donors do.
  for (const NodeId d : body.donors) part.push_back(std::uint32_t(part[d.index()]));
  part.resize(body.nodes.size(), 0);
  return body;
}

Materials materials_of(const Scene& scene, const std::vector<std::uint32_t>& part) {
  std::vector<Material> table;
  std::vector<std::uint16_t> of_body, of_node;
  for (const SceneBody& body : scene.bodies) {
    const Material& own = body.material ? *body.material : scene.material;
    const auto at = std::find(table.begin(), table.end(), own);
    of_body.push_back(static_cast<std::uint16_t>(at - table.begin()));
    if (at == table.end()) table.push_back(own);
  }
  for (const auto p : part) of_node.push_back(of_body[p]);
  return {std::move(table), std::move(of_node)};
}

}  // namespace geo
