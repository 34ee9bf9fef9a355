// Depths of the trees of slaves: each vertex climbs to an ancestor of known depth, and all vertices
// on the way get their depths. Linear in the number of vertices.
#include "body/incremental_cache.h"

#include "body/binding.h"
#include "body/piece_labels.h"

namespace geo {

Body::Body() : cache(Indirect<IncrementalCache>::of(IncrementalCache())) {}

void prepare_cache(Body& body) {
  IncrementalCache& cache = *body.cache;
  const std::size_t n = body.surface.surface_vertex_count();
  if (cache.piece.size() != n) label_pieces(body);
  if (cache.depth.size() == n) return;
  const Binding& b = body.binding;
  std::vector<std::uint8_t> seen(n, 0);
  for (const auto v : b.closest)
    if (v.valid()) seen[v.index()] = 1;
  cache.depth.assign(n, ~0u);
  cache.unseen_masters.clear();
  std::vector<SurfaceVertexId> ancestors;
  for (std::uint32_t v = 0; v < n; ++v) {
    if (!b.master[v].valid()) continue;
    // Up to a vertex of known depth, then down again.
    SurfaceVertexId at(v);
    for (ancestors.clear(); cache.depth[at.index()] == ~0u && b.parent[at.index()] != at; at = b.parent[at.index()])
      ancestors.push_back(at);
    if (b.parent[at.index()] == at) cache.depth[at.index()] = 0;
    for (; !ancestors.empty(); ancestors.pop_back()) {
      const SurfaceVertexId below = ancestors.back();
      cache.depth[below.index()] = cache.depth[at.index()] + step_from(body.surface, at);
      at = below;
    }
    if (b.parent[v].value == v && !seen[v]) cache.unseen_masters.push_back(SurfaceVertexId(v));
  }
}

}  // namespace geo
