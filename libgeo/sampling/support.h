// Support radii, from the nodes around.
#pragma once

#include "kerf/nodes.h"
#include "kerf/progress.h"
#include "sampling/leaf_index.h"

namespace geo {

/// Support radii (§ 3.1): `support` times a node's spacing, or the mean of its twelve nearest and its own (weighted by
/// the spacings) where that is less, so that radii change gradually where the spacing halves; wide enough for a dozen
/// others within three spacings: fewer seldom span all directions. Row i of the nodes is leaf i.
void set_support_radii(NodeSet& nodes, const LeafIndex& leaves, double support, const Progress& progress);

}  // namespace geo
