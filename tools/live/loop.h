// The simulation loop of a live run: sample the input, compute a frame, show it, keep real time.
#pragma once

#include <functional>
#include <string>

#include "live/inbox.h"
#include "live/server.h"
#include "live/session.h"

namespace live {

struct LoopOptions {
  std::string name;               ///< of the scene
  double linger = 30;             ///< s without a page before the loop ends; 0: never
  std::function<bool()> keep_on;  ///< asked several times a second; false ends the loop
  bool waits = false;             ///< time stands still until a hand touches the body, after a reset, too
};

/// Runs until keep_on() is false, or no page is there for `linger` seconds after the last one went.
void run_loop(Session& session, Inbox& inbox, Server& server, const LoopOptions& options);

}  // namespace live
