// The graph's benchmark: its case, and the parts that are measured.
#pragma once

#include "bench.h"
#include "kerf/mesh.h"
#include "kerf/nodes.h"

namespace bench {

/// A ribbed ball of about 9,600 triangles with a thin slit down to its axis, concave at every
/// scale, and jittered nodes inside it in Morton order: about 53 of them within a support radius.
struct GraphCase {
  geo::TriangleMesh surface;
  geo::NodeSet nodes;
  double spacing = 0;  ///< of the grid before jitter, model units
};
GraphCase make_graph_case(std::size_t nodes);

/// Each part prints its table unless `options.json`, and adds its figures.
void measure_nearest(const GraphCase& c, const Options& options, Figures& figures);
void measure_visibility(const GraphCase& c, const Options& options, Figures& figures);
void measure_rows(const GraphCase& c, const Options& options, Figures& figures);
void measure_update(const GraphCase& c, const Options& options, Figures& figures);

}  // namespace bench
