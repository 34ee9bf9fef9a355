// Keyword arguments that fill a structure of options: taken one by one, with their ranges.
#pragma once

#include <pybind11/pybind11.h>

#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

namespace kerf_python {

namespace py = pybind11;

/// Keyword arguments of one call. Arguments that are not given leave their option as it is.
class Keywords {
 public:
  /// `call`: the function's name, for messages.
  Keywords(py::kwargs given, std::string call);

  /// A number from `least` to `greatest`. Throws py::type_error or geo::InputError.
  void take(const char* name, double& out, double least = -std::numeric_limits<double>::max(),
            double greatest = std::numeric_limits<double>::max());
  /// An integer from `least` to `greatest`. Throws py::type_error or geo::InputError.
  template <class T>
  void take(const char* name, T& out, std::int64_t least, std::int64_t greatest) {
    out = static_cast<T>(integer(name, static_cast<std::int64_t>(out), least, greatest));
  }
  /// A seed: an integer from 0 to 2⁶³ − 1. Throws py::type_error or geo::InputError.
  void seed(const char* name, std::uint64_t& out);
  /// True or False. Throws py::type_error.
  void flag(const char* name, bool& out);
  /// Whether an argument is given and not taken yet.
  bool given(const char* name) const { return left_.contains(name); }
  /// Throws geo::InputError where `name` is given without `companion`, which it says more about.
  void require(const char* name, const char* companion) const;
  /// Any object; none where it is not given.
  py::object object(const char* name);

  /// Throws py::type_error, with the nearest name, where an argument is left.
  void finish() const;

 private:
  std::int64_t integer(const char* name, std::int64_t value, std::int64_t least, std::int64_t greatest);

  py::dict left_;
  std::string call_;
  std::vector<std::string> known_;
};

}  // namespace kerf_python
