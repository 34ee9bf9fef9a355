// While a frame is computed, the moves of a stroke become one with the whole path. Grabs keep their
// last move.
#include "live/inbox.h"

#include <algorithm>
#include <utility>

namespace live {
namespace {

// The stroke or grab that a request moves, by kind and number; kind 0: none.
std::pair<int, std::uint64_t> moved(const Request& r) {
  const auto* command = std::get_if<Command>(&r.what);
  if (!command) return {0, 0};
  if (const auto* stroke = std::get_if<Stroke>(command); stroke && stroke->phase == Phase::move) return {1, stroke->id};
  if (const auto* grab = std::get_if<Grab>(command); grab && grab->phase == Phase::move) return {2, grab->id};
  return {0, 0};
}

// Replaces a move by a later one of the same kind and number, and keeps the path between them.
void append_move(Request& move, Request&& later) {
  auto& command = std::get<Command>(later.what);
  if (auto* stroke = std::get_if<Stroke>(&command)) {
    auto& before = std::get<Stroke>(std::get<Command>(move.what));
    std::vector<EdgePose> path = std::move(before.way);
    add_pose(path, {before.origin, before.direction});
    for (const EdgePose& pose : stroke->way) add_pose(path, pose);
    stroke->way = std::move(path);
  }
  move = std::move(later);
}

}  // namespace

bool is_late_stroke(const Request& request, std::chrono::steady_clock::time_point now, double seconds) {
  const auto* command = std::get_if<Command>(&request.what);
  const auto* stroke = command ? std::get_if<Stroke>(command) : nullptr;
  return stroke && stroke->phase == Phase::begin && now - request.arrived >= std::chrono::duration<double>(seconds);
}

bool Inbox::put(Request request) {
  request.arrived = std::chrono::steady_clock::now();
  {
    const std::lock_guard lock(mutex_);
    const auto key = moved(request);
    if (key.first != 0)
      // A move behind anything else of its page stays behind it.
      for (auto at = requests_.rbegin(); at != requests_.rend(); ++at)
        if (at->page == request.page) {
          if (moved(*at) != key) break;
          append_move(*at, std::move(request));
          return true;
        }
    const bool people = std::holds_alternative<Join>(request.what) || std::holds_alternative<Leave>(request.what);
    if (requests_.size() >= longest && !people) return false;
    requests_.push_back(std::move(request));
  }
  arrived_.notify_one();
  return true;
}

std::vector<Request> Inbox::take() {
  const std::lock_guard lock(mutex_);
  return std::exchange(requests_, {});
}

void Inbox::wait_until(std::chrono::steady_clock::time_point time) {
  std::unique_lock lock(mutex_);
  arrived_.wait_until(lock, time, [&] { return !requests_.empty(); });
}

}  // namespace live
