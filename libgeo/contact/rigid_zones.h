// Rows of points that move as one because nothing else is known to keep them from crossing (Provot 1997).
#pragma once

#include <cstdint>
#include <vector>

#include "base/vec.h"

namespace geo {

class RigidZones {
 public:
  explicit RigidZones(std::size_t rows) : parent_(rows), in_zone_(rows, 0) {
    for (std::uint32_t v = 0; v < rows; ++v) parent_[v] = v;
  }

  /// Puts the corners of both into one zone, with all zones that they were in. True when that is new.
  bool join(const Triangle& s, const Triangle& t);
  /// Whether one zone has all corners of both.
  bool have(const Triangle& s, const Triangle& t) const;
  bool empty() const { return size_ == 0; }
  std::size_t size() const { return size_; }  ///< rows, of all zones

  /// The rows of each zone, ascending; zones by their first rows.
  std::vector<std::vector<std::uint32_t>> members() const;

 private:
  std::uint32_t zone(std::uint32_t v) const {
    while (parent_[v] != v) v = parent_[v];
    return v;
  }

  std::vector<std::uint32_t> parent_;
  std::vector<std::uint8_t> in_zone_;
  std::size_t size_ = 0;
};

}  // namespace geo
