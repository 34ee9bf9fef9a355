// Values of a scene that change during a run: kerf/scene.h's changes.
#pragma once

#include <cstddef>
#include <string>

#include "kerf/scene.h"

namespace geo {

/// The fault of a change: a value that a scene may not have. Empty where there is none.
std::string unfit(const SceneChange& change);

/// Applies the changes of a scene to its values, in their order.
class SceneChanges {
 public:
  /// `scene` has the values that hold before the first change.
  explicit SceneChanges(const Scene& scene);
  /// Gives `scene` the values that hold before the first change.
  void revert(Scene& scene);
  /// Applies to `scene` the changes of its list that are due at a time and were not applied yet.
  /// Whether there were any.
  bool apply(Scene& scene, double time);

 private:
  void apply(Scene& scene, const SceneChange& change);

  std::size_t applied_ = 0;
  Scene original_;  // values before the first change; nothing else
};

}  // namespace geo
