// Rows of neighbours beside Boost's Dijkstra and our own modified Floyd-Warshall (§ 6.2).
#include <boost/graph/compressed_sparse_row_graph.hpp>
#include <boost/graph/dijkstra_shortest_paths.hpp>
#include <cstdio>

#include "geometry/bvh.h"
#include "graph.h"
#include "graph/build_graph.h"
#include "graph/graph_storage.h"
#include "graph/reference_neighborhoods.h"
#include "kerf/graph.h"
#include "kerf/parallel.h"

namespace bench {
namespace {

using geo::NodeId;
using Peer = boost::compressed_sparse_row_graph<boost::directedS, boost::no_property,
                                                boost::property<boost::edge_weight_t, std::uint32_t>,
                                                boost::no_property, std::uint32_t, std::uint32_t>;

struct Stop {};

// Ends the search at the support radius, and remembers what it has met.
struct Bounded : boost::default_dijkstra_visitor {
  std::vector<std::uint32_t>* touched;
  const std::uint32_t* distance;
  void discover_vertex(std::uint32_t v, const Peer&) { touched->push_back(v); }
  void examine_vertex(std::uint32_t v, const Peer&) {
    if (distance[v] >= geo::unit_radius) throw Stop();
  }
};

// CPU seconds a pair of Boost's Dijkstra from some of the nodes, maps kept from one to the next.
// Its function of that name fills a map of the heap's places with zeros for each source; `own_heap`
// keeps that map as well, and calls what the function calls.
double boost_seconds(const Peer& graph, std::size_t nodes, bool own_heap) {
  const auto index = boost::get(boost::vertex_index, graph);
  const auto weight = boost::get(boost::edge_weight, graph);
  std::vector<std::uint32_t> distances(nodes, ~0u), touched;
  std::vector<boost::default_color_type> colors(nodes, boost::white_color);
  std::vector<std::size_t> places(nodes, ~std::size_t(0));
  const auto distance = boost::make_iterator_property_map(distances.begin(), index);
  const auto color = boost::make_iterator_property_map(colors.begin(), index);
  const auto place = boost::make_iterator_property_map(places.begin(), index);
  Bounded visitor;
  visitor.touched = &touched;
  visitor.distance = distances.data();
  const std::size_t sources = std::min<std::size_t>(nodes, 20000);
  std::size_t pairs = 0;
  const double seconds = least(
      [&] { pairs = 0; },
      [&] {
        for (std::size_t q = 0; q < sources; ++q) {
          // Runs of neighbouring nodes, as in a whole pass.
          const auto source = static_cast<std::uint32_t>(q / 1000 * (nodes / ((sources + 999) / 1000)) + q % 1000);
          touched.assign(1, source);
          distances[source] = 0;
          try {
            if (own_heap) {
              using Heap = boost::d_ary_heap_indirect<std::uint32_t, 4, decltype(place), decltype(distance),
                                                      std::less<std::uint32_t>>;
              Heap heap(distance, place, std::less<std::uint32_t>());
              boost::detail::dijkstra_bfs_visitor<Bounded, Heap, decltype(weight), boost::dummy_property_map,
                                                  decltype(distance), std::plus<std::uint32_t>,
                                                  std::less<std::uint32_t>>
                  steps(visitor, heap, weight, boost::dummy_property_map(), distance, std::plus<std::uint32_t>(),
                        std::less<std::uint32_t>(), 0u);
              boost::breadth_first_visit(graph, &source, &source + 1, heap, steps, color);
            } else {
              boost::dijkstra_shortest_paths_no_init(graph, source, boost::dummy_property_map(), distance, weight,
                                                     index, std::less<std::uint32_t>(), std::plus<std::uint32_t>(), 0u,
                                                     visitor, color);
            }
          } catch (const Stop&) {
          }
          for (const auto v : touched) {
            pairs += v != source && distances[v] < geo::unit_radius;
            distances[v] = ~0u;
            colors[v] = boost::white_color;
          }
        }
      },
      3);
  return seconds / double(pairs);
}

}  // namespace

void measure_rows(const GraphCase& c, const Options& options, Figures& figures) {
  const int before = geo::threads();
  geo::set_threads(1);
  const geo::TriangleBvh surface(geo::corners_of(c.surface)), nothing;
  const std::size_t n = c.nodes.size();
  const geo::VisibilityGraph edges = geo::build_visibility_graph(c.nodes, surface, 26);
  geo::VisibilityGraph graph;
  const auto reset = [&] { graph = edges; };
  const auto build = [&](const geo::TriangleBvh& obstacles) {
    return least(
        reset, [&] { geo::build_neighborhoods(c.nodes, graph, obstacles); }, 7);
  };

  // All methods ask the same question, who sees whom, of pairs without an edge: the search is
  // compared without it.
  const double seen = build(surface);
  std::size_t pairs = 0;
  for (std::size_t i = 0; i < n; ++i) pairs += graph.neighbor_count(NodeId(i));
  const double bytes = double(graph.bytes()) / double(n);
  const double rows = build(nothing);
  const double per_pair = 1e9 / double(pairs);

  std::vector<std::pair<std::uint32_t, std::uint32_t>> ends;
  std::vector<std::uint32_t> lengths;
  for (std::uint32_t i = 0; i < n; ++i)
    for (const NodeId j : edges.edges(NodeId(i))) {
      ends.push_back({i, j.value});
      lengths.push_back(geo::warped_length(c.nodes, i, j.index()));
    }
  const Peer peer(boost::edges_are_sorted, ends.begin(), ends.end(), lengths.begin(), static_cast<std::uint32_t>(n));
  const double boost = boost_seconds(peer, n, false), boost_own = boost_seconds(peer, n, true);
  double mfw = 0;
  if (n <= 200000) {
    // As ours from the graph, which keeps no lengths; but to rows that are not packed and put away
    // yet.
    mfw = least([] {}, [&] { geo::modified_floyd_warshall(geo::edge_lengths(c.nodes, geo::GraphStorage::of(edges))); },
                3);
  }

  const double speedup = threads_speedup([&] { geo::build_neighborhoods(c.nodes, graph, nothing); }, reset);
  geo::set_threads(before);

  figures["pairs_per_node"] = double(pairs) / double(n);
  figures["rows_ns_per_pair"] = rows * per_pair;
  figures["rows_seen_ns_per_pair"] = seen * per_pair;
  figures["rows_vs_boost"] = boost * double(pairs) / rows;
  figures["rows_vs_boost_own_heap"] = boost_own * double(pairs) / rows;
  if (mfw > 0) figures["rows_vs_mfw"] = mfw / rows;
  figures["rows_threads_speedup"] = speedup;
  figures["rows_bytes_per_node"] = bytes;
  figures["bytes_per_node"] = bytes + double(sizeof(geo::Vec3) + 3 * sizeof(double));
  if (options.json) return;
  std::printf("  rows of neighbours, %.1f a node, %.0f bytes a node\n", figures["pairs_per_node"], bytes);
  std::printf("    %-44s %8.1f ns a pair\n", "ours", rows * per_pair);
  std::printf("    %-44s %8.1f\n", "ours, and which pairs see each other", seen * per_pair);
  std::printf("    %-44s %8.1f\n", "Boost, dijkstra_shortest_paths_no_init", boost * 1e9);
  std::printf("    %-44s %8.1f\n", "Boost, its parts with a heap of our own", boost_own * 1e9);
  if (mfw > 0) std::printf("    %-44s %8.1f\n", "modified Floyd-Warshall", mfw * per_pair);
  std::printf("    two threads: %.2f times as fast\n", figures["rows_threads_speedup"]);
}

}  // namespace bench
