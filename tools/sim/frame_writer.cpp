// A queue between two threads with one mutex. A failed write is thrown by the next call.
#include "sim/frame_writer.h"

#ifdef __linux__
#include <sys/resource.h>
#include <unistd.h>
#endif

#include <iostream>

#include <kerf/files.h>
#include <kerf/parallel.h>

namespace sim {
namespace {

// Lowers the priority of this thread: computing the next frames comes first.
void lower_priority() {
#ifdef __linux__
  setpriority(PRIO_PROCESS, static_cast<id_t>(gettid()), 10);  // a failure only costs time
#endif
}

}  // namespace

FrameWriter::FrameWriter(const RunFolder& folder, std::string log, bool json)
    : folder_(folder), log_(std::move(log)), json_(json), thread_([this] { run(); }) {}

FrameWriter::~FrameWriter() {
  {
    const std::lock_guard lock(mutex_);
    ended_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

void FrameWriter::wait_for_queue(std::unique_lock<std::mutex>& lock, std::size_t length) {
  changed_.wait(lock, [&] { return error_ || waiting_.size() + (busy_ ? 1 : 0) <= length; });
  if (error_) std::rethrow_exception(error_);
}

void FrameWriter::add(Frame frame) {
  std::unique_lock lock(mutex_);
  wait_for_queue(lock, queue_length);
  waiting_.push_back(std::move(frame));
  changed_.notify_all();
}

const std::string& FrameWriter::log() {
  std::unique_lock lock(mutex_);
  wait_for_queue(lock, 0);
  geo::flush_to_disk(written_);
  written_.clear();
  return log_;
}

void FrameWriter::run() {
  lower_priority();
  const geo::SerialScope serial;
  std::unique_lock lock(mutex_);
  for (;;) {
    changed_.wait(lock, [&] { return ended_ || !waiting_.empty(); });
    if (waiting_.empty() || error_) return;
    const Frame frame = std::move(waiting_.front());
    waiting_.pop_front();
    busy_ = true;
    lock.unlock();
    std::exception_ptr error;
    try {
      write(frame);
    } catch (...) {
      error = std::current_exception();
    }
    lock.lock();
    busy_ = false;
    error_ = error;
    changed_.notify_all();
    if (error_) return;
  }
}

void FrameWriter::write(const std::string& path, const std::function<void(std::ostream&)>& content) {
  geo::write_all(path, content, geo::Sync::by_system);
  written_.push_back(path);
}

void FrameWriter::write(const Frame& frame) {
  const int i = frame.outcome.frame;
  write(folder_.nodes(i), [&](std::ostream& out) { geo::write_frame_nodes(out, frame.nodes); });
  if (!frame.obstacles.triangles.empty())
    write(folder_.obstacles(i), [&](std::ostream& out) { geo::write_ply(out, frame.obstacles); });
  write(folder_.frame(i), [&](std::ostream& out) { geo::write_ply(out, frame.surface); });
  if (i == 0) return;  // the initial state has no statistics
  const std::string line = line_of(frame.outcome, crossings_.count(frame.surface));
  log_ += line + "}\n";
  if (json_) std::cout << line << ",\"seconds\":" << seconds(frame.outcome.stats) << "}\n" << std::flush;
}

}  // namespace sim
