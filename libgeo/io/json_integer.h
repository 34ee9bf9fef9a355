// Integers in JSON, checked: the conversion of nlohmann/json accepts numbers out of range.
#pragma once

#include <limits>
#include <nlohmann/json.hpp>
#include <stdexcept>

namespace geo {

/// The integer that a value holds. Throws std::out_of_range where it is no integer, or out of the
/// range of T.
template <class T>
T json_integer(const nlohmann::json& value) {
  bool fits = false;
  if (value.is_number_unsigned())
    fits = value.get<std::uint64_t>() <= static_cast<std::uint64_t>(std::numeric_limits<T>::max());
  else if (value.is_number_integer())
    fits = value.get<std::int64_t>() >= static_cast<std::int64_t>(std::numeric_limits<T>::min());
  if (!fits) throw std::out_of_range("not an integer of this type");
  return value.get<T>();
}

}  // namespace geo
