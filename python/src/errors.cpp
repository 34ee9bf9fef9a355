// Exceptions of the library as Python classes. Each also derives from Python's own class of its
// kind, so that `except ValueError` and `except OSError` work.
#include "kerf/error.h"

#include <cstring>

#include "bind.h"
#include "busy.h"

namespace kerf_python {
namespace {

// The classes; the module keeps them alive.
struct Classes {
  PyObject *error, *input, *missing, *geometry, *output, *interrupted;
} classes;

PyObject* make_class(py::module_& module, const char* name, const char* doc, py::tuple bases) {
  const auto full = std::string("kerf.") + name;
  PyObject* made = PyErr_NewExceptionWithDoc(full.c_str(), doc, bases.ptr(), nullptr);
  if (!made) throw py::error_already_set();
  module.add_object(name, made);  // steals nothing: adds a reference of its own
  return made;
}

// Messages quote bytes of files, which may be no UTF-8.
void raise(PyObject* type, const char* message) {
  const auto text = py::reinterpret_steal<py::object>(
      PyUnicode_DecodeUTF8(message, static_cast<py::ssize_t>(std::strlen(message)), "backslashreplace"));
  if (text) PyErr_SetObject(type, text.ptr());
}

void translate(std::exception_ptr pointer) {
  try {
    if (pointer) std::rethrow_exception(pointer);
  } catch (const geo::MissingInputError& e) {
    raise(classes.missing, e.what());
  } catch (const geo::InputError& e) {
    raise(classes.input, e.what());
  } catch (const geo::GeometryError& e) {
    raise(classes.geometry, e.what());
  } catch (const geo::OutputError& e) {
    raise(classes.output, e.what());
  } catch (const geo::Interrupted& e) {
    raise(classes.interrupted, e.what());
  } catch (const BusyError& e) {
    raise(classes.error, e.what());
  }
}

}  // namespace

void bind_errors(py::module_& module) {
  const py::handle exception = PyExc_Exception;
  classes.error =
      make_class(module, "Error", "Base of all errors that the module raises by itself.", py::make_tuple(exception));
  const py::handle error = classes.error;
  classes.input = make_class(module, "InputError", "The input is invalid. The message says what to correct.",
                             py::make_tuple(error, py::handle(PyExc_ValueError)));
  classes.missing = make_class(module, "MissingInputError", "The input file does not exist or cannot be opened.",
                               py::make_tuple(py::handle(classes.input), py::handle(PyExc_FileNotFoundError)));
  classes.geometry =
      make_class(module, "GeometryError", "A geometric operation failed on valid input; its operands are unchanged.",
                 py::make_tuple(error, py::handle(PyExc_RuntimeError)));
  classes.output = make_class(module, "OutputError", "The output cannot be written.",
                              py::make_tuple(error, py::handle(PyExc_OSError)));
  classes.interrupted = make_class(module, "Interrupted", "The progress callable stopped the call; nothing changed.",
                                   py::make_tuple(error));
  py::register_exception_translator(translate);
}

}  // namespace kerf_python
