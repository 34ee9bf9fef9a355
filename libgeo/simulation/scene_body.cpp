// Each model is sampled on its own, then one Body is built of all nodes and skins. Equal materials
// share an entry of the table.
#include "simulation/scene_body.h"

#include <algorithm>

namespace geo {
namespace {

template <class T>
void append(std::vector<T>& to, const std::vector<T>& from) {
  to.insert(to.end(), from.begin(), from.end());
}

}  // namespace

Body build_scene_body(const Scene& scene, const PlacedModels& models, std::vector<std::uint32_t>& body_index,
                      const Progress& progress) {
  NodeSet nodes;
  body_index.clear();
  for (std::size_t b = 0; b < models.bodies.size(); ++b) {
    SampleOptions sampling = scene.bodies[b].sampling;
    sampling.seed = scene.seed;
    if (sampling.spacing <= 0 && sampling.count == 0)
      sampling.spacing = scene.bodies[b].spacing_percent / 100 * bounding_box(models.bodies[b]).diagonal();
    const NodeSet own = sample_nodes(models.bodies[b], sampling, progress);
    append(nodes.position, own.position);
    append(nodes.radius, own.radius);
    append(nodes.spacing, own.spacing);
    append(nodes.volume, own.volume);
    body_index.resize(nodes.size(), static_cast<std::uint32_t>(b));
  }
  const BodyOptions options{.k = scene.k, .method = NeighborMethod::automatic};
  std::vector<NodeId> donors;
  Body body = build_body(Complex::from_skin(models.all), std::move(nodes), options, progress, &donors);
  // A node inserted in a narrow passage belongs to the body of its donor.
  for (const NodeId d : donors) body_index.push_back(std::uint32_t(body_index[d.index()]));
  body_index.resize(body.nodes.size(), 0);
  return body;
}

Materials materials_of(const Scene& scene, const std::vector<std::uint32_t>& body_index) {
  std::vector<Material> table;
  std::vector<std::uint16_t> of_body, of_node;
  for (const SceneBody& body : scene.bodies) {
    const Material& own = body.material ? *body.material : scene.material;
    const auto at = std::find(table.begin(), table.end(), own);
    of_body.push_back(static_cast<std::uint16_t>(at - table.begin()));
    if (at == table.end()) table.push_back(own);
  }
  for (const auto b : body_index) of_node.push_back(of_body[b]);
  return {std::move(table), std::move(of_node)};
}

}  // namespace geo
