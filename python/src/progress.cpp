// An error of the Python side is kept until the library has unwound, then raised by the caller.
#include "progress.h"

#include <chrono>
#include <mutex>
#include <optional>

namespace kerf_python {
namespace {

constexpr auto interval = std::chrono::milliseconds(20);

}  // namespace

struct ProgressReport::Impl {
  py::object target;
  bool bar = false;
  std::string phase;
  std::mutex mutex;  // reports may come from several threads
  std::chrono::steady_clock::time_point next = std::chrono::steady_clock::now();
  std::optional<py::error_already_set> error;

  // With the GIL. False stops the call.
  bool tell(const std::string& new_phase, std::size_t done, std::size_t total) {
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
    if (target.is_none()) return true;
    if (!bar) {
      const py::object answer = target(new_phase, done, total);
      return answer.is_none() || answer.cast<bool>();
    }
    if (new_phase != phase) {
      phase = new_phase;
      if (py::hasattr(target, "set_description")) target.attr("set_description")(phase, py::arg("refresh") = false);
      target.attr("n") = 0;
    }
    target.attr("total") = total;
    target.attr("update")(py::int_(done) - target.attr("n"));
    return true;
  }
};

ProgressReport::ProgressReport(py::object target) : impl_(std::make_unique<Impl>()) {
  impl_->bar = py::hasattr(target, "update") && py::hasattr(target, "n") && py::hasattr(target, "total");
  if (!target.is_none() && !impl_->bar && !PyCallable_Check(target.ptr()))
    throw py::type_error("progress: give a callable of (phase, done, total), or a bar such as tqdm's");
  impl_->target = std::move(target);
}

ProgressReport::~ProgressReport() = default;

geo::Progress ProgressReport::function() {
  return [impl = impl_.get()](std::string_view phase, std::size_t done, std::size_t total) {
    std::unique_lock lock(impl->mutex, std::try_to_lock);
    if (!lock) return true;  // another thread reports just now
    if (impl->error || is_ending()) return false;
    const auto now = std::chrono::steady_clock::now();
    if (now < impl->next && done != total) return true;
    impl->next = now + interval;
    const GilAcquire gil;
    try {
      return impl->tell(std::string(phase), done, total);
    } catch (py::error_already_set& error) {
      impl->error = error;
    } catch (const py::cast_error&) {
      PyErr_SetString(PyExc_TypeError, "progress: return None, True or False");
      impl->error = py::error_already_set();
    }
    return false;
  };
}

void ProgressReport::rethrow_python_error() {
  if (impl_->error) throw std::move(*impl_->error);
}

}  // namespace kerf_python
