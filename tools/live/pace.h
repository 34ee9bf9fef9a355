// Real time: when frames are due, how fast they are, and how much accuracy they can afford.
#pragma once

#include <chrono>
#include <deque>

namespace live {

/// Measures frames and decides on their accuracy.
class Pacer {
 public:
  using Clock = std::chrono::steady_clock;
  /// `period`: seconds of a frame; `accuracy`: of the scene.
  Pacer(double period, double accuracy) : period_(period), own_(accuracy), accuracy_(accuracy) {}

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
  /// The accuracy that frames of this duration can afford: the scene's, or up to `loosest` of it
  /// where frames take more than 0.9 of their time.
  double accuracy();

 private:
  static constexpr double loosest = 4;
  double period_, own_, accuracy_, step_ = 0;
  int since_change_ = 0;
  Clock::time_point due_ = Clock::now();
  std::deque<Clock::time_point> ends_;
};

}  // namespace live
