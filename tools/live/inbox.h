// Requests of pages, on their way from the network thread to the simulation thread.
#pragma once

#include <chrono>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <string>
#include <variant>
#include <vector>

#include "live/command.h"
#include "live/model_file.h"
#include "live/snapshot.h"

namespace live {

/// A page came, or went.
struct Join {};
struct Leave {};
/// The simulation's answer to a request of HTTP.
struct Answer {
  std::string error = {};  ///< empty: it was obeyed
  std::string bytes = {};  ///< of a file
  std::string name = {};   ///< of the file
};
/// A file is wanted. `answer` may be called on any thread, once, while the server lives.
struct Save {
  std::string format;  ///< kerf, ply, glb, stl, toml, or model: as it was opened
  std::function<void(Answer)> answer;
};
/// A model is to be opened in place of the one that is shown. `answer`: as in Save.
struct Open {
  ModelFile model;
  std::function<void(Answer)> answer;
};

struct Request {
  ClientId page = 0;
  std::variant<Command, Join, Leave, Save, Open> what;
  std::chrono::steady_clock::time_point arrived = {};  ///< set by Inbox::put()
};

/// Whether a request is the begin of a stroke that waited for `seconds` or longer.
bool is_late_stroke(const Request& request, std::chrono::steady_clock::time_point now, double seconds);

/// A queue in which a pointer's move takes the place of the move before it. Strokes keep their
/// path.
class Inbox {
 public:
  /// Appends a request. False where the queue is full; nothing is kept then, except of pages that
  /// come or go.
  bool put(Request request);
  /// Takes all requests, in order.
  std::vector<Request> take();
  /// Waits until there is a request, at most until `time`.
  void wait_until(std::chrono::steady_clock::time_point time);

 private:
  static constexpr std::size_t longest = 1024;
  std::mutex mutex_;
  std::condition_variable arrived_;
  std::vector<Request> requests_;
};

}  // namespace live
