// Additions of hands to the scene of a run, up to a time and after it.
#pragma once

#include <cstddef>
#include <map>
#include <vector>

#include <kerf/simulation.h>

namespace live {

/// A time of a run, and the numbers of all parts that its scene had then.
struct SceneMark {
  double time;  ///< s
  int frame;
  std::size_t blades, grips, pulls;
  std::size_t changes;  ///< of values, by hands and by effort
};

/// The parts of a scene that are not yet there at a mark: by index, all that was added or has
/// changed since; and the changes of values after it.
struct SceneRest {
  std::map<std::size_t, geo::Blade> blades;
  std::map<std::size_t, geo::Grip> grips;
  std::map<std::size_t, geo::Pull> pulls;
  std::vector<geo::SceneChange> changes;
};

/// A scene that hands have changed since a run began with it. Refers to the scenes.
class HandMadeScene {
 public:
  /// `original`: what the run began with; `now`: with all that was added; `changes`: of values.
  HandMadeScene(const geo::Scene& original, const geo::Scene& now, const std::vector<geo::SceneChange>& changes)
      : original_(original), now_(now), changes_(changes) {}

  /// The mark of a run that is at this state.
  SceneMark mark(const geo::RunState& state) const;
  /// The scene as it was at a mark.
  geo::Scene at(const SceneMark& mark) const;
  /// The parts that at() leaves out.
  SceneRest after(const SceneMark& mark) const;
  /// The scene at a mark, and then the parts that after() once gave.
  geo::Scene at(const SceneMark& mark, const SceneRest& rest) const;

 private:
  const geo::Scene &original_, &now_;
  const std::vector<geo::SceneChange>& changes_;
};

}  // namespace live
