// Guides of a body (§ 8): along its whole surface, and along what a step adds to it.
#pragma once

#include <vector>

#include "graph/guide_set.h"
#include "kerf/body.h"

namespace geo {

/// Guides along the concave edges and crack fronts of the whole surface, Body::guide_spacing apart.
std::vector<Guide> all_guides(const Body& body);

/// The change of guides after a step: guides that new crack faces have reached are retired, and the
/// edges of all new faces get guides. Precondition: body.surface has taken the step, body.graph has
/// not. Empty where Body::guide_spacing is 0.
GuideChange guides_after(const Body& body, const CrackDelta& crack);

}  // namespace geo
