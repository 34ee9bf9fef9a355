// A body: surface complex, nodes, graph, neighbourhoods and binding, always in step with each
// other.
#pragma once

#include <cstdint>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "kerf/complex.h"
#include "kerf/crack.h"
#include "kerf/graph.h"
#include "kerf/nodes.h"
#include "kerf/progress.h"
#include "sampling/node_grid.h"

namespace geo {

/// Which nodes carry each surface vertex (§ 6.5). Indexed by SurfaceVertexId; dead vertices have
/// empty entries. A crumb that has no room for a node is rigid debris, carried by the nearest one.
struct Binding {
  std::vector<NodeId> master_node;       ///< of masters: the node with the visibility edge; else invalid
  std::vector<SurfaceVertexId> master;   ///< the master whose tree a vertex hangs in; invalid: orphan
  std::vector<SurfaceVertexId> parent;   ///< towards the master; itself for a master
  std::vector<SurfaceVertexId> closest;  ///< per node: its closest visible surface vertex, where it is near one
  friend bool operator==(const Binding&, const Binding&) = default;
};

/// What a split keeps for the next one, so that it need not look at the whole body; derived by the
/// first split.
struct Upkeep {
  std::vector<std::int32_t> piece;  ///< per surface vertex: a number for its piece of material, −1: dead
  std::int32_t pieces = 0;          ///< how many numbers there are
  std::set<std::int32_t>
      bare;                   ///< pieces without a node, as far as known: crumbs in which doubles have no room for one
  bool inner_shells = false;  ///< a piece may be bounded by several shells: cavities, cracks inside
  std::vector<std::uint32_t> depth;     ///< per surface vertex: edges to its master; ~0u: orphan
  std::vector<SurfaceVertexId> strays;  ///< masters of shells that no node looks at, ascending
};

/// Where a file came from: printed by kerf-info, written into every body.
struct Provenance {
  std::string tool, version, arguments;
  std::vector<std::string> inputs;  ///< "name xxh3:…"
};

struct Body {
  Complex surface;
  NodeSet nodes;
  VisibilityGraph graph;  ///< and the neighbours of each node
  Binding binding;
  std::vector<NodeId> donors;  ///< of the nodes inserted last, in order; derived, never in a file
  NodeGrid grid;               ///< over nodes.position; derived, never in a file
  Upkeep upkeep;               ///< derived, never in a file
  int k = 26;                  ///< nearest neighbours per node in the graph
  double guides = 0;           ///< of guides along concave edges (§ 8), in spacings of the nodes; 0: none
  double resample_limit = 1;   ///< 0: cracks get no new nodes
  std::uint32_t sampled = 0;   ///< nodes that it was built of: the first rows
  double finest = 0,
         widest =
             0;  ///< their smallest spacing and largest support radius: cracks get no finer nodes, and no wider ones
  std::uint32_t updates = 0;         ///< cracks steps applied since the build
  std::vector<std::uint8_t> debris;  ///< per node: 1 where its neighbours do not span space (nodes.h): rigid debris
  std::vector<Provenance> history;
};

struct BodyOptions {
  int k = 26;
  NeighborMethod method = NeighborMethod::automatic;
  double guides = 0;  ///< along concave edges and crack fronts: how far apart, in spacings of the nodes; 0: none (§ 8)
};

/// Builds graph, neighbourhoods and binding (§ 6.1, 6.2, 6.5). Passages too narrow for the sampling
/// (more components in G than pieces of material) get extra nodes until components and pieces
/// agree. Throws InputError when a node is outside the material or a piece has no node.
Body build_body(Complex surface, NodeSet nodes, const BodyOptions& options = {}, const Progress& progress = {});

/// From scratch on the same complex, nodes and edges' end points: what incremental updates must
/// equal, bit for bit.
Binding build_binding(const Body& body);

/// Counts and seconds of one split, by phase.
struct SplitWork {
  CrackStats crack;
  std::size_t edges_cut = 0, edges_added = 0, nodes_updated = 0, nodes_added = 0, nodes_moved = 0, orphans = 0;
  std::size_t nodes_mended =
      0;  ///< of those added, the last: in pieces without a node and passages too narrow for the sampling
  double resample_seconds = 0, graph_seconds = 0, binding_seconds = 0;
};

/// What a split changed, for the mechanics.
struct BodyDelta {
  CrackDelta crack;
  NodeId first_new_node;            ///< nodes from here on are new
  std::vector<NodeId> donors;       ///< per new node: the node that gave it half of its volume
  std::vector<NodeId> moved_nodes;  ///< old nodes moved off a crack face, ascending
  std::vector<std::pair<NodeId, double>>
      resized_nodes;  ///< old nodes that stayed, but have another support radius; with the one they had, ascending
  std::vector<NodeId> updated_nodes;     ///< rows changed (new, moved and resized ones included), ascending
  std::vector<SurfaceVertexId> rebound;  ///< surface vertices that another node carries now, ascending
  std::vector<std::vector<NodeId>>
      parted;  ///< of each piece that came off, the nodes, ascending; the largest part is not among them
};

/// One front step through all seven steps of § 4: crack, cut graph, sample, update neighbours,
/// re-bind. Commits all or nothing: on GeometryError body and front are unchanged.
BodyDelta split(Body& body, FrontState& front, const std::vector<Vec3>& next, const CrackOptions& options = {},
                SplitWork* work = nullptr);

/// Steps 4 to 7 of § 4 for cracks made elsewhere: brings the body to `surface`, which has grown
/// from the body's own. Where `progress` stops the work, body is of no more use.
BodyDelta follow(Body& body, const Complex& surface, SplitWork* work = nullptr, const Progress& progress = {});

/// Gives nodes other support radii (§ 6.4), those named, ascending, none wider than body.widest:
/// graph, neighbours and binding follow, and equal those from scratch with the same edges, bit for
/// bit. The cost follows what changes. Throws InputError for a radius that is not positive.
BodyDelta resize_nodes(Body& body, std::span<const std::pair<NodeId, double>> radii);

/// The node neighbours of a surface vertex and their Euclidean distances (§ 6.5): those of its
/// master's node, the node itself included, that are within their support radius.
void bound_nodes(const Body& body, SurfaceVertexId v, std::vector<std::pair<NodeId, double>>& out);

/// Every invariant of a body that can be checked alone; empty when all hold, else the first
/// offending ids.
struct BodyReport {
  std::size_t graph_components = 0, pieces = 0, edges_crossing = 0, orphans = 0, nodes_outside = 0;
  std::size_t crumbs = 0;  ///< of the pieces, those without a node: too thin for one
  std::string first_problem;
  bool good() const { return first_problem.empty(); }
};
BodyReport check_body(const Body& body);

}  // namespace geo
