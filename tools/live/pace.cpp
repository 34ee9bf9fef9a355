// Means over some frames, so that a single cut does not change the accuracy.
#include "live/pace.h"

#include <algorithm>

namespace live {

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

double Pacer::accuracy() {
  constexpr int patience = 30;  // frames between two changes
  constexpr double factor = 1.4;
  if (since_change_ < patience) return accuracy_;
  const double load = step_ / period_;
  const double wanted = load > 0.9   ? std::min(accuracy_ * factor, std::min(own_ * loosest, 0.1))
                        : load < 0.5 ? std::max(accuracy_ / factor, own_)
                                     : accuracy_;
  if (wanted != accuracy_) accuracy_ = wanted, since_change_ = 0;
  return accuracy_;
}

}  // namespace live
