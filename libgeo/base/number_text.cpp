// printf() rounds to the nearest decimal of a given length, so the first length whose decimal is
// read back as the number is the shortest.
#include "base/number_text.h"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>

namespace geo {
namespace {

double read_back(const char* text, double) { return std::strtod(text, nullptr); }
float read_back(const char* text, float) { return std::strtof(text, nullptr); }

// Digits without a point, and the power of ten of the first one.
struct Decimal {
  std::string digits;
  int exponent;
};

template <class Number>
Decimal shortest_decimal(Number value) {
  constexpr int longest = sizeof(Number) == 4 ? 9 : 17;
  char text[40];
  for (int length = 1;; ++length) {
    std::snprintf(text, sizeof text, "%.*e", length - 1, static_cast<double>(value));
    if (length == longest || read_back(text, value) == value) break;
  }
  char* const e = std::strchr(text, 'e');
  Decimal result{std::string(text, e), std::atoi(e + 1)};
  if (result.digits.size() > 1) result.digits.erase(1, 1);
  return result;
}

std::string fixed(const Decimal& d, double value) {
  const int count = static_cast<int>(d.digits.size());
  if (d.exponent < 0) return "0." + std::string(static_cast<std::size_t>(-d.exponent - 1), '0') + d.digits;
  if (d.exponent < count - 1) {
    std::string text = d.digits;
    return text.insert(static_cast<std::size_t>(d.exponent + 1), 1, '.');
  }
  char whole[40];  // all digits of a whole number
  std::snprintf(whole, sizeof whole, "%.0f", value);
  return whole;
}

std::string scientific(const Decimal& d) {
  std::string text = d.digits;
  if (text.size() > 1) text.insert(1, 1, '.');
  char exponent[16];
  std::snprintf(exponent, sizeof exponent, "e%c%02d", d.exponent < 0 ? '-' : '+', std::abs(d.exponent));
  return text + exponent;
}

template <class Number>
char* write(char* begin, Number value) {
  std::string text = std::signbit(value) ? "-" : "";
  const Number size = std::abs(value);
  if (std::isnan(value)) {
    text += "nan";
  } else if (std::isinf(value)) {
    text += "inf";
  } else if (value == 0) {
    text += "0";
  } else {
    const Decimal d = shortest_decimal(size);
    const std::string with_exponent = scientific(d);
    // Fixed notation is longer than 30 characters outside of these bounds.
    const bool may_be_fixed = d.exponent > -28 && d.exponent < 28;
    const std::string plain = may_be_fixed ? fixed(d, static_cast<double>(size)) : std::string(32, '0');
    text += plain.size() <= with_exponent.size() ? plain : with_exponent;
  }
  return std::copy(text.begin(), text.end(), begin);
}

}  // namespace

NumberEnd read_by_strtod(const char* begin, const char* end, double& value) {
  const std::string text(begin, end);
  const std::size_t sign = !text.empty() && text[0] == '-';
  const char first = text.size() > sign ? text[sign] : ' ';
  const bool is_word = first == 'i' || first == 'I' || first == 'n' || first == 'N';
  if (!is_word && first != '.' && (first < '0' || first > '9')) return {begin, false};
  // strtod() reads hexadecimal digits, too.
  const bool is_hexadecimal = first == '0' && text.size() > sign + 1 && (text[sign + 1] | 32) == 'x';
  const std::string read = is_hexadecimal ? text.substr(0, sign + 1) : text;
  char* stop = nullptr;
  errno = 0;
  const double result = std::strtod(read.c_str(), &stop);
  const auto length = stop - read.c_str();
  if (length == 0) return {begin, false};
  if (errno == ERANGE) return {begin + length, false};
  value = result;
  return {begin + length, true};
}

char* write_by_printf(char* begin, double value) { return write(begin, value); }
char* write_by_printf(char* begin, float value) { return write(begin, value); }

}  // namespace geo
