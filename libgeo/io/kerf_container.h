// The container of `.kerf` files: named, hashed, aligned arrays that can be appended to. See docs/formats.md.
#pragma once

#include <cstdint>
#include <map>
#include <ostream>
#include <string>
#include <string_view>
#include <vector>

namespace geo {

/// Sections by name; what an array holds is its dtype (f8, f4, u4, i4, u1, json) and shape.
struct KerfSection {
  std::string dtype;
  std::vector<std::uint64_t> shape;
  std::string bytes;  ///< raw, little-endian
};
using KerfSections = std::map<std::string, KerfSection>;

/// Header, sections, table, commit record. Deterministic.
void write_kerf(std::ostream& out, const KerfSections& sections);

/// Everything up to the last complete commit record. Throws InputError (name first): not a .kerf file, damaged by a text
/// transfer, of a newer version, of the other byte order, without a complete commit, a section out of range or with
/// another hash than its table says. `committed`, where given, receives how many bytes belong to the last commit.
KerfSections parse_kerf(std::string_view bytes, const std::string& name, std::uint64_t* committed = nullptr);

/// True when the bytes begin like a .kerf file.
bool looks_like_kerf(std::string_view bytes);

}  // namespace geo
