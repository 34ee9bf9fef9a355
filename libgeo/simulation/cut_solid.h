// The solid of a run, which follows the cracks of its body.
#pragma once

#include <mutex>

#include "kerf/body.h"
#include "kerf/solid.h"

namespace geo {

/// A Solid whose nodes follow each crack step at once. Its points follow in whole(): several steps
/// cost one update. Refers to the body and its motion, which it changes.
class CutSolid {
 public:
  /// Discretises the body.
  CutSolid(const Body& body, State& motion, Materials materials);
  /// Continues with the body and motion as they are now, which others have replaced by those of a
  /// checkpoint. The discretisation stays if nothing was cut since it was made.
  void restart(Materials materials);
  /// Likewise, for another body.
  void rebuild(Materials materials);
  /// Whether a body with this number of nodes fits; see restart().
  bool fits(std::size_t nodes) const { return has_followed_ || solid_.size() == nodes; }

  /// See Solid::set_materials().
  void set_materials(const Materials& materials) { solid_.set_materials(materials); }
  /// Updates nodes and their motion after a crack step.
  void follow(const BodyDelta& delta);
  /// The solid for use of its nodes alone; points may be behind.
  const Solid& nodes() const { return solid_; }
  /// The solid with its points up to date. Several threads may call it, but not tasks of one
  /// parallel loop.
  Solid& whole();

 private:
  const Body& body_;
  State& motion_;
  Solid solid_;
  bool has_followed_ = false;  // a crack step, since the solid was made
  std::mutex updating_;        // held by whole()
};

}  // namespace geo
