// A split that somebody has to agree to, knowing what it would make of the surface.
#pragma once

#include <functional>

#include "body/body.h"

namespace geo {

/// Is told the complex as a step would leave it, and what the step would change, before anything does; refuses it by throwing
/// GeometryError.
using Agreement = std::function<void(const Complex& grown, const CrackDelta& crack)>;

/// As split() without it; with one that is empty just that, else the complex is copied first.
BodyDelta split(Body& body, FrontState& front, const std::vector<Vec3>& next, const CrackOptions& options, SplitWork* work,
                const Agreement& agree);

}  // namespace geo
