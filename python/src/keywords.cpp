// Numbers are converted by Python's own protocols, so that NumPy's scalars fit; booleans and text
// do not.
#include "keywords.h"

#include <cmath>

#include "kerf/error.h"

namespace kerf_python {
namespace {

std::string text(double value) { return py::repr(py::float_(value)).cast<std::string>(); }

}  // namespace

Keywords::Keywords(py::kwargs given, std::string call) : left_(), call_(std::move(call)) {
  for (const auto& [name, value] : given) left_[name] = value;
}

py::object Keywords::object(const char* name) {
  known_.push_back(name);
  if (!left_.contains(name)) return py::none();
  return left_.attr("pop")(name);
}

void Keywords::require(const char* name, const char* companion) const {
  if (given(name) && !given(companion))
    throw geo::InputError(call_ + ": " + name + " changes nothing without " + companion + "; give both");
}

void Keywords::take(const char* name, double& out, double least, double greatest) {
  const py::object value = object(name);
  if (value.is_none()) return;
  const bool refused = PyBool_Check(value.ptr()) || py::isinstance<py::str>(value);
  const double number = refused ? 0 : PyFloat_AsDouble(value.ptr());
  if (refused || PyErr_Occurred()) {
    PyErr_Clear();
    throw py::type_error(call_ + ": " + name + " must be a number");
  }
  if (!(number >= least && number <= greatest)) {
    const double most = std::numeric_limits<double>::max();
    throw geo::InputError(call_ + ": " + name + " must be " +
                          (least == -most     ? "finite"
                           : greatest == most ? "finite and at least " + text(least)
                                              : "from " + text(least) + " to " + text(greatest)));
  }
  out = number;
}

std::int64_t Keywords::integer(const char* name, std::int64_t value, std::int64_t least, std::int64_t greatest) {
  const py::object given = object(name);
  if (given.is_none()) return value;
  if (PyBool_Check(given.ptr()) || !PyIndex_Check(given.ptr()))
    throw py::type_error(call_ + ": " + name + " must be an integer");
  const auto index = py::reinterpret_steal<py::object>(PyNumber_Index(given.ptr()));
  if (!index) throw py::error_already_set();
  int overflow = 0;
  const auto number = PyLong_AsLongLongAndOverflow(index.ptr(), &overflow);
  if (overflow != 0 || number < least || number > greatest)
    throw geo::InputError(call_ + ": " + name + " must be from " + std::to_string(least) + " to " +
                          std::to_string(greatest));
  return number;
}

void Keywords::seed(const char* name, std::uint64_t& out) {
  out = static_cast<std::uint64_t>(
      integer(name, static_cast<std::int64_t>(out), 0, std::numeric_limits<std::int64_t>::max()));
}

void Keywords::flag(const char* name, bool& out) {
  const py::object value = object(name);
  if (value.is_none()) return;
  if (!PyBool_Check(value.ptr())) throw py::type_error(call_ + ": " + name + " must be True or False");
  out = value.is(py::bool_(true));
}

void Keywords::finish() const {
  if (left_.empty()) return;
  const auto name = py::str(left_.begin()->first).cast<std::string>();
  throw py::type_error(call_ + ": no argument is named '" + name + "'" + geo::did_you_mean(name, known_));
}

}  // namespace kerf_python
