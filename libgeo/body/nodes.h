// Nodes that a body gains: near cracks, in narrow passages, in pieces that have none.
#pragma once

#include <utility>

#include "kerf/body.h"

namespace geo {

using NodePair = std::pair<NodeId, NodeId>;  ///< first < second

/// The first `count` nodes, at least one, are those that the body was built of.
void set_sampled(Body& body, std::uint32_t count);

/// Appends a node at x, with spacing and radius of node `donor` and half of its volume: Σ volume stays what it was.
NodeId insert_node(Body& body, const Vec3& x, NodeId donor, double spacing);

/// § 6.4: nodes on both sides of the faces, inside, seen from the face, not too close to nodes that see them. Returns
/// how many. `spacing`: wanted distance between them, 0: half of what nodes are apart there, no finer than body.finest,
/// with support radii in proportion; at most `limit` are inserted.
std::size_t insert_near(Body& body, const std::vector<FaceId>& faces, double spacing, std::uint64_t seed,
                        std::size_t limit = std::size_t(-1));

/// Moves nodes that are on or very near one of the faces off it, and off all others that are near them: each at most
/// once, past no face that it is not on. Returns them, ascending.
std::vector<NodeId> move_off(Body& body, const std::vector<FaceId>& faces);

/// Neighbours spread less in one direction than this share of what they do in another: the smallest over the largest
/// eigenvalue of their moment matrix, the bound below which mechanics leaves a direction out.
constexpr double debris_below = 1e-4;

/// Marks nodes whose neighbours do not span space: no linear field can be told from them (Müller et al. 2004, § 3.1).
void mark_debris(Body& body, const std::vector<NodeId>& nodes);

}  // namespace geo
