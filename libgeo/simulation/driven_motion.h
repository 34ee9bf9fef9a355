// Motions that a program sets frame by frame.
#pragma once

#include "kerf/scene.h"

namespace geo {

/// The fate of an object after its last key: grips and obstacles stay where they are, blades and
/// pulls are removed.
enum class AfterLastKey { stays, removed };

/// A key with this pose, whose axis is arbitrary where there is no rotation.
Motion::Key key_at(double time, const Pose& pose);

/// Goes from the present pose at time `now` straight to that of `next`, which is later. Keys up to
/// now stay to the bit, keys after it go. An object that was removed before begins anew.
void drive(Motion& motion, double now, const Motion::Key& next, AfterLastKey after);

}  // namespace geo
