// Guards objects that change against use by two threads at once, or from a progress callable of
// their own call.
#pragma once

#include <stdexcept>

#include "gil.h"
#include "progress.h"

namespace kerf_python {

/// The object is in use by another call. Becomes kerf.Error.
struct BusyError : std::runtime_error {
  /// With the message `what`.
  using std::runtime_error::runtime_error;
};

/// The calls that use one object just now. All members are called with the GIL, which makes them
/// atomic.
class Busy {
 public:
  /// Begins a call that reads the object. Throws BusyError while one changes it.
  void begin_reading() {
    if (users_ < 0) throw BusyError("the object is being changed by another call; wait until that returns");
    ++users_;
  }
  /// Begins a call that changes the object. Throws BusyError while another one uses it.
  void begin_writing() {
    if (users_ != 0) throw BusyError("the object is in use by another call; wait until that returns");
    users_ = -1;
  }
  /// Ends a call that began.
  void end() { users_ = users_ < 0 ? 0 : users_ - 1; }

 private:
  int users_ = 0;  // −1: one that changes it
};

/// Reads an object while it lives. To be made and destroyed with the GIL.
class Reading {
 public:
  /// Throws BusyError.
  explicit Reading(Busy& busy) : busy_(busy) { busy_.begin_reading(); }
  ~Reading() { busy_.end(); }
  Reading(const Reading&) = delete;
  Reading& operator=(const Reading&) = delete;

 private:
  Busy& busy_;
};

/// Changes an object while it lives. To be made and destroyed with the GIL.
class Writing {
 public:
  /// Throws BusyError.
  explicit Writing(Busy& busy) : busy_(busy) { busy_.begin_writing(); }
  ~Writing() { busy_.end(); }
  Writing(const Writing&) = delete;
  Writing& operator=(const Writing&) = delete;

 private:
  Busy& busy_;
};

/// Runs `work` without the GIL.
template <class Work>
auto without_gil(const Work& work) {
  const GilRelease release;
  return work();
}

}  // namespace kerf_python
