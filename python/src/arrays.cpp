// The element type is looked at before NumPy converts anything: objects, text, complex numbers and
// booleans are refused by name. Then one conversion gives a contiguous array of the wanted type.
#include "arrays.h"

#include <cmath>
#include <cstring>
#include <limits>

#include "kerf/error.h"

namespace kerf_python {
namespace {

// Whether an object has this attribute, and it is True, as tensors of torch have.
bool is_true(py::handle object, const char* attribute) {
  return py::hasattr(object, attribute) && object.attr(attribute).ptr() == Py_True;
}

// The object as an array of numbers; integers only where `integers`.
py::array array_from(py::handle object, const std::string& name, bool integers) {
  const char* wanted = integers ? "an array of integers" : "an array of numbers";
  if (object.is_none()) throw geo::InputError(name + ": None given; give " + wanted);
  py::array array;
  try {
    array = py::array::ensure(object);
  } catch (py::error_already_set&) {
  }
  if (!array) {
    PyErr_Clear();
    if (is_true(object, "requires_grad"))
      throw geo::InputError(name + ": a tensor that requires a gradient; give its detach().cpu()");
    if (is_true(object, "is_cuda")) throw geo::InputError(name + ": a tensor of a GPU; give its cpu()");
    throw geo::InputError(name + ": not " + wanted + "; give one");
  }
  const char kind = array.dtype().kind();
  // A list without elements has NumPy's default type.
  if (integers && kind == 'f' && array.size() == 0) return array;
  if (!(kind == 'i' || kind == 'u' || (kind == 'f' && !integers)))
    throw geo::InputError(name + ": elements of type " + py::str(array.dtype()).cast<std::string>() + "; give " +
                          wanted);
  return array;
}

std::string shape_of(const py::array& array) {
  std::string out = "(";
  for (py::ssize_t i = 0; i < array.ndim(); ++i) out += (i ? ", " : "") + std::to_string(array.shape(i));
  return out + (array.ndim() == 1 ? ",)" : ")");
}

void require_rows_of_three(const py::array& array, const std::string& name) {
  if (array.ndim() != 2 || array.shape(1) != 3)
    throw geo::InputError(name + ": shape " + shape_of(array) + "; give (n, 3)");
}

using Doubles = py::array_t<double, py::array::c_style | py::array::forcecast>;
using Integers = py::array_t<std::int64_t, py::array::c_style | py::array::forcecast>;

// Values above the range of int64 wrap to negative ones in the conversion; they are out of range.
Integers as_integers(const py::array& array, const std::string& name) {
  auto out = Integers::ensure(array);
  if (!out) {
    PyErr_Clear();
    throw geo::InputError(name + ": cannot be converted to 64-bit integers; give int32 or int64");
  }
  if (array.dtype().kind() == 'u' && array.itemsize() == 8) {
    const auto* values = out.data();
    for (py::ssize_t i = 0; i < out.size(); ++i)
      if (values[i] < 0) throw geo::InputError(name + ": value at " + std::to_string(i) + " is out of range");
  }
  return out;
}

Doubles as_doubles(const py::array& array, const std::string& name) {
  auto out = Doubles::ensure(array);
  if (!out) {
    PyErr_Clear();
    throw geo::InputError(name + ": cannot be converted to 64-bit floats; give float32 or float64");
  }
  return out;
}

}  // namespace

std::vector<geo::Vec3> points_from(py::handle object, const std::string& name) {
  const auto array = array_from(object, name, false);
  if (array.ndim() == 1 && array.size() == 0) return {};
  require_rows_of_three(array, name);
  const auto doubles = as_doubles(array, name);
  std::vector<geo::Vec3> out(static_cast<std::size_t>(doubles.shape(0)));
  if (!out.empty()) std::memcpy(static_cast<void*>(out.data()), doubles.data(), out.size() * sizeof(geo::Vec3));
  for (std::size_t i = 0; i < out.size(); ++i)
    if (!geo::in_range(out[i]))
      throw geo::InputError(name + ": row " + std::to_string(i) + " is not finite or above 1e60; correct it");
  return out;
}

geo::Vec3 point_from(py::handle object, const std::string& name) {
  const auto array = array_from(object, name, false);
  if (array.ndim() != 1 || array.shape(0) != 3)
    throw geo::InputError(name + ": shape " + shape_of(array) + "; give three numbers");
  const auto doubles = as_doubles(array, name);
  const geo::Vec3 out(doubles.data()[0], doubles.data()[1], doubles.data()[2]);
  if (!geo::in_range(out)) throw geo::InputError(name + ": not finite or above 1e60; correct it");
  return out;
}

std::vector<geo::Triangle> triangles_from(py::handle object, const std::string& name, std::size_t vertices) {
  const auto array = array_from(object, name, true);
  if (array.ndim() == 1 && array.size() == 0) return {};
  require_rows_of_three(array, name);
  const auto integers = as_integers(array, name);
  std::vector<geo::Triangle> out(static_cast<std::size_t>(integers.shape(0)));
  const std::int64_t* at = integers.data();
  for (std::size_t i = 0; i < out.size(); ++i)
    for (std::size_t k = 0; k < 3; ++k) {
      const auto value = *at++;
      if (value < 0 || static_cast<std::uint64_t>(value) >= vertices)
        throw geo::InputError(name + ": row " + std::to_string(i) + " has index " + std::to_string(value) + ", but " +
                              std::to_string(vertices) + " vertices are given");
      out[i][k] = static_cast<std::uint32_t>(value);
    }
  return out;
}

std::vector<double> numbers_from(py::handle object, const std::string& name) {
  return values_from(object, name, 1, 1).second;
}

std::vector<std::int64_t> integers_from(py::handle object, const std::string& name, std::int64_t least,
                                        std::int64_t greatest) {
  const auto array = array_from(object, name, true);
  if (array.ndim() != 1) throw geo::InputError(name + ": shape " + shape_of(array) + "; give (n,)");
  const auto integers = as_integers(array, name);
  std::vector<std::int64_t> out(integers.data(), integers.data() + integers.size());
  for (std::size_t i = 0; i < out.size(); ++i)
    if (out[i] < least || out[i] > greatest)
      throw geo::InputError(name + ": value " + std::to_string(out[i]) + " at " + std::to_string(i) +
                            " is out of range; give " + std::to_string(least) + " to " + std::to_string(greatest));
  return out;
}

std::pair<std::vector<std::size_t>, std::vector<double>> values_from(py::handle object, const std::string& name,
                                                                     int least, int greatest) {
  const auto array = array_from(object, name, false);
  if (array.ndim() < least || array.ndim() > greatest)
    throw geo::InputError(name + ": shape " + shape_of(array) + "; give " + std::to_string(least) +
                          (least == greatest ? "" : " to " + std::to_string(greatest)) +
                          (greatest == 1 ? " dimension" : " dimensions"));
  const auto doubles = as_doubles(array, name);
  std::vector<std::size_t> shape(doubles.shape(), doubles.shape() + doubles.ndim());
  std::vector<double> values(doubles.data(), doubles.data() + doubles.size());
  for (std::size_t i = 0; i < values.size(); ++i)
    if (!std::isfinite(values[i]))
      throw geo::InputError(name + ": value " + std::to_string(i) + " is not finite; correct it");
  return {std::move(shape), std::move(values)};
}

}  // namespace kerf_python
