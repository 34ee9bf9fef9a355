// Arrays for a page: integers as differences in byte planes, one zlib stream, base64. page/unpack.js reads them back.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include <kerf/vec.h>

namespace view {

class Pack {
 public:
  /// Whole numbers under a name, `width` bytes each (1, 2, 4), in rows of `columns`. Differences are taken to the row
  /// before, or, where `base` names an array of the same length that was put before, to that.
  void whole(const std::string& name, const std::vector<std::uint32_t>& values, int width, int columns,
             const std::string& base = {});
  /// Numbers as sixteen bits between their smallest and largest, or between those that are given.
  void scaled(const std::string& name, const std::vector<double>& values);
  void scaled(const std::string& name, const std::vector<double>& values, double lo, double hi,
              const std::string& base = {});
  /// Points as sixteen bits an axis within `box`; the page has them moved to the middle of the box, in half diagonals.
  void points(const std::string& name, const std::vector<geo::Vec3>& values, const geo::Box3& box,
              const std::string& base = {});
  /// Points that may be outside the box: the sixteen bits are within `around`.
  void points(const std::string& name, const std::vector<geo::Vec3>& values, const geo::Box3& box,
              const geo::Box3& around, const std::string& base);

  bool has(const std::string& name) const { return values_.count(name) > 0; }
  /// True when an array of that name was put and holds just this.
  bool holds(const std::string& name, const std::vector<std::uint32_t>& values) const {
    return has(name) && values_.at(name) == values;
  }
  std::size_t length(const std::string& name) const { return values_.at(name).size(); }

  /// What the page is told: an object per array, in the order they were put.
  const nlohmann::ordered_json& manifest() const { return manifest_; }
  /// All bytes, deflated, as base64. Throws OutputError when there is no memory.
  std::string text() const;

 private:
  std::string bytes_;
  nlohmann::ordered_json manifest_ = nlohmann::ordered_json::array();
  std::map<std::string, std::vector<std::uint32_t>> values_;
};

}  // namespace view
