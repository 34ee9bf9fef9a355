// Writes frames in a thread of its own, while the next ones are computed.
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

#include <kerf/contact.h>
#include <kerf/files.h>
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
  /// `log`: lines of the frames before. `json`: lines also go to standard output, with their
  /// seconds.
  FrameWriter(const RunFolder& folder, std::string log, bool json);
  /// Writes the frames that wait, unless one failed.
  ~FrameWriter();
  FrameWriter(const FrameWriter&) = delete;
  FrameWriter& operator=(const FrameWriter&) = delete;

  /// Takes a frame; blocks while several wait. Throws the error of an earlier frame, in general
  /// OutputError.
  void add(Frame frame);
  /// Waits until all frames are on the disk, and returns the log with their lines. Throws as add().
  const std::string& log();

 private:
  void run();
  void write(const Frame& frame);
  void write(const std::string& path, const std::function<void(std::ostream&)>& content);
  void wait_for_queue(std::unique_lock<std::mutex>& lock, std::size_t length);

  static constexpr std::size_t queue_length = 4;
  RunFolder folder_;
  std::string log_;
  std::vector<std::string> written_;  // since log() was called
  geo::CrossingCounter crossings_;    // of the frames in order
  bool json_, busy_ = false, ended_ = false;
  std::deque<Frame> waiting_;
  std::exception_ptr error_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::thread thread_;
};

}  // namespace sim
