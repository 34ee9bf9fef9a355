// A body: everything about one deformable solid in material coordinates. Crack complex K, nodes,
// visibility graph, neighbours and binding, always consistent with each other.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "kerf/complex.h"
#include "kerf/crack.h"
#include "kerf/graph.h"
#include "kerf/indirect.h"
#include "kerf/nodes.h"
#include "kerf/progress.h"

namespace geo {

/// The nodes that carry each surface vertex (§ 6.5). A master is a surface vertex that is the
/// closest visible one of some node. All other vertices hang in a tree below a master, along edges
/// of the derived surface. Indexed by SurfaceVertexId where nothing else is said; entries of dead
/// vertices are invalid.
struct Binding {
  std::vector<NodeId> master_node;       ///< of a master: its nearest node by a visibility edge; else invalid
  std::vector<SurfaceVertexId> master;   ///< the root of the vertex's tree; invalid for an orphan
  std::vector<SurfaceVertexId> parent;   ///< next vertex on the way to the master; itself for a master
  std::vector<SurfaceVertexId> closest;  ///< by NodeId: the node's closest visible surface vertex within its
                                         ///< support radius, or invalid
  /// Equal in all entries.
  friend bool operator==(const Binding&, const Binding&) = default;
};

/// Where a file came from: printed by kerf-info, written into every body.
struct Provenance {
  std::string tool, version, arguments;
  std::vector<std::string> inputs;  ///< "name xxh3:…"
};

struct IncrementalCache;  // body/incremental_cache.h

/// One deformable solid. Made by build_body() or read_body(), changed by split(), update_body() and
/// resize_nodes(). Lengths are in model units.
struct Body {
  /// A body without surface and nodes.
  Body();

  Complex surface;                   ///< K
  NodeSet nodes;                     ///< P
  VisibilityGraph graph;             ///< G, and the neighbours of each node
  Binding binding;                   ///< the nodes that carry each surface vertex
  int k = 26;                        ///< nearest neighbours of a node in G
  double guide_spacing = 0;          ///< distance between guides along concave edges (§ 8), in node spacings; 0: none
  double resample_limit = 1;         ///< 0: cracks get no new nodes
  std::uint32_t original_nodes = 0;  ///< number of nodes that the body was built from; they come first
  double finest_spacing = 0;         ///< of the original nodes: cracks get no finer nodes
  double widest_radius = 0;          ///< largest support radius of the original nodes: no node gets a wider one
  std::uint32_t crack_steps = 0;     ///< applied since the build
  std::vector<std::uint8_t> debris;  ///< by NodeId: 1 where the neighbours do not span space. Such a node is rigid
                                     ///< debris: its neighbours determine no linear field
  std::vector<Provenance> history;   ///< programs that have written the body, oldest first

  /// Data derived from the members above, which steps update instead of deriving them anew; never
  /// in a file. For the library's own code.
  Indirect<IncrementalCache> cache;
};

/// Options of build_body().
struct BodyOptions {
  int k = 26;                                         ///< nearest neighbours of a node in G, 3 to 1000
  NeighborMethod method = NeighborMethod::automatic;  ///< all methods give the same body
  double guide_spacing = 0;                           ///< see Body; 0 or 0.05 to 10
};

/// Builds graph, neighbours and binding (§ 6.1, 6.2, 6.5). Where the sampling is too coarse for a
/// narrow passage, G has more components than there are pieces of material; nodes are added until
/// both agree. `donors`, where given, receives for each node that was added the one whose material
/// it takes. Throws InputError for options out of range, no nodes, or a node outside the material.
Body build_body(Complex surface, NodeSet nodes, const BodyOptions& options = {}, const Progress& progress = {},
                std::vector<NodeId>* donors = nullptr);

/// The binding from scratch. Incremental updates equal it, bit for bit.
Binding build_binding(const Body& body);

/// Counts and seconds of splits, by phase. Functions add to it.
struct SplitStats {
  CrackStats crack;               ///< § 4, step 1 to 3: surface
  std::size_t edges_cut = 0;      ///< |E_cut|
  std::size_t edges_added = 0;    ///< |E_new|
  std::size_t nodes_updated = 0;  ///< |P_update|
  std::size_t nodes_added = 0;    ///< |P_new|
  std::size_t nodes_moved = 0;    ///< old nodes moved off a crack face
  std::size_t orphans = 0;        ///< surface vertices that got another carrying node
  std::size_t repair_nodes = 0;   ///< of the added nodes, the last: in pieces without one, narrow passages, thin walls
  double resample_seconds = 0;    ///< new nodes
  double graph_seconds = 0;       ///< graph and neighbours, and most of the binding beside them
  double binding_seconds = 0;     ///< the rest of the binding
};

/// Changes of a body by a split, for the mechanics. All lists are ascending.
struct BodyDelta {
  CrackDelta crack;                                      ///< changes of K
  NodeId first_new_node;                                 ///< nodes from here on are new
  std::vector<NodeId> donors;                            ///< for each new node: whose motion and material it takes
  std::vector<NodeId> moved_nodes;                       ///< old nodes moved off a crack face
  std::vector<std::pair<NodeId, double>> resized_nodes;  ///< old nodes with another support radius, and the old radius
  std::vector<NodeId> updated_nodes;              ///< P_update: rows changed; new, moved and resized nodes included
  std::vector<SurfaceVertexId> rebound_vertices;  ///< surface vertices with another carrying node
  std::vector<std::vector<NodeId>> detached;      ///< for each piece that came off, its nodes; the component with
                                                  ///< most nodes counts as the rest
};

/// Moves a crack front to `next` (positions of its points, material coordinates) through all seven
/// steps of § 4: crack, cut graph, resample, update neighbours, rebind. Throws GeometryError when
/// the step is not possible; body and front are then unchanged.
BodyDelta split(Body& body, FrontState& front, const std::vector<Vec3>& next, const CrackOptions& options = {},
                SplitStats* stats = nullptr);

/// Steps 4 to 7 of § 4 for cracks made elsewhere: brings the body to `surface`, which has grown
/// from body.surface. If `progress` stops it, the body is lost.
BodyDelta update_body(Body& body, const Complex& surface, SplitStats* stats = nullptr, const Progress& progress = {});

/// Sets the support radii (§ 6.4) of some nodes (ascending), at most body.widest_radius, and
/// updates graph, neighbours and binding: equal to a build from scratch with the same edges, bit
/// for bit. The cost follows what changes. Throws InputError for a radius that is not positive.
BodyDelta resize_nodes(Body& body, std::span<const std::pair<NodeId, double>> radii);

/// Writes the nodes that carry a surface vertex v, with their Euclidean distances to v (§ 6.5): the
/// node m of v's master, and m's neighbours; on the border of a sheet, those of both sides. j
/// carries v if |x_j − v| < r_j. If none does, m carries v, with distance 0. Empty for an orphan.
void carrier_nodes(const Body& body, SurfaceVertexId v, std::vector<std::pair<NodeId, double>>& out);

/// The result of check_body().
struct BodyReport {
  std::size_t graph_components = 0;     ///< of G
  std::size_t pieces = 0;               ///< of material
  std::size_t edges_crossing = 0;       ///< edges of G that touch a face
  std::size_t orphans = 0;              ///< live surface vertices without a master
  std::size_t nodes_outside = 0;        ///< nodes not inside the material
  std::size_t pieces_without_node = 0;  ///< pieces too thin for a node in double precision
  std::string first_problem;            ///< the first violated invariant with its ids; empty when all hold
  /// Do all invariants hold?
  bool good() const { return first_problem.empty(); }
};

/// Checks every invariant of a body against a build from scratch.
BodyReport check_body(const Body& body);

}  // namespace geo
