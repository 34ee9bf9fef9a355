// Weights fall from 1 at a node to 0 at its support radius.
#include "live/surface_stress.h"

#include <utility>

namespace live {

void SurfaceStress::find_weights(const geo::Body& body, const SurfaceView& view) {
  const std::uint32_t slots = view.topology().vertices;
  std::vector<geo::SurfaceVertexId> vertex(slots);
  for (std::uint32_t v = 0; v < body.surface.surface_vertex_count(); ++v)
    if (const auto slot = view.slot_of(geo::SurfaceVertexId(v))) vertex[*slot] = geo::SurfaceVertexId(v);
  first_.assign(1, 0);
  node_.clear();
  weight_.clear();
  std::vector<std::pair<geo::NodeId, double>> carriers;
  for (const geo::SurfaceVertexId v : vertex) {
    carriers.clear();
    if (v.valid()) geo::carrier_nodes(body, v, carriers);
    double sum = 0;
    for (const auto& [node, distance] : carriers) {
      const double near = 1 - distance / body.nodes.radius[node.index()];
      node_.push_back(node.value);
      weight_.push_back(near * near);
      sum += near * near;
    }
    for (std::size_t i = first_.back(); i < weight_.size(); ++i) weight_[i] = sum > 0 ? weight_[i] / sum : 0;
    first_.push_back(static_cast<std::uint32_t>(node_.size()));
  }
  revision_ = view.topology().revision;
}

std::vector<double> SurfaceStress::at_vertices(const geo::Simulation& run, const std::vector<double>& stress,
                                               const SurfaceView& view) {
  if (revision_ != view.topology().revision) find_weights(run.body(), view);
  std::vector<double> result(first_.size() - 1, 0);
  for (std::size_t v = 0; v < result.size(); ++v)
    for (std::size_t i = first_[v]; i < first_[v + 1]; ++i) result[v] += weight_[i] * stress[node_[i]];
  return result;
}

}  // namespace live
