// The checksum of PNG and zip files: CRC-32 of ISO 3309 (PNG specification, annex D).
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

namespace geo {

/// Remainders of single bytes.
inline constexpr auto crc32_table = [] {
  std::array<std::uint32_t, 256> table{};
  for (std::uint32_t i = 0; i < 256; ++i) {
    std::uint32_t c = i;
    for (int k = 0; k < 8; ++k) c = c & 1 ? 0xedb88320u ^ (c >> 1) : c >> 1;
    table[i] = c;
  }
  return table;
}();

/// The checksum's state after one more byte. The state begins with ~0, and its complement is the
/// checksum.
inline std::uint32_t crc32_after(std::uint32_t state, std::uint8_t byte) {
  return crc32_table[(state ^ byte) & 255] ^ (state >> 8);
}

/// The checksum of bytes.
inline std::uint32_t crc32(std::string_view bytes) {
  std::uint32_t state = ~0u;
  for (const char c : bytes) state = crc32_after(state, static_cast<std::uint8_t>(c));
  return ~state;
}

}  // namespace geo
