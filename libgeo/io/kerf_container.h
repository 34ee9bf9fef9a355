// Small `.kerf` files in memory: named arrays as strings of bytes. Bodies are read and written by parts (kerf_reader.h,
// kerf_writer.h); see docs/formats.md.
#pragma once

#include <cstdint>
#include <map>
#include <ostream>
#include <string>
#include <vector>

#include "io/kerf_reader.h"

namespace geo {

/// Sections by name; what an array holds is its dtype and shape.
struct KerfSection {
  std::string dtype;
  std::vector<std::uint64_t> shape;
  std::string bytes;  ///< raw, little-endian
};
using KerfSections = std::map<std::string, KerfSection>;

/// A whole file. Deterministic.
void write_kerf(std::ostream& out, const KerfSections& sections);

/// All sections of a file. Throws InputError as KerfFile does.
KerfSections parse_kerf(std::string bytes, const std::string& name);

}  // namespace geo
