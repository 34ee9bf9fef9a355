// Guides of a body (§ 8): along all of its surface, and along what a step makes of it.
#pragma once

#include "graph/guide_set.h"
#include "kerf/body.h"

namespace geo {

/// Guides along the concave edges and crack fronts of the whole surface, body.guides spacings
/// apart.
std::vector<Guide> all_guides(const Body& body);

/// What a step means for the guides of a body whose surface has taken it and whose graph has not
/// yet: those that the new crack faces have reached are retired, the edges of all new faces get
/// their own. Nothing where body.guides is 0.
GuideChange guides_after(const Body& body, const CrackDelta& crack);

}  // namespace geo
