// VisibilityGraph of kerf/graph.h. The public face of the graph: everything forwards to
// GraphStorage.
#include <algorithm>

#include "graph/graph_storage.h"
#include "kerf/graph.h"

namespace geo {

bool operator==(const AdjacencyRow& a, const AdjacencyRow& b) {
  const auto equal = [](const auto& x, const auto& y) { return std::equal(x.begin(), x.end(), y.begin(), y.end()); };
  return equal(a.to, b.to) && equal(a.bits, b.bits) && equal(a.paths, b.paths);
}

VisibilityGraph::VisibilityGraph() : storage_(Indirect<GraphStorage>::of({})) {}

std::size_t VisibilityGraph::node_count() const { return storage_->node_count(); }
std::size_t VisibilityGraph::edge_count() const { return storage_->edge_count(); }
std::size_t VisibilityGraph::guide_count() const { return storage_->guides().size(); }
VisibilityGraph::Edges VisibilityGraph::edges(NodeId i) const { return storage_->edges(i); }
VisibilityGraph::Neighbors VisibilityGraph::neighbors(const NodeSet& nodes, NodeId i) const {
  return storage_->neighbors(nodes, i);
}
std::size_t VisibilityGraph::neighbor_count(NodeId i) const {
  const auto row = storage_->entries(i.value);
  return static_cast<std::size_t>(std::count_if(row.bits.begin(), row.bits.end(), AdjacencyRow::is_neighbor));
}
bool VisibilityGraph::has_edge(NodeId i, NodeId j) const { return storage_->has(i.value, j.value); }
AdjacencyRow VisibilityGraph::row(NodeId i) const { return storage_->rows().row(i.index()); }
std::uint32_t VisibilityGraph::components(std::vector<std::uint32_t>& component) const {
  return storage_->components(component);
}
std::size_t VisibilityGraph::bytes() const { return storage_->bytes(); }

bool operator==(const VisibilityGraph& a, const VisibilityGraph& b) {
  return GraphStorage::of(a).equals(GraphStorage::of(b));
}

namespace {

// Rows of a relation, concatenated. `add_row` appends the indices and distances of one node.
template <class AddRow>
CsrArrays csr_arrays(std::size_t nodes, const AddRow& add_row) {
  CsrArrays arrays;
  arrays.indptr.push_back(0);
  for (std::size_t i = 0; i < nodes; ++i) {
    add_row(NodeId(i), arrays);
    arrays.indptr.push_back(arrays.indices.size());
  }
  return arrays;
}

}  // namespace

CsrArrays edge_arrays(const NodeSet& nodes, const VisibilityGraph& graph) {
  return csr_arrays(graph.node_count(), [&](NodeId i, CsrArrays& out) {
    for (const NodeId j : graph.edges(i)) {
      out.indices.push_back(j.value);
      out.distances.push_back(
          static_cast<float>(std::sqrt(squared_distance(nodes.position[i.index()], nodes.position[j.index()]))));
    }
  });
}

CsrArrays neighbor_arrays(const NodeSet& nodes, const VisibilityGraph& graph) {
  return csr_arrays(graph.node_count(), [&](NodeId i, CsrArrays& out) {
    for (const Neighbor& n : graph.neighbors(nodes, i)) {
      out.indices.push_back(n.to.value);
      out.distances.push_back(n.distance);
    }
  });
}

}  // namespace geo
