// The oldest states go first. The newest one stays, however large it is.
#include "live/undo.h"

namespace live {

void StrokeHistory::add(BeforeStroke before, std::string state) {
  saved_states_.push(std::move(state));
  saved_.push_back(std::move(before));
  drop_states();
}

void StrokeHistory::drop_states() {
  while (saved_.size() > 1 && (saved_.size() > bounds_.states || bytes() > bounds_.bytes)) {
    saved_states_.erase(0);
    saved_.erase(saved_.begin());
    has_dropped_ = true;
  }
  while (!undone_.empty() && bytes() > bounds_.bytes) {
    undone_states_.erase(0);
    undone_states_.erase(0);
    undone_.erase(undone_.begin());
  }
}

void StrokeHistory::join() {
  ++saved_.back().strokes;
  ++saved_.back().blades;
}

void StrokeHistory::forget(std::size_t blade) {
  // A blow before the stroke has the same mark.
  for (std::size_t s = saved_.size(); s-- > 0;) {
    BeforeStroke& before = saved_[s];
    if (blade < before.mark.blades || blade >= before.mark.blades + before.blades) continue;
    if (--before.strokes > 0) return;
    saved_states_.erase(s);
    saved_.erase(saved_.begin() + static_cast<std::ptrdiff_t>(s));
    return;
  }
}

void StrokeHistory::forget_undone() {
  undone_.clear();
  undone_states_.clear();
}

void StrokeHistory::clear() { *this = StrokeHistory(bounds_); }

std::pair<BeforeStroke, std::string> StrokeHistory::take_back() {
  BeforeStroke last = std::move(saved_.back());
  saved_.pop_back();
  return {std::move(last), saved_states_.pop()};
}

std::pair<BeforeStroke, std::string> StrokeHistory::undo(UndoneStroke undone, const std::string& now) {
  auto last = take_back();
  undone_.push_back(std::move(undone));
  undone_states_.push(last.second);
  undone_states_.push(now);
  drop_states();
  return last;
}

std::pair<UndoneStroke, std::string> StrokeHistory::redo() {
  UndoneStroke last = std::move(undone_.back());
  undone_.pop_back();
  std::string after = undone_states_.pop();
  saved_states_.push(undone_states_.pop());
  saved_.push_back(last.before);
  return {std::move(last), std::move(after)};
}

}  // namespace live
