// Frames go to the disk while the next ones are worked out.
#pragma once

#include <condition_variable>
#include <deque>
#include <exception>
#include <functional>
#include <mutex>
#include <ostream>
#include <string>
#include <thread>
#include <vector>

#include <kerf/crossing.h>
#include <kerf/run_files.h>
#include "sim/frame_line.h"
#include "sim/run_folder.h"

namespace sim {

struct Frame {
  FrameOutcome outcome;
  geo::TriangleMesh surface;
  geo::FrameNodes nodes;
  geo::TriangleMesh obstacles;  ///< empty: no file
};

class FrameWriter {
 public:
  /// `log`: lines of frames before. `json`: each frame's line goes to standard output, too, with its seconds.
  FrameWriter(const RunFolder& folder, std::string log, bool json);
  /// Writes what it was given, as far as it can.
  ~FrameWriter();
  FrameWriter(const FrameWriter&) = delete;
  FrameWriter& operator=(const FrameWriter&) = delete;

  /// Waits while many frames are waiting. Throws what went wrong with an earlier one, OutputError as a rule.
  void add(Frame frame);
  /// Waits until all are written, and on the disk; then the log's text has their lines. Throws as add() does.
  const std::string& log();

 private:
  void run();
  void write(const Frame& frame);
  void write(const std::string& path, const std::function<void(std::ostream&)>& how);
  void wait_until_waiting(std::unique_lock<std::mutex>& lock, std::size_t most);

  static constexpr std::size_t most_waiting = 4;
  RunFolder folder_;
  std::string log_;
  std::vector<std::string> written_;  // since log() was called
  geo::CrossingCounter crossings_;    // of frames in their order
  bool json_, busy_ = false, ended_ = false;
  std::deque<Frame> waiting_;
  std::exception_ptr error_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::thread thread_;
};

}  // namespace sim
