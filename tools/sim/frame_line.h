// What a frame came to, as JSON.
#pragma once

#include <string>

#include <kerf/simulation.h>

namespace sim {

struct FrameOutcome {
  int frame = 0;
  double time = 0;  ///< s
  std::size_t nodes = 0, faces = 0;
  geo::FrameStats work;
};

/// A line of frames.jsonl, the same in every run: without times, and without the brace that ends it. `crossings` of the
/// surface that is written.
std::string line_of(const FrameOutcome& outcome, std::size_t crossings);
/// Counts of a frame or of a run, without braces.
std::string counts(const geo::FrameStats& work);
/// Seconds by phase, as an object.
std::string seconds(const geo::FrameStats& work);
/// The same for people: "; 1.2 s: mechanics 0.8, graph 0.4", or nothing.
std::string seconds_in_words(const geo::FrameStats& work);

}  // namespace sim
