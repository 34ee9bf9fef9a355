// Layout of a `.kerf` file around its arrays: segment heads, commit records, types and hashes
// (docs/formats.md).
#pragma once

#include <bit>
#include <charconv>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <vector>

#include "kerf/files.h"

namespace geo::kerf {

static_assert(std::endian::native == std::endian::little, "files are little-endian");

constexpr std::size_t alignment = 64;
constexpr std::size_t hash_block = 1 << 18;           ///< bytes that are hashed together
constexpr std::uint64_t literal = ~std::uint64_t(0);  ///< `from` of a run whose rows are stored with it

/// The next multiple of `alignment`.
constexpr std::uint64_t aligned(std::uint64_t at) { return (at + alignment - 1) / alignment * alignment; }

/// XXH3 hash of some bytes.
inline std::uint64_t hash_of(const void* bytes, std::size_t size) {
  return fingerprint({static_cast<const char*>(bytes), size});
}

/// Hash of a section from the hashes of its blocks, which several threads compute.
inline std::uint64_t hash_of(const std::vector<std::uint64_t>& blocks) {
  return hash_of(blocks.data(), 8 * blocks.size());
}

/// A hash as 16 hexadecimal digits.
inline std::string hex(std::uint64_t hash) {
  std::string text(16, '0');
  for (int i = 15; i >= 0; --i, hash >>= 4) text[static_cast<std::size_t>(i)] = "0123456789abcdef"[hash & 15];
  return text;
}

/// Size of one number in bytes; 0 for a type that this version does not know.
inline std::size_t size_of(const std::string& dtype) {
  return dtype == "f8" || dtype == "u8"                    ? 8
         : dtype == "f4" || dtype == "u4" || dtype == "i4" ? 4
         : dtype == "u2"                                   ? 2
         : dtype == "u1" || dtype == "json"                ? 1
                                                           : 0;
}

/// Beginning of a segment. As in PNG, the magic is broken by any transfer as text: it has a byte
/// above 127, CR LF, an end-of-file byte and LF.
struct Head {
  char magic[9] = {'\x8b', 'K', 'E', 'R', 'F', '\r', '\n', '\x1a', '\n'};
  char zero[3] = {};
  std::uint32_t version = 2, endian = 0x01020304;
  std::uint32_t number = 0;                   ///< of the segment, from 0
  std::uint64_t table = 0, table_length = 0;  ///< where the table is
  std::uint64_t previous = 0;                 ///< hash of the commit record before
  std::uint64_t reserved = 0;
  std::uint64_t hash = 0;  ///< of all before it
  /// The hash that the record must have.
  std::uint64_t own_hash() const { return hash_of(this, sizeof *this - 8); }
};
static_assert(sizeof(Head) == 64);

/// End of a segment. A segment without it is ignored.
struct Commit {
  char word[8] = {'K', 'C', 'O', 'M', 'M', 'I', 'T', '\n'};
  std::uint32_t number = 0, zero = 0;
  std::uint64_t table = 0, table_length = 0, table_hash = 0;
  std::uint64_t head_hash = 0;
  std::uint64_t reserved = 0;
  std::uint64_t hash = 0;  ///< of all before it
  /// The hash that the record must have.
  std::uint64_t own_hash() const { return hash_of(this, sizeof *this - 8); }
};
static_assert(sizeof(Commit) == 64);

/// Rows of an array: `count` rows of the array before, from row `from` on, or literal ones.
struct Run {
  std::uint64_t from = literal, count = 0;
};
static_assert(sizeof(Run) == 16);

/// The bytes of a value.
template <class T>
std::span<const std::byte> bytes_of_one(const T& value) {
  return std::as_bytes(std::span<const T, 1>(&value, 1));
}

}  // namespace geo::kerf
