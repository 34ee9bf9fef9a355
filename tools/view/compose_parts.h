// Parts of a stage. Each function adds its spheres and sticks.
#pragma once

#include "view/compose.h"

namespace view {

/// Nodes, edges, cut edges, and the neighbourhood of one node, with nodes shown at `position`.
/// Nodes of a node file are always drawn.
void add_nodes(Stage& stage, const Subject& subject, const std::vector<geo::Vec3>& position, const Look& look);

/// Masters and slaves (§ 6.5): links from nodes to masters in red, trees in green; with `look.node`
/// those of one node.
void add_trees(Stage& stage, const Subject& subject, const std::vector<geo::Vec3>& position, const Look& look);

/// Borders of crack sheets: edges shared with the skin in green, fronts in red.
void add_seams(Stage& stage);

/// A polyline for each time step from look.first_step to last_step, and the paths of the points
/// between.
void add_fronts(Stage& stage, const std::vector<geo::Front>& fronts, const Look& look);

}  // namespace view
