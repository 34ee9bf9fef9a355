// A split that somebody has to agree to, knowing what it would make of the surface.
#pragma once

#include <functional>

#include "kerf/body.h"

namespace geo {

/// Is told the complex as a step leaves it, and what the step has changed there, before anything else of the body
/// follows; refuses the step by throwing, mostly GeometryError.
using Agreement = std::function<void(const Complex& grown, const CrackDelta& crack)>;

/// As split() without it, when that is empty or does not refuse; else the complex is as before again.
BodyDelta split(Body& body, FrontState& front, const std::vector<Vec3>& next, const CrackOptions& options,
                SplitWork* work, const Agreement& agree);

}  // namespace geo
