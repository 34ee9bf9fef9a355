// Arrays for a page: differences of integers in byte planes, one zlib stream, base64.
// page/unpack.js decodes them.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include <kerf/vec.h>

namespace view {

/// Bytes as base64 (RFC 4648).
std::string base64(const std::string& bytes);

class Pack {
 public:
  /// Adds integers of `width` bytes (1, 2, 4) in rows of `columns`. Differences are taken to the
  /// row before, or to the array `base`, which has the same length and was added before.
  void whole(const std::string& name, const std::vector<std::uint32_t>& values, int width, int columns,
             const std::string& base = {});
  /// Adds numbers, quantised to 16 bits between their smallest and largest, or between lo and hi.
  void scaled(const std::string& name, const std::vector<double>& values);
  void scaled(const std::string& name, const std::vector<double>& values, double lo, double hi,
              const std::string& base = {});
  /// Adds points, quantised to 16 bits for each axis within `box`. The page has them relative to
  /// the centre of the box, in half diagonals.
  void points(const std::string& name, const std::vector<geo::Vec3>& values, const geo::Box3& box,
              const std::string& base = {});
  /// The same for points that may be outside the box: they are quantised within `around`.
  void points(const std::string& name, const std::vector<geo::Vec3>& values, const geo::Box3& box,
              const geo::Box3& around, const std::string& base);

  bool has(const std::string& name) const { return values_.count(name) > 0; }
  /// True where the array of that name has these values.
  bool holds(const std::string& name, const std::vector<std::uint32_t>& values) const {
    return has(name) && values_.at(name) == values;
  }
  std::size_t length(const std::string& name) const { return values_.at(name).size(); }

  /// The description of the arrays for the page: an object for each, in the order of adding.
  const nlohmann::ordered_json& manifest() const { return manifest_; }
  /// All bytes, deflated, as base64. Throws OutputError where memory is short.
  std::string text() const;

 private:
  std::string bytes_;
  nlohmann::ordered_json manifest_ = nlohmann::ordered_json::array();
  std::map<std::string, std::vector<std::uint32_t>> values_;
};

}  // namespace view
