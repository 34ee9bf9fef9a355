// Small `.kerf` files in memory: named arrays as strings of bytes. Bodies are read and written by parts (kerf_reader.h,
// kerf_writer.h); see docs/formats.md.
#pragma once

#include <cstdint>
#include <map>
#include <ostream>
#include <string>
#include <vector>

#include "io/kerf_append.h"
#include "io/kerf_reader.h"
#include "kerf/body.h"

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

// ---- The `.kerf` file: a body with its graph; sectioned, checked, appendable. See docs/formats.md.

/// Reads and checks a body: every section's size, range and hash, before any of it is used. Throws InputError as
/// KerfFile does, or when a section is missing, of another kind, or holds ids or numbers out of range.
Body read_body(const KerfFile& file);
Body read_body(const std::string& path);
Body parse_body(const std::string& bytes, const std::string& name);

/// Writes a body whole, and behind it `more`, which readers of bodies pass over. Deterministic: the same body gives the
/// same bytes.
void write_body(std::ostream& out, const Body& body, const std::vector<KerfArray>& more = {});

/// Brings a file up to a body, which has grown from the file's, by appending what changed. Returns how many bytes were
/// written.
std::uint64_t write_body(KerfUpdate& file, const Body& body);

}  // namespace geo
