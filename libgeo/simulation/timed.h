// Seconds of the phases of a time step, collected by scopes beside the logic.
#pragma once

#include <algorithm>

#include "kerf/progress.h"
#include "kerf/simulation.h"

namespace geo {

/// Adds the seconds of a scope to a sum, however the scope ends.
class Timed {
 public:
  /// The scope begins. Nobody else uses `sum` before it ends.
  explicit Timed(double& sum) : sum_(sum) {}
  ~Timed() { sum_ += watch_.lap(); }
  Timed(const Timed&) = delete;
  Timed& operator=(const Timed&) = delete;

 private:
  double& sum_;
  Stopwatch watch_;
};

/// Adds to one phase of a frame the seconds of a scope that no other phase has counted meanwhile.
/// So phases may nest, and a scope may run work of another phase beside its own: only what it takes
/// longer than that counts. Begins and ends while no other thread counts.
class TimedRest {
 public:
  /// The scope begins. `phase`: a member of FrameStats in seconds.
  TimedRest(FrameStats& stats, double FrameStats::*phase) : stats_(stats), phase_(phase), others_(others()) {}
  ~TimedRest() { stats_.*phase_ += std::max(0.0, watch_.lap() - (others() - others_)); }
  TimedRest(const TimedRest&) = delete;
  TimedRest& operator=(const TimedRest&) = delete;

 private:
  // Seconds of all other phases.
  double others() const { return stats_.phase_seconds() - stats_.*phase_; }

  FrameStats& stats_;
  double FrameStats::*phase_;
  double others_;  // at the begin
  Stopwatch watch_;
};

}  // namespace geo
