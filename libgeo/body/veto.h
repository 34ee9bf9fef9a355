// A split in two parts, which a caller may veto in between.
#pragma once

#include <functional>
#include <optional>

#include "body/binding.h"
#include "kerf/body.h"

namespace geo {

/// Receives the complex as a step leaves it and the step's changes, before any other part of the
/// body is updated. Vetoes the step by throwing, as a rule GeometryError. Any thread may call it,
/// and others read the body meanwhile.
using StepVeto = std::function<void(const Complex& grown, const CrackDelta& crack)>;

/// A split whose crack the complex has, and no other part of the body yet.
struct BegunSplit {
  FrontState front;  ///< after the step
  CrackDelta crack;
  std::optional<ClosestVertices> closest = {};  ///< closest_after() the crack, where it is known
};
/// The first part of split() in kerf/body.h, steps 1 to 3: changes the complex, and fills the cache
/// where it is empty. Throws as split() does, and the body is unchanged then.
BegunSplit begin_split(Body& body, const FrontState& front, const std::vector<Vec3>& next, const CrackOptions& options,
                       SplitStats* stats);
/// Takes a begun split back: the complex is as before. Nothing else may have changed it since.
void undo_split(Body& body, const BegunSplit& begun);
/// The second part of split(). `veto`, where not empty, is called before the step is committed; if
/// it throws, body and front are as before begin_split().
BodyDelta finish_split(Body& body, FrontState& front, BegunSplit begun, SplitStats* stats, const StepVeto& veto);

/// Both parts.
BodyDelta split(Body& body, FrontState& front, const std::vector<Vec3>& next, const CrackOptions& options,
                SplitStats* stats, const StepVeto& veto);

}  // namespace geo
