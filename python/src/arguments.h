// Arguments that pybind11 has no type for: paths and integers.
#pragma once

#include <pybind11/pybind11.h>

#include <cstdint>
#include <string>

#include "kerf/error.h"

namespace kerf_python {

namespace py = pybind11;

/// A path: of a str, bytes or os.PathLike.
struct Path {
  std::string text;
  /// The path as the library takes it.
  operator const std::string&() const { return text; }
};

/// Whether an object is a str or an os.PathLike.
inline bool is_path(py::handle object) { return py::isinstance<py::str>(object) || py::hasattr(object, "__fspath__"); }
/// The text of a path. Throws geo::InputError where it holds a zero byte, which would end messages.
/// Precondition: is_path().
inline std::string path_from(py::handle object, const std::string& name) {
  auto text = py::str(py::module_::import("os").attr("fspath")(object)).cast<std::string>();
  if (text.find('\0') != text.npos) throw geo::InputError(name + ": its path holds a zero byte; give another one");
  return text;
}

/// An integer, of NumPy's types too. Throws py::type_error, and where it does not fit 64 bits.
inline std::int64_t integer_from(py::handle object, const std::string& name) {
  if (!PyBool_Check(object.ptr()) && PyIndex_Check(object.ptr())) {
    const auto index = py::reinterpret_steal<py::object>(PyNumber_Index(object.ptr()));
    const auto value = index ? PyLong_AsLongLong(index.ptr()) : -1;
    if (!PyErr_Occurred()) return value;
    PyErr_Clear();
  }
  throw py::type_error(name + ": give an integer");
}

}  // namespace kerf_python

namespace pybind11::detail {

/// Converts to kerf_python::Path.
template <>
struct type_caster<kerf_python::Path> {
  PYBIND11_TYPE_CASTER(kerf_python::Path, const_name("os.PathLike"));
  /// False for an object that is no path.
  bool load(handle source, bool) {
    object bytes;
    PyObject* made = nullptr;
    if (!PyUnicode_FSConverter(source.ptr(), &made)) {
      PyErr_Clear();
      return false;
    }
    bytes = reinterpret_steal<object>(made);
    value.text = std::string(PyBytes_AS_STRING(made), static_cast<std::size_t>(PyBytes_GET_SIZE(made)));
    return true;
  }
  /// As str.
  static handle cast(const kerf_python::Path& path, return_value_policy, handle) {
    return PyUnicode_DecodeFSDefaultAndSize(path.text.data(), static_cast<Py_ssize_t>(path.text.size()));
  }
};

}  // namespace pybind11::detail
