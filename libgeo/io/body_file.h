// The `.kerf` file: a body with its graph; sectioned, checked, appendable. See docs/formats.md.
#pragma once

#include <ostream>
#include <string>

#include "body/body.h"

namespace geo {

constexpr std::uint32_t kerf_format_version = 1;

/// Reads and checks a body: magic, version, endianness, every section's size, range and hash, before any of it is used.
/// Throws InputError: truncated (after the last commit), newer version, damaged section, ids out of range.
Body read_body(const std::string& path);
Body parse_body(const std::string& bytes, const std::string& name);

/// Writes a body whole. Deterministic: the same body gives the same bytes.
void write_body(std::ostream& out, const Body& body);

}  // namespace geo
