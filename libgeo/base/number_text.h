// Floating-point numbers from and to text: std::from_chars() and std::to_chars(), which some
// standard libraries have for integers alone (libc++ before 14, as Emscripten's).
#pragma once

#include <charconv>
#include <type_traits>

namespace geo {

/// The end of the text of a number, and whether it is one that fits.
struct NumberEnd {
  const char* end;
  bool good;
};

/// std::from_chars() by strtod(), to the same value: decimal, with "inf" and "nan", without a
/// leading blank or plus.
NumberEnd read_by_strtod(const char* begin, const char* end, double& value);
/// std::to_chars() by printf(): the shortest digits from which the value returns to the bit, in
/// fixed notation where that is not longer than with an exponent. Writes 32 characters at most, and
/// returns their end.
char* write_by_printf(char* begin, double value);
/// The same for single precision.
char* write_by_printf(char* begin, float value);

#ifdef __cpp_lib_to_chars
/// Reads a number from the beginning of a text, as std::from_chars().
inline NumberEnd read_number(const char* begin, const char* end, double& value) {
  const auto [stop, error] = std::from_chars(begin, end, value);
  return {stop, error == std::errc()};
}
/// Writes the shortest text from which a number returns, 32 characters at most; returns its end.
inline char* write_number(char* begin, auto value) { return std::to_chars(begin, begin + 32, value).ptr; }
#else
/// Reads a number from the beginning of a text, as std::from_chars().
inline NumberEnd read_number(const char* begin, const char* end, double& value) {
  return read_by_strtod(begin, end, value);
}
/// Writes the shortest text from which a number returns, 32 characters at most; returns its end.
template <class Number>
char* write_number(char* begin, Number value) {
  if constexpr (std::is_integral_v<Number>)
    return std::to_chars(begin, begin + 32, value).ptr;
  else
    return write_by_printf(begin, value);
}
#endif

}  // namespace geo
