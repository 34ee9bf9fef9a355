// The arrangement of one step, in exact coordinates: the strip, the faces of K that it meets, and their common pieces.
#pragma once

#include <CGAL/Exact_predicates_exact_constructions_kernel.h>

#include <array>
#include <map>
#include <unordered_map>
#include <vector>

#include "crack/sweep.h"

namespace geo::crack {

using Exact = CGAL::Exact_predicates_exact_constructions_kernel;
using ExactPoint = Exact::Point_3;
using Local = std::uint32_t;  ///< row of a point of the arrangement

/// The smaller key of an edge between two local points.
inline std::uint64_t edge_key(Local a, Local b) {
  return std::uint64_t(std::min(a, b)) << 32 | std::max(a, b);
}

/// A triangle of the strip or a face of K, with what it shares with others and what it was divided into.
struct Element {
  std::array<Local, 3> corner;
  FaceId face;      ///< invalid: of the strip
  bool cut = false;
  std::vector<std::pair<Local, Local>> shared;  ///< segments on it; a point twice is a point
  std::vector<std::array<Local, 3>> children;   ///< itself when it is not cut; oriented as it is
};

/// Points are identified exactly: the same place is the same row, whatever it rounds to.
class Arrangement {
 public:
  Arrangement(const Complex& complex, const Strip& strip);

  /// Finds the faces near the strip and what they share with it, and the strip with itself.
  void meet(CrackWork& work);
  /// Triangulates each element that something divides, alone and constrained to what it shares.
  void split();

  const ExactPoint& exact(Local p) const { return points_[p]; }
  const Vec3& rounded(Local p) const { return rounded_[p]; }
  VertexId id(Local p) const { return ids_[p]; }
  std::size_t point_count() const { return points_.size(); }
  Local local(VertexId v);
  /// True when child `c` of strip element `e` lies on a face of K, or on an earlier triangle of the strip.
  bool lies_on_other(std::size_t e, const std::array<Local, 3>& c) const;

  std::vector<Element> elements;  ///< the strip's triangles first
  std::size_t strip_size = 0;
  std::map<FaceId, std::size_t> element_of;

 private:
  Local local(const ExactPoint& p);
  Local local(const Vec3& p);
  void share(std::size_t a, std::size_t b);

  const Complex& complex_;
  const Strip& strip_;
  std::vector<ExactPoint> points_;
  std::vector<Vec3> rounded_;
  std::vector<VertexId> ids_;
  std::unordered_map<std::uint64_t, std::vector<Local>> by_hash_;
  std::unordered_map<VertexId, Local> by_id_;
  std::vector<std::vector<std::size_t>> coplanar_;  ///< per strip element: elements it overlaps in an area
};

}  // namespace geo::crack
