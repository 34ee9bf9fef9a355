// PLY files as elements with properties, whatever their meaning; for surface and node files.
#pragma once

#include <cstdint>

#include <string>
#include <string_view>
#include <vector>

namespace geo {

struct PlyProperty {
  std::string name;
  char type = 0, count_type = 0;    ///< c C s S i I l L f d (capital: unsigned); count_type 0: not a list
  std::vector<double> values;       ///< all rows, lists one after another
  std::vector<std::uint32_t> ends;  ///< of lists: where each row's values end
};
struct PlyElement {
  std::string name;
  std::size_t count = 0;
  std::vector<PlyProperty> properties;
  /// The property of that name; null where there is none.
  const PlyProperty* find(std::string_view property) const;
};
struct Ply {
  std::vector<PlyElement> elements;
  std::vector<std::string> comments;
  bool has_rest = false;  ///< whether bytes or lines follow the last element
  /// The element of that name; null where there is none.
  const PlyElement* find(std::string_view element) const;
};

/// Reads ASCII or binary PLY of either byte order. Values may be infinite or not a number: the
/// caller refuses them in properties that it uses. Throws InputError, with `name` first, for
/// malformed files and counts larger than the file.
Ply parse_ply(std::string_view bytes, const std::string& name);
/// Throws InputError, with `name` first, where bytes or lines follow the last element: in a file
/// that Kerf writes, they mean damage.
void require_no_rest(const Ply& ply, const std::string& name);

}  // namespace geo
