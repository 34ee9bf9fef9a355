// Means over some frames, so that a single cut does not change the effort.
#include "live/pace.h"

#include <algorithm>

namespace live {
namespace {

constexpr double relaxation = 1.4;  // of accuracy in one change

}  // namespace

void Pacer::add(Clock::time_point begin, Clock::time_point end) {
  const double seconds = std::chrono::duration<double>(end - begin).count();
  step_ = step_ == 0 ? seconds : 0.9 * step_ + 0.1 * seconds;
  ++since_change_;
  ends_.push_back(end);
  while (ends_.size() > 2 && end - ends_.front() > std::chrono::seconds(1)) ends_.pop_front();
  due_ = std::max(end, due_ + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(period_)));
}

void Pacer::restart() {
  due_ = Clock::now();
  ends_.clear();
}

double Pacer::fps() const {
  if (ends_.size() < 2) return 0;
  return double(ends_.size() - 1) / std::chrono::duration<double>(ends_.back() - ends_.front()).count();
}

// Accuracy comes first: relaxed within its bound, it costs less than a longer step, which damps
// motion.
Effort Pacer::reduced(double load) const {
  constexpr double aim = 0.8;  // load with fewer steps
  if (now_.accuracy < least_.accuracy) return {std::min(now_.accuracy * relaxation, least_.accuracy), now_.steps};
  const int fewer = static_cast<int>(now_.steps * aim / load);
  return {now_.accuracy, std::max(least_.steps, std::min(fewer, now_.steps - 1))};
}

Effort Pacer::restored(double load) const {
  constexpr double light = 0.5, aim = 0.7;  // load at which accuracy is restored; most with one step more
  if (now_.steps < own_.steps)
    return {now_.accuracy, now_.steps + (load * (now_.steps + 1) / now_.steps < aim ? 1 : 0)};
  return {load < light ? std::max(now_.accuracy / relaxation, own_.accuracy) : now_.accuracy, now_.steps};
}

Effort Pacer::effort() {
  constexpr int patience = 30;  // frames between two changes
  constexpr double heavy = 0.9;
  if (since_change_ < patience) return now_;
  const double load = step_ / period_;
  const Effort wanted = load > heavy ? reduced(load) : restored(load);
  if (wanted != now_) {
    now_ = wanted;
    since_change_ = 0;
  }
  return now_;
}

}  // namespace live
