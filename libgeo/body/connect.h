// Components of G against pieces of the material: where they disagree, and how they are brought to agree.
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <span>

#include "body/nodes.h"
#include "body/regions.h"
#include "body/upkeep.h"

namespace geo {

/// Where components of G and pieces of the material disagree.
struct Disagreement {
  std::vector<SurfaceVertexId> empty;    ///< a surface vertex of each piece without a node
  std::vector<NodePair> apart;           ///< nodes of one piece that G does not connect
  std::map<std::int32_t, NodeId> known;  ///< a node of each piece that was looked at
  bool none() const { return empty.empty() && apart.empty(); }
};

/// The whole body: once over nodes and surface. `component`: of each node, as the graph numbers them. Needs
/// body.upkeep.
Disagreement find_disagreement(const Body& body, const std::vector<std::uint32_t>& component);

/// After a step: only what cut edges, pieces cut off, nodes from `first_new` on and other faces at `touched` vertices
/// can have changed. Of two parts the one with fewer nodes is walked through; where they are joined round the front of
/// the crack, little more than the cut.
Disagreement find_disagreement(const Body& body, std::span<const NodePair> cut, std::span<const Offcut> offcuts,
                               std::span<const SurfaceVertexId> touched, NodeId first_new);

/// Nodes from `first_new` on that see no older one: pairs with a node of their piece, where there is one.
void pair_new_nodes(const Body& body, Regions& components, NodeId first_new, Disagreement& found);

/// The connected parts of G.
Regions components_of(const Body& body);

/// A point inside the piece that a shell bounds, on the line from the middle of one of the shell's largest faces
/// straight into it, half way to what comes next, at most half of `reach` away; of a needle the clearest of some points
/// between its corners. Nothing where doubles have no room for one: a crumb some last places thick. v: any vertex of
/// the shell; `piece` numbers the sides with material.
std::optional<Vec3> room_in(const Complex& k, SurfaceVertexId v, double reach,
                            const std::function<std::int32_t(Side)>& piece);

/// Updates the graph after nodes were added; `joins` are pairs that see each other and are to have an edge, near or
/// not.
using GraphUpdater = std::function<void(NodeId first_new, std::span<const NodePair> joins)>;

/// § 6.4, passages too narrow for the sampling: inserts nodes until no piece is empty and the pairs are connected, in
/// several rounds, each finer. Afterwards `found.known` has a node of each piece that was looked at.
void mend(Body& body, Disagreement& found, const GraphUpdater& after);

/// The nodes of each piece that came off; of those that were one piece before, the one with most nodes is left out.
std::vector<std::vector<NodeId>> parted_nodes(const Body& body, std::span<const Offcut> offcuts,
                                              const Disagreement& found);

}  // namespace geo
