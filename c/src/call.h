// The border between C and C++: no exception passes it, and arguments are checked.
#pragma once

#include <cmath>
#include <new>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "handle.h"
#include "kerf.h"
#include "kerf/error.h"
#include "kerf/progress.h"
#include "kerf/vec.h"

namespace kerf_c {

/// An argument cannot be used.
struct ArgumentError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Keeps the message of a call that failed, and returns its status.
kerf_status failed(kerf_status status, const char* message) noexcept;
/// The status of the exception that is being handled, whose message is kept.
kerf_status status_of_exception() noexcept;

/// Runs the body of a function of kerf.h.
template <class Body>
kerf_status call(const Body& body) noexcept {
  try {
    body();
    return KERF_OK;
  } catch (...) {
    return status_of_exception();
  }
}

/// Throws ArgumentError where a pointer is null; `name` is the argument's.
template <class T>
T& required(T* pointer, const char* name) {
  if (!pointer) throw ArgumentError(std::string(name) + " is null; give its address");
  return *pointer;
}

/// A place for a handle that is made, null until then.
template <class H>
class NewHandle {
 public:
  /// Writes to `out`.
  NewHandle(H* out, const char* name) : out_(required(out, name)) { out_ = nullptr; }
  /// Hands the object out.
  void set(std::shared_ptr<Object> object) { out_ = static_cast<H>(handle_for(std::move(object))); }

 private:
  H& out_;
};

/// An array of the caller. Throws ArgumentError where it is null and has a length, or where the
/// length is no multiple of `width`.
template <class T>
std::span<const T> array_of(const T* data, std::size_t length, std::size_t width, const char* name) {
  if (!data && length > 0) throw ArgumentError(std::string(name) + " is null, and its length is not 0");
  if (length % width != 0)
    throw ArgumentError(std::string(name) + ": the length " + std::to_string(length) + " is no multiple of " +
                        std::to_string(width));
  if (length > std::size_t(1) << 36) throw ArgumentError(std::string(name) + ": the length is too large");
  return {data, length};
}
/// A text of the caller.
inline std::string text_of(const char* text, const char* name) { return &required(text, name); }
/// A path of the caller. Throws ArgumentError for "-": a library leaves its program's streams alone.
inline std::string path_of(const char* path, const char* name) {
  std::string text = text_of(path, name);
  if (text.empty() || text == "-") throw ArgumentError(std::string(name) + ": give the name of a file");
  return text;
}
/// Bytes of the caller.
inline std::string bytes_of(const std::uint8_t* bytes, std::size_t length, const char* name) {
  const auto all = array_of(bytes, length, 1, name);
  return {reinterpret_cast<const char*>(all.data()), all.size()};
}
/// A point. Throws ArgumentError where a coordinate is not finite or larger than files may have.
geo::Vec3 point_of(const double* point, const char* name);
/// Points. Throws as point_of().
std::vector<geo::Vec3> points_of(const double* points, std::size_t length, const char* name);
/// A number from `low` to `high`. Throws ArgumentError for others.
double number_of(double value, double low, double high, const char* name);
/// Whether a flag is set. Throws ArgumentError for numbers but 0 and 1.
bool flag_of(std::int32_t value, const char* name);

/// A callback as the library takes it.
geo::Progress progress_of(kerf_progress progress, void* user);

/// Copies a vector to three numbers of the caller's.
inline void copy_point(const geo::Vec3& from, double (&to)[3]) {
  for (int i = 0; i < 3; ++i) to[i] = from[i];
}
/// Copies a matrix to nine numbers of the caller's, by rows.
inline void copy_matrix(const geo::Mat3& from, double (&to)[9]) {
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) to[3 * i + j] = from(i, j);
}

/// Copies numbers to an array of the caller, and their count to `needed`. With a null array of
/// length 0 there is the count alone. Throws ArgumentError where the array is too short.
void copy_out(std::span<const double> values, double* out, std::size_t length, std::size_t* needed);

}  // namespace kerf_c
