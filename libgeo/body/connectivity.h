// Connectivity of G against connectivity of the material: each piece must be one component of G.
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <set>
#include <span>

#include "body/node_insertion.h"
#include "body/piece_labels.h"
#include "body/regions.h"

namespace geo {

/// Where components of G and pieces of material do not correspond.
struct ConnectivityMismatch {
  std::vector<SurfaceVertexId> empty_pieces;             ///< a surface vertex of each piece without a node
  std::vector<NodePair> disconnected;                    ///< pairs of nodes of one piece in two components of G
  std::map<std::int32_t, NodeId> representative;         ///< by label: a node of each piece visited; invalid
                                                         ///< where the piece has none yet
  std::map<std::int32_t, std::set<std::int32_t>> parts;  ///< by label, of a piece that was parted:
                                                         ///< itself and the other parts; by note_parts()
  /// Do components and pieces correspond?
  bool none() const { return empty_pieces.empty() && disconnected.empty(); }
};

/// Compares the whole body: one pass over nodes and surface. `component`: of each node, as
/// VisibilityGraph::components() numbers them. Precondition: prepare_cache().
ConnectivityMismatch find_mismatch(const Body& body, const std::vector<std::uint32_t>& component);

/// Compares after a step only what may have changed: at `cut` edges, `detached` pieces, nodes from
/// `first_new` on, and faces at `touched` vertices. If a component came apart, only the part with
/// fewer nodes is visited. Parts still connected around the crack front cost little more than the
/// cut.
ConnectivityMismatch find_mismatch(const Body& body, std::span<const NodePair> cut,
                                   std::span<const DetachedPiece> detached, std::span<const SurfaceVertexId> touched,
                                   NodeId first_new);

/// Notes which pieces were one before the step.
void note_parts(const Body& body, std::span<const DetachedPiece> detached, ConnectivityMismatch& mismatch);

/// Pairs each component that consists of nodes from `first_new` on with another node of its piece,
/// if there is one.
void pair_new_nodes(const Body& body, Regions& components, NodeId first_new, ConnectivityMismatch& mismatch);

/// The components of G as regions that grow on demand. Refers to the body, which must outlive them.
Regions components_of(const Body& body);

/// A point inside the piece that the shell of surface vertex v bounds. `piece` gives labels of
/// sides. Candidates lie on the inward normals of the largest faces, half way to the next face and
/// at most reach / 2 away. For needles, they lie between corners of the shell. Empty where the
/// piece is too thin for a point in double precision.
std::optional<Vec3> point_in_piece(const Complex& k, SurfaceVertexId v, double reach,
                                   const std::function<std::int32_t(Side)>& piece);

/// Updates the graph after nodes from `first_new` on were added. `joins` are pairs that see each
/// other and get an edge at any distance.
using GraphUpdater = std::function<void(NodeId first_new, std::span<const NodePair> joins)>;

/// The faces and edges of a step, for repair_connectivity().
struct FreshCut {
  std::span<const FaceId> faces;    ///< crack faces of the step, ascending
  std::span<const NodePair> edges;  ///< edges of G that it has cut
};

/// § 6.4, passages too narrow for the sampling: adds edges, then nodes, until no piece is empty and
/// all pairs are connected. Works in rounds of decreasing spacing; `update` is called once a round.
/// Afterwards mismatch.representative has a node of each piece visited. `cut`: nodes are added near
/// its edges, if some of them joined the components. Else the passage may be anywhere.
void repair_connectivity(NewNodes& inserted, ConnectivityMismatch& mismatch, const GraphUpdater& update,
                         const FreshCut& cut = {});

/// The nodes of each detached piece, ascending. A piece that came apart into n parts gives n − 1
/// lists: the part with most nodes is left out.
std::vector<std::vector<NodeId>> detached_nodes(const Body& body, std::span<const DetachedPiece> detached,
                                                const ConnectivityMismatch& mismatch);

}  // namespace geo
