// Times of frames that cut, and of frames that do not.
#pragma once

#include <algorithm>
#include <chrono>
#include <string>

#include "live/session.h"

namespace bench {

/// Means over the frames of a session. The frame after a cut counts as one that cuts: it computes
/// the points that follow.
class CutTimes {
 public:
  /// Advances the session by a frame. Returns what live::Session::advance() returns.
  std::string advance(live::Session& session) {
    const auto start = std::chrono::steady_clock::now();
    std::string why = session.advance();
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    const bool has_cut = session.has_cut();
    (has_cut || follows_ ? cut_ : plain_).add(seconds);
    follows_ = has_cut;
    return why;
  }
  /// The mean time of a frame that cuts, s; 0 if there was none.
  double cut() const { return cut_.mean(); }
  /// The mean time of a frame that does not, s; 0 if there was none.
  double plain() const { return plain_.mean(); }

 private:
  struct Times {
    double sum = 0;
    int count = 0;
    void add(double seconds) {
      sum += seconds;
      ++count;
    }
    double mean() const { return sum / std::max(1, count); }
  };
  Times cut_, plain_;
  bool follows_ = false;
};

}  // namespace bench
