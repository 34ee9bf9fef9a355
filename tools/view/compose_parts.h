// Parts of a stage: each adds spheres and sticks of its own.
#pragma once

#include "view/compose.h"

namespace view {

/// Nodes, edges, cut ones, the neighbourhood of one node; `position`: where the nodes are shown. A node file's nodes
/// are always drawn.
void add_nodes(Stage& stage, const Subject& subject, const std::vector<geo::Vec3>& position, const Look& look);

/// Masters and slaves (§ 6.5): links of nodes to masters in red, trees in green; of one node where `look.node` says.
void add_trees(Stage& stage, const Subject& subject, const std::vector<geo::Vec3>& position, const Look& look);

/// Along the surface's sheets: edges shared with the skin in green, tips in red.
void add_seams(Stage& stage);

/// A line each time step from look.first_step to last_step, and the ways of the points between steps.
void add_fronts(Stage& stage, const std::vector<geo::Front>& fronts, const Look& look);

}  // namespace view
