// Arrays between NumPy and the library. Input is checked and copied once; output is moved into an
// array or shown as a read-only view.
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "kerf/vec.h"

namespace kerf_python {

namespace py = pybind11;

// ---- Input. `name` stands for the argument in messages. All throw geo::InputError, in one
// sentence, for another shape or element type, and for values that are not finite or out of range.

/// A (n, 3) array of floats or integers as points; each coordinate within geo::in_range().
std::vector<geo::Vec3> points_from(py::handle object, const std::string& name);
/// Three numbers as a point.
geo::Vec3 point_from(py::handle object, const std::string& name);
/// A (n, 3) array of integers as triangles; each index below `vertices`.
std::vector<geo::Triangle> triangles_from(py::handle object, const std::string& name, std::size_t vertices);
/// A (n,) array of floats or integers; each value finite.
std::vector<double> numbers_from(py::handle object, const std::string& name);
/// A (n,) array of integers, each from `least` to `greatest`.
std::vector<std::int64_t> integers_from(py::handle object, const std::string& name, std::int64_t least,
                                        std::int64_t greatest);
/// An array of floats or integers with finite values: its shape and its values, row by row. The
/// number of dimensions is `least` to `greatest`.
std::pair<std::vector<std::size_t>, std::vector<double>> values_from(py::handle object, const std::string& name,
                                                                     int least, int greatest);

// ---- Output.

/// A read-only array of `shape` over memory that `owner` keeps alive. No copy.
template <class T>
py::array view(const void* data, std::vector<py::ssize_t> shape, py::object owner) {
  py::array out(py::dtype::of<T>(), std::move(shape), {}, data, std::move(owner));
  py::detail::array_proxy(out.ptr())->flags &= ~py::detail::npy_api::NPY_ARRAY_WRITEABLE_;
  return out;
}

/// A read-only array that takes the values over. T: what the array shows; E: what the vector
/// holds, T or a fixed number of T. `inner`: the shape of one element.
template <class T, class E>
py::array moved(std::vector<E>&& values, std::vector<py::ssize_t> inner = {}) {
  auto* kept = new std::vector<E>(std::move(values));
  py::capsule owner(kept, [](void* at) { delete static_cast<std::vector<E>*>(at); });
  std::vector<py::ssize_t> shape{static_cast<py::ssize_t>(kept->size())};
  shape.insert(shape.end(), inner.begin(), inner.end());
  return view<T>(kept->data(), std::move(shape), std::move(owner));
}

/// Points as a (n, 3) array that takes them over.
inline py::array moved_points(std::vector<geo::Vec3>&& points) { return moved<double>(std::move(points), {3}); }

/// An array of ids as (n,) unsigned 32-bit integers that takes them over.
template <class Tag>
py::array moved_ids(std::vector<geo::Id<Tag>>&& ids) {
  static_assert(sizeof(geo::Id<Tag>) == sizeof(std::uint32_t));
  return moved<std::uint32_t>(std::move(ids));
}

/// A point as a (3,) array.
inline py::array point(const geo::Vec3& p) { return moved<double>(std::vector<double>{p.x(), p.y(), p.z()}); }

}  // namespace kerf_python
