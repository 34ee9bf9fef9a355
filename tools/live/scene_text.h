// A scene and the statistics of a frame, as JSON for pages.
#pragma once

#include <cstdint>
#include <string>

#include "live/session.h"

namespace live {

/// How the run keeps up with real time.
struct Pace {
  double fps = 0;   ///< frames computed per second
  double rate = 0;  ///< simulated seconds per second
  double step = 0;  ///< seconds that a frame takes to compute, mean
  Effort effort;    ///< in force
  bool paused = false;
  std::string message;  ///< of the last seconds; may be empty
};

/// The JSON of STATE. `run`: a number that changes where another model is opened; `from_gallery`:
/// whether the gallery has the body by this name.
std::string scene_text(const Session& session, const std::string& name, std::uint64_t run = 1,
                       bool from_gallery = false);
/// The statistics of FRAME, without the last brace.
std::string statistics_text(const Session& session, const Pace& pace);

}  // namespace live
