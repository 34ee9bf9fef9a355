// Cuts a body with nodes and a visibility graph: nodes on opposite sides are no longer neighbours.
#include <algorithm>
#include <cstdio>
#include <vector>

#include <kerf/body.h>
#include <kerf/mesh.h>
#include <kerf/nodes.h>

int main() {
  const geo::TriangleMesh solid = geo::make_pumpkin(12);
  const geo::NodeSet nodes = geo::sample_nodes(solid, {.count = 800});
  geo::Body body = geo::build_body(geo::Complex::from_skin(solid), nodes);

  std::vector<geo::Vec3> line = {{-2, 0.1, 1.5}, {0, -0.1, 1.5}, {2, 0.1, 1.5}};
  geo::FrontState front = geo::begin_front(line, false, 1);
  std::size_t cut = 0, added = 0;
  for (int step = 1; step <= 12; ++step) {
    for (geo::Vec3& p : line) p.z() -= 0.25;
    geo::SplitStats stats;
    const geo::BodyDelta delta = geo::split(body, front, line, {}, &stats);
    cut += stats.edges_cut;
    added += stats.nodes_added;
    for (const auto& ids : delta.detached) std::printf("step %d: %zu nodes detached\n", step, ids.size());
  }

  double nearest = body.nodes.radius[0];
  const geo::NodeId first(0u);
  for (const geo::Neighbor& n : body.graph.neighbors(body.nodes, first))
    nearest = std::min(nearest, double(n.distance));
  std::printf("%zu edges cut, %zu nodes added; node 0 has %zu neighbours, the nearest %.4f away\n", cut, added,
              body.graph.neighbor_count(first), nearest);

  const geo::BodyReport report = geo::check_body(body);
  if (!report.good()) std::fprintf(stderr, "%s\n", report.first_problem.c_str());
  return report.good() && report.pieces == 2 && report.graph_components == 2 ? 0 : 1;
}
