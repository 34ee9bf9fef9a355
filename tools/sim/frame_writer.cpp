#include "sim/frame_writer.h"

#ifdef __linux__
#include <sys/resource.h>
#include <unistd.h>
#endif

#include <iostream>

#include <kerf/parallel.h>
#include <kerf/stream.h>
#include <kerf/surface_file.h>

namespace sim {
namespace {

// What goes on in this thread gives way to all else, so that frames to come do not wait for those
// that are done.
void give_way() {
#ifdef __linux__
  setpriority(PRIO_PROCESS, static_cast<id_t>(gettid()), 10);  // without it, it is only slower
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

void FrameWriter::wait_until_waiting(std::unique_lock<std::mutex>& lock, std::size_t most) {
  changed_.wait(lock, [&] { return error_ || waiting_.size() + (busy_ ? 1 : 0) <= most; });
  if (error_) std::rethrow_exception(error_);
}

void FrameWriter::add(Frame frame) {
  std::unique_lock lock(mutex_);
  wait_until_waiting(lock, most_waiting);
  waiting_.push_back(std::move(frame));
  changed_.notify_all();
}

const std::string& FrameWriter::log() {
  std::unique_lock lock(mutex_);
  wait_until_waiting(lock, 0);
  geo::flush_to_disk(written_);
  written_.clear();
  return log_;
}

void FrameWriter::run() {
  give_way();
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
    busy_ = false, error_ = error;
    changed_.notify_all();
    if (error_) return;
  }
}

void FrameWriter::write(const std::string& path, const std::function<void(std::ostream&)>& how) {
  geo::write_all(path, how, geo::Sync::by_system);
  written_.push_back(path);
}

void FrameWriter::write(const Frame& frame) {
  const int i = frame.outcome.frame;
  write(folder_.nodes(i), [&](std::ostream& out) { geo::write_frame_nodes(out, frame.nodes); });
  if (!frame.obstacles.triangles.empty())
    write(folder_.obstacles(i), [&](std::ostream& out) { geo::write_ply(out, frame.obstacles); });
  write(folder_.frame(i), [&](std::ostream& out) { geo::write_ply(out, frame.surface); });
  if (i == 0) return;  // nothing has happened yet
  const std::string line = line_of(frame.outcome, crossings_.count(frame.surface));
  log_ += line + "}\n";
  if (json_) std::cout << line << ",\"seconds\":" << seconds(frame.outcome.work) << "}\n" << std::flush;
}

}  // namespace sim
