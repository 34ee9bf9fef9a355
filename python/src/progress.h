// Progress of long calls: a Python callable or a tqdm bar, and Ctrl-C.
#pragma once

#include <pybind11/pybind11.h>

#include <memory>
#include <string>

#include "gil.h"
#include "kerf/progress.h"

namespace kerf_python {

namespace py = pybind11;

/// Reports of one call. The call runs without the GIL; a report takes it, at most about fifty
/// times a second, to look for Ctrl-C and to call Python.
class ProgressReport {
 public:
  /// `target`: None; a callable of (phase, done, total), which stops the call by returning False;
  /// or a bar with `n`, `total` and `update()`, as tqdm's. Throws py::type_error for another
  /// object.
  explicit ProgressReport(py::object target);
  ~ProgressReport();
  ProgressReport(const ProgressReport&) = delete;
  ProgressReport& operator=(const ProgressReport&) = delete;

  /// The function that the library calls; valid while this object lives.
  geo::Progress function();

  /// Runs `work` without the GIL. After geo::Interrupted rethrows what Python raised: the error of
  /// the callable, or KeyboardInterrupt.
  template <class Work>
  auto run(const Work& work) {
    try {
      const GilRelease release;
      return work(function());
    } catch (const geo::Interrupted&) {
      rethrow_python_error();
      throw;
    }
  }

 private:
  struct Impl;
  void rethrow_python_error();
  std::unique_ptr<Impl> impl_;
};

}  // namespace kerf_python
