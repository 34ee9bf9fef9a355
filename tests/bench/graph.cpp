// The visibility graph beside what other libraries offer for its parts (§ 6).
#include "graph.h"

#include <cstdio>

namespace bench {
namespace {

// How a step of fixed size, and a build, grow with the number of nodes since the size before.
void add_exponents(const Figures& before, Figures& figures) {
  const auto exponent = [&](const char* name) {
    return growth(before.at(name), figures.at(name), before.at("nodes"), figures.at("nodes"));
  };
  figures["step_exponent"] = exponent("fixed_crack_seconds");
  figures["build_exponent"] = exponent("rebuild_seconds");
}

}  // namespace

int graph(const Options& options) {
  Figures before;
  for (const std::size_t count : options.nodes) {
    const GraphCase c = make_graph_case(count);
    Figures figures{{"nodes", double(c.nodes.size())}, {"triangles", double(c.surface.triangles.size())}};
    if (!options.json)
      std::printf("%zu nodes, spacing %.4g, in %zu triangles\n", c.nodes.size(), c.spacing, c.surface.triangles.size());
    measure_nearest(c, options, figures);
    measure_visibility(c, options, figures);
    measure_rows(c, options, figures);
    measure_update(c, options, figures);
    if (!before.empty() && before.at("nodes") != figures.at("nodes")) {
      add_exponents(before, figures);
      if (!options.json)
        std::printf("  from %.0f nodes on a build grows with an exponent of %.3f, a crack of fixed size with %.3f\n",
                    before.at("nodes"), figures["build_exponent"], figures["step_exponent"]);
    }
    print(figures, options.json);
    before = figures;
  }
  return 0;
}

}  // namespace bench
