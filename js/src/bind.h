// Common to the bindings for JavaScript: arrays in and out, errors as values, progress.
#pragma once

#include <emscripten/bind.h>
#include <emscripten/val.h>

#include <memory>
#include <string>
#include <type_traits>
#include <vector>

#include <kerf/complex.h>
#include <kerf/crack.h>
#include <kerf/error.h>
#include <kerf/mesh.h>
#include <kerf/progress.h>

namespace kerf_js {

using emscripten::val;

/// A mesh that JavaScript holds; it never changes.
struct Mesh {
  geo::TriangleMesh mesh;
};
using MeshHandle = std::shared_ptr<Mesh>;

struct Front;
/// A cracked model, with the surface that it was made of.
struct Complex {
  geo::Complex complex;
  MeshHandle model;
  std::weak_ptr<Front> moved = {};  ///< the front that made the last edit
  geo::FrontState before = {};      ///< of `moved`, before that edit
  std::uint64_t changed = 0;        ///< how often all of it was changed: fronts have ended
  bool changed_whole = false;       ///< by the last edit, of many steps: it cannot be taken back

  /// The last edit was made by no front.
  void forget_front() {
    moved.reset();
    changed_whole = false;
  }
};
using ComplexHandle = std::shared_ptr<Complex>;

/// A handle of a new mesh.
inline MeshHandle handle(geo::TriangleMesh mesh) { return std::make_shared<Mesh>(Mesh{std::move(mesh)}); }

// ---- Calls

/// The error that is being handled, as {failure: name of its class, message}. Only in a catch block.
val failure();

/// The result of a call as JavaScript's value, or failure(): no exception of C++ leaves the module.
template <class Call>
val guarded(const Call& call) {
  try {
    if constexpr (std::is_void_v<decltype(call())>) {
      call();
      return val::undefined();
    } else {
      return val(call());
    }
  } catch (...) {
    return failure();
  }
}

/// Reports to a function of (phase, done, total); undefined: to nobody. False stops the call. The
/// function must not throw.
geo::Progress progress_to(val function);

// ---- Arrays

/// A copy of some memory as a typed array of the element's type.
template <class Number>
val array_of(const Number* data, std::size_t count) {
  return val(emscripten::typed_memory_view(count, data)).template call<val>("slice");
}
/// A Float64Array of three numbers for each point.
inline val array_of(const std::vector<geo::Vec3>& points) {
  return array_of(points.empty() ? nullptr : points.data()->data(), 3 * points.size());
}
/// A Float64Array of the three coordinates.
inline val array_of(const geo::Vec3& point) { return array_of(point.data(), 3); }
/// Appends to an array of JavaScript. A handle must come as val: Emscripten deletes other arguments.
inline void append(val& array, const val& item) { array.call<void>("push", item); }
/// Numbers as a typed array.
template <class Number>
val array_of(const std::vector<Number>& numbers) {
  return array_of(numbers.data(), numbers.size());
}
/// A Uint8Array of the bytes.
inline val bytes_of(const std::string& bytes) {
  return array_of(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size());
}

/// Copies a typed array whose elements have the type Number.
template <class Number>
std::vector<Number> numbers_from(const val& array) {
  std::vector<Number> numbers(array["length"].as<std::size_t>());
  val(emscripten::typed_memory_view(numbers.size(), numbers.data())).call<void>("set", array);
  return numbers;
}
/// Points of a Float64Array with three numbers for each. Throws InputError for another length;
/// `name` stands for the argument.
std::vector<geo::Vec3> points_from(const val& array, const std::string& name);
/// The point of an array of three numbers.
geo::Vec3 point_from(const val& array, const std::string& name);
/// The bytes of a Uint8Array.
std::string text_from(const val& bytes);

/// Throws InputError where a mesh is no solid: why, and what makes one of it.
void demand_solid(const geo::TriangleMesh& mesh);

// ---- Attributes

/// Sets the attributes of a mesh from an object with uv, normals, colors (Float64Array, a row for each
/// vertex or for each corner of each face), groups (Int32Array) and groupNames; all may be absent.
/// Throws InputError for a wrong number of them.
void read_attributes(const val& given, geo::TriangleMesh& mesh);
/// An attribute by that name as an array; undefined: there is none.
val attribute_array(const geo::Attributes& attributes, const std::string& name);

// ---- Options: an object whose absent keys keep the defaults

/// Sets `out` where the object has a number of this name. Throws InputError where it is not finite
/// or out of range.
void take(const val& options, const char* name, double& out, double least, double most);
/// The same for whole numbers.
void take(const val& options, const char* name, int& out, int least, int most);
/// A seed, a whole number from 0 to 2⁵³.
void take_seed(const val& options, const char* name, std::uint64_t& out);
/// Whether the object has this key with a value.
bool has(const val& options, const char* name);

/// The faces that an edit removed and made: {removedFaces, newFaces, newCrackFaces}.
val changes(const geo::CrackDelta& delta);

/// Tolerances of cracks: snap, snapEdges, faceOffset, clearance, jitter, attempts, seed.
geo::CrackOptions crack_options(const val& options);

}  // namespace kerf_js
