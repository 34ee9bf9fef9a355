// A split that a caller may veto before it is committed.
#pragma once

#include <functional>

#include "kerf/body.h"

namespace geo {

/// Receives the complex as a step leaves it and the step's changes, before any other part of the
/// body is updated. Vetoes the step by throwing, as a rule GeometryError.
using StepVeto = std::function<void(const Complex& grown, const CrackDelta& crack)>;

/// As split() in kerf/body.h. `veto`, where not empty, is called before the step is committed; if
/// it throws, body and front are unchanged.
BodyDelta split(Body& body, FrontState& front, const std::vector<Vec3>& next, const CrackOptions& options,
                SplitStats* stats, const StepVeto& veto);

}  // namespace geo
