// Nodes that a body gains or moves: near cracks, in narrow passages, in pieces without nodes.
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "kerf/body.h"

namespace geo {

using NodePair = std::pair<NodeId, NodeId>;  ///< first < second

/// Declares the first `count` nodes (at least one) as the nodes that the body was built from, and
/// sets the bounds that depend on them.
void set_original_nodes(Body& body, std::uint32_t count);

/// The nodes that one change of a body inserts. They come last, and each has a donor: the node
/// whose motion and material it takes. Refers to the body.
class NewNodes {
 public:
  /// None yet.
  explicit NewNodes(Body& body) : body_(body), first_(body.nodes.size()) {}
  /// Appends a node at x with the support radius of node `donor`. Each of `givers` gives it the
  /// same share of its volume; without givers, the donor gives half. The sum does not change.
  /// Returns its id.
  NodeId insert(const Vec3& x, NodeId donor, double spacing, std::span<const std::uint32_t> givers = {});
  /// Removes the nodes from `first` on, and returns their volume to their donors. Precondition:
  /// donors alone gave it, and no edge leads to these nodes yet.
  void remove_from(NodeId first);

  /// The body.
  Body& body() const { return body_; }
  /// The first of them; where there is none, the number of nodes.
  NodeId first() const { return first_; }
  /// The donor of each.
  const std::vector<NodeId>& donors() const { return donors_; }

 private:
  Body& body_;
  NodeId first_;
  std::vector<NodeId> donors_;
};

/// Options of insert_nodes_near().
struct InsertionOptions {
  double spacing = 0;                   ///< wanted distance between nodes, model units. 0: half of the spacing of the
                                        ///< original nodes there, not below Body::finest_spacing, and support radii
                                        ///< in proportion
  std::uint64_t seed = 0;               ///< of the samples
  std::size_t limit = std::size_t(-1);  ///< most nodes inserted
  std::span<const FaceId> fresh = {};   ///< crack faces of this step, ascending: what they part moved as one before
};

/// § 6.4: inserts nodes on both sides of the faces, inside the material, visible from the face, and
/// not too close to nodes that they see. Returns their number.
std::size_t insert_nodes_near(NewNodes& inserted, const std::vector<FaceId>& faces, const InsertionOptions& options);

/// Inserts nodes where the material behind the faces is thinner than half of the spacing, so that
/// insert_nodes_near() finds no place: between the two walls, nearer to the one or the other in
/// turn. Returns each with the nearest older node that it sees, its donor. Precondition: each piece
/// has a node.
std::vector<NodePair> insert_nodes_between_walls(NewNodes& inserted, const std::vector<FaceId>& faces,
                                                 std::uint64_t seed);

/// Evens out the volumes of new nodes and of their donors: one with less than half of what its
/// cubed spacing would have of the volume of it and its neighbours takes the rest from the
/// neighbours that have more than that. A donor that gives a half again and again would be left
/// with no mass to speak of, and light nodes beside heavy ones make a time step stiff. The sum
/// does not change. Precondition: the graph has the new nodes.
void even_out_volumes(NewNodes& inserted);

/// Moves nodes that are on or very near one of the faces away from it and from all other faces near
/// them: each node at most once, through no face that it does not touch. Returns them, ascending.
std::vector<NodeId> move_nodes_off(Body& body, const std::vector<FaceId>& faces);

/// Neighbours do not span space when the smallest eigenvalue of their moment matrix is below this
/// share of the largest. It is the bound below which the shape functions leave a direction out.
constexpr double debris_below = 1e-4;

/// Sets Body::debris of some nodes (Müller et al. 2004, § 3.1).
void mark_debris(Body& body, const std::vector<NodeId>& nodes);

}  // namespace geo
