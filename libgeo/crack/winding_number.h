// The generalized winding number of triangles at many points.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "kerf/vec.h"

namespace geo::crack {

/// A tree of triangles. Far parts of it count as one dipole (Barill, Dickson, Schmidt, Levin and
/// Jacobson 2018).
class WindingNumber {
 public:
  /// Triangles may cross, overlap, and leave holes.
  explicit WindingNumber(std::vector<std::array<Vec3, 3>> triangles);
  /// Whether the winding number exceeds a half: exact but for rounding, as a sum near a half is
  /// repeated without dipoles. Safe for several threads.
  bool exceeds_half(const Vec3& at) const;
  /// The sum of all solid angles over 4π. `opening`: nodes farther away than this times their
  /// radius count as dipoles; 0: none does.
  double value(const Vec3& at, double opening) const;

 private:
  struct Node {
    Vec3 centroid, area;             // of the triangles: mean by area, sum of area vectors
    double radius;                   // of a ball about the centroid that contains them
    std::uint32_t first, end, next;  // triangles; the node after all nodes below this one
  };
  void add_node(std::uint32_t first, std::uint32_t end);

  std::vector<std::array<Vec3, 3>> triangles_;
  std::vector<Node> nodes_;  // each before those below it
};

}  // namespace geo::crack
