// std::bit_cast, which some standard libraries lack (libc++ before 14, as Emscripten's).
#pragma once

#include <cstring>
#include <type_traits>

namespace geo {

/// The value of type To that has the bytes of `from`.
template <class To, class From>
To bit_cast(const From& from) noexcept {
  static_assert(sizeof(To) == sizeof(From) && std::is_trivially_copyable_v<To> && std::is_trivially_copyable_v<From>);
  To to;
  std::memcpy(&to, &from, sizeof(To));
  return to;
}

}  // namespace geo
