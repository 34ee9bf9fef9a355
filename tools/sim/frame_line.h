// Statistics of a frame as JSON and as text.
#pragma once

#include <cstddef>
#include <string>

#include <kerf/simulation.h>

namespace sim {

struct FrameOutcome {
  int frame = 0;
  double time = 0;  ///< s
  std::size_t nodes = 0, faces = 0;
  geo::FrameStats stats;
};

/// A line of frames.jsonl, without the brace that ends it. It has no seconds, so it is the same in
/// every run. `crossings`: of the surface that is written.
std::string line_of(const FrameOutcome& outcome, std::size_t crossings);
/// Counts of a frame or of a run, without braces.
std::string counts(const geo::FrameStats& stats);
/// Seconds by phase, as an object.
std::string seconds(const geo::FrameStats& stats);
/// Seconds by phase as text: "; 1.2 s: mechanics 0.8, graph 0.4", or nothing.
std::string seconds_in_words(const geo::FrameStats& stats);

}  // namespace sim
