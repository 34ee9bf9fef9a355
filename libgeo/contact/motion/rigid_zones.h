// Rows of points that move as one because nothing else is known to keep them from crossing (Provot 1997).
#pragma once

#include <cstdint>
#include <vector>

#include "base/union_find.h"
#include "kerf/vec.h"

namespace geo {

class RigidZones {
 public:
  explicit RigidZones(std::size_t rows) : joined_(rows), in_zone_(rows, 0) {}

  /// Puts the corners of both into one zone, with all zones that they were in. True when that is new.
  bool join(const Triangle& s, const Triangle& t);
  /// Whether one zone has all corners of both.
  bool have(const Triangle& s, const Triangle& t) const;
  /// Rows of all zones.
  std::size_t size() const;

  /// The rows of each zone, ascending; zones by their first rows.
  std::vector<std::vector<std::uint32_t>> members() const;

 private:
  UnionFind joined_;
  std::vector<std::uint8_t> in_zone_;
};

}  // namespace geo
