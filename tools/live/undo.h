// Undo and redo of strokes: the states of a run that they go to.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "live/hands.h"
#include "live/history.h"
#include "live/scene_mark.h"

namespace live {

/// Values of a scene that do not act yet: a body without weight is held by a drag instead.
struct Withheld {
  geo::Vec3 gravity;  ///< model units per s²
  double damping;     ///< 1/s
};

/// Parts of a live run that are not in its scene, body and motion.
struct Beside {
  Lasting lasting;
  std::vector<int> checkpoints;      ///< frames from which the run went on from its own checkpoint
  std::optional<Withheld> withheld;  ///< until the first stroke is over
  std::vector<geo::Blow> blows;      ///< by hands, so far
};

/// A run as it was before a stroke.
struct BeforeStroke {
  SceneMark mark;
  Beside beside;
  std::size_t strokes = 1;  ///< that began then, without those that have cut nothing
  std::size_t blades = 1;   ///< that they added
};

/// A stroke that was undone: the run before it, and what the run before undo had in addition.
struct UndoneStroke {
  BeforeStroke before;
  SceneRest rest;
  Beside beside;
  int frame;
};

/// Bounds on what is kept for undo.
struct UndoBounds {
  std::size_t states = 64;          ///< that undo can go back to
  std::size_t bytes = 250'000'000;  ///< of all states of undo and redo; one state may have more
};

/// The strokes that can be undone and made again, with the states of the run, as bytes of
/// checkpoints.
class StrokeHistory {
 public:
  explicit StrokeHistory(const UndoBounds& bounds) : bounds_(bounds) {}

  /// A stroke begins, in this state.
  void add(BeforeStroke before, std::string state);
  /// Another stroke begins in the state that was added last: one undo takes both back.
  /// Precondition: there is one.
  void join();
  /// A stroke that has cut nothing need not be undone. `blade`: the one that it added.
  void forget(std::size_t blade);
  /// Nothing can be made again: there is a new cut.
  void forget_undone();
  /// Forgets all.
  void clear();

  /// Number of strokes that can be undone.
  std::size_t strokes() const { return saved_.size(); }
  /// Number of undone strokes that can be made again.
  std::size_t undone() const { return undone_.size(); }
  /// Whether strokes were forgotten because of the bounds.
  bool has_dropped() const { return has_dropped_; }
  /// Bytes of all states.
  std::size_t bytes() const { return saved_states_.bytes() + undone_states_.bytes(); }
  /// The last stroke. Precondition: there is one.
  const BeforeStroke& last() const { return saved_.back(); }

  /// Removes the last stroke and returns the run before it, with its state. Precondition: there is
  /// one.
  std::pair<BeforeStroke, std::string> take_back();
  /// Likewise, for a stroke that can be made again. `now`: the state of the run.
  std::pair<BeforeStroke, std::string> undo(UndoneStroke undone, const std::string& now);
  /// Makes the last undone stroke one that can be undone, and returns it with the state of the run
  /// before its undo. Precondition: there is one.
  std::pair<UndoneStroke, std::string> redo();

 private:
  void drop_states();

  UndoBounds bounds_;
  StateStack saved_states_, undone_states_;  // of an undone stroke: before it, then before its undo
  std::vector<BeforeStroke> saved_;
  std::vector<UndoneStroke> undone_;
  bool has_dropped_ = false;
};

}  // namespace live
