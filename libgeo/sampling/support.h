// Support radii from the spacing of the nodes around.
#pragma once

#include "kerf/nodes.h"
#include "kerf/progress.h"
#include "sampling/leaf_index.h"

namespace geo {

/// Sets support radii (§ 3.1): `support` times a node's spacing or, where less, the mean spacing of
/// its twelve nearest nodes and itself, weighted by the spacings. So radii change gradually where
/// the spacing halves. A radius covers at least a dozen other nodes within three spacings, since
/// fewer seldom span space. Node i is leaf i.
void set_support_radii(NodeSet& nodes, const LeafIndex& leaves, double support, const Progress& progress);

}  // namespace geo
