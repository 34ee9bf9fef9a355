// The one door through which a run cuts its body: fronts of blades, fracture by stress, prescored
// cracks, and any other edit of the crack complex.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "body/crack_transaction.h"
#include "kerf/crack.h"
#include "kerf/simulation.h"
#include "simulation/blade_way.h"
#include "simulation/collisions.h"
#include "simulation/cut_solid.h"
#include "simulation/node_loads.h"
#include "simulation/sleep.h"

namespace geo {

/// All in a run that inspects a crack step before its commit, or follows its delta. Refers to data
/// of the caller.
struct CrackFollowers {
  CutSolid& solid;
  const State& motion;
  NodeWay& way;
  Collisions& collisions;
  NodeLoads& loads;
  Sleep& sleep;
};

/// A crack step that has begun: the complex has it, nothing else. Dropped, it is taken back.
struct BegunCrack {
  CrackTransaction step;
  FrontState front{};  ///< after the step; without points where the step is not that of a front
};

/// A crack step that is made.
struct WrittenCrack {
  FrontState front;           ///< see BegunCrack
  std::vector<FaceId> faces;  ///< new crack faces, ascending; none where the step has met nothing
};

/// Makes crack steps. A step is made as a whole, and all who follow have it; or it is refused, is
/// counted in FrameStats::refused, and everything is as before. A run has two: one before its first
/// time step, whose delta only the body indices of nodes follow, and one in its time loop.
class CrackWriter {
 public:
  /// `options`: of the steps of fronts; `body_index`: per node, its body of the scene.
  CrackWriter(Body& body, std::vector<std::uint32_t>& body_index, const CrackOptions& options,
              std::optional<CrackFollowers> followers = {});

  /// Begins a step of a front to `next`, material coordinates. Empty: refused.
  std::optional<BegunCrack> begin(const FrontState& front, std::span<const Vec3> next, FrameStats& stats);
  /// Begins any other step. Empty: refused.
  std::optional<BegunCrack> begin(const CrackEdit& edit, FrameStats& stats);
  /// Commits a step unless a follower vetoes it. Empty: refused.
  std::optional<WrittenCrack> commit(BegunCrack begun, FrameStats& stats);
  /// Both for a step of a front.
  std::optional<WrittenCrack> write(const FrontState& front, std::span<const Vec3> next, FrameStats& stats);
  /// Both for any other step.
  std::optional<WrittenCrack> write(const CrackEdit& edit, FrameStats& stats);

  /// Number of crumbs, as count_crumbs() counts them.
  std::size_t crumbs();

 private:
  void hand_on(const BodyDelta& delta, std::optional<EmbeddingPlan> plan, FrameStats& stats);

  Body& body_;
  std::vector<std::uint32_t>& body_index_;
  CrackOptions options_;
  std::optional<CrackFollowers> followers_;
  std::optional<std::size_t> crumbs_;  // empty: pieces have come off since the last count
};

}  // namespace geo
