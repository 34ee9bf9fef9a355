// The visibility graph beside what other libraries offer for its parts (§ 6).
#include "graph.h"

#include <cstdio>

namespace bench {

int graph(const Options& options) {
  for (const std::size_t count : options.nodes) {
    const GraphCase c = make_graph_case(count);
    Figures figures{{"nodes", double(c.nodes.size())}, {"triangles", double(c.surface.triangles.size())}};
    if (!options.json) std::printf("%zu nodes, spacing %.4g, in %zu triangles\n", c.nodes.size(), c.spacing, c.surface.triangles.size());
    measure_nearest(c, options, figures);
    measure_visibility(c, options, figures);
    measure_rows(c, options, figures);
    measure_update(c, options, figures);
    print(figures, options.json);
  }
  return 0;
}

}  // namespace bench
