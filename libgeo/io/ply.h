// PLY as a table of elements and properties, whatever they are; used by surface and node files.
#pragma once

#include <cstdint>

#include <string>
#include <string_view>
#include <vector>

namespace geo {

struct PlyProperty {
  std::string name;
  char type = 0, count_type = 0;    ///< c C s S i I f d (capital: unsigned); count_type 0: not a list
  std::vector<double> values;       ///< all rows, lists one after another
  std::vector<std::uint32_t> ends;  ///< of lists: where each row's values end
};
struct PlyElement {
  std::string name;
  std::size_t count = 0;
  std::vector<PlyProperty> properties;
  const PlyProperty* find(std::string_view property) const;
};
struct Ply {
  std::vector<PlyElement> elements;
  std::vector<std::string> comments;
  const PlyElement* find(std::string_view element) const;
};

/// ASCII or binary of either byte order. Throws InputError (name first) on anything malformed, numbers that are not
/// finite, counts that the bytes cannot hold, and bytes left over.
Ply parse_ply(std::string_view bytes, const std::string& name);

}  // namespace geo
