// Real time: when frames are due, how fast they are, which accuracy and time step they can afford.
#pragma once

#include <chrono>
#include <deque>

namespace live {

/// Decides on the cost of a frame, and on its error.
struct Effort {
  double accuracy = 0;  ///< of the mechanics, in node spacings
  int steps = 1;        ///< equal time steps in a frame
  bool operator==(const Effort&) const = default;
};

/// Measures frames and decides on their effort.
class Pacer {
 public:
  using Clock = std::chrono::steady_clock;
  /// `period`: seconds of a frame; `own`: effort of the scene, never exceeded; `least`: the least
  /// effort, with the coarsest accuracy.
  Pacer(double period, const Effort& own, const Effort& least) : period_(period), own_(own), least_(least), now_(own) {}

  /// When the next frame is due. Time that was lost is not made up for: a run that is too slow
  /// slows down evenly.
  Clock::time_point due() const { return due_; }
  /// A frame was computed in this time, and was due at due().
  void add(Clock::time_point begin, Clock::time_point end);
  /// Forgets what was measured: the run stood still.
  void restart();

  /// Frames per second of the last second.
  double fps() const;
  /// Mean time of a frame, s.
  double step() const { return step_; }
  /// Simulated seconds per second.
  double rate() const { return fps() * period_; }
  /// Whether the run is slower than real time.
  bool slow() const { return fps() > 0 && rate() < 0.9; }
  /// The effort that frames of this duration can afford. Where they take more than 0.9 of their
  /// time, accuracy is relaxed; when that is not enough, frames have fewer and longer steps. Where
  /// frames take less, first the steps and then the accuracy are restored.
  Effort effort();

 private:
  Effort reduced(double load) const;
  Effort restored(double load) const;

  double period_, step_ = 0;
  Effort own_, least_, now_;
  int since_change_ = 0;
  Clock::time_point due_ = Clock::now();
  std::deque<Clock::time_point> ends_;
};

}  // namespace live
