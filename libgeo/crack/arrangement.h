// The arrangement of one step: the strip, the faces of K that it meets, and their exact
// intersections (§ 5.2). Symbols: kerf/crack.h.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <unordered_map>
#include <utility>
#include <vector>

#include "crack/index_map.h"
#include "crack/pause.h"
#include "crack/sweep.h"
#include "crack/triangulator.h"

namespace geo::crack {

/// A triangle of the strip or a face of K.
struct Element {
  std::array<PointIndex, 3> corner;
  FaceId face;                       ///< invalid for a triangle of the strip
  bool cut = false;                  ///< divided into more than itself
  std::uint32_t first = 0, end = 0;  ///< its children: children[first..end)
};

/// Intersection points are identified by their defining edge and face, so that a position has one
/// index. Positions are compared only where the strip intersects itself.
class Arrangement {
 public:
  /// The strip's triangles as elements. Complex and strip must outlive the arrangement. `pause` is
  /// called now and then by all that works with the arrangement.
  Arrangement(const Complex& complex, const Strip& strip, Pause pause = {});
  /// As given.
  const Pause& pause() const { return pause_; }

  /// Finds the faces of K that the strip meets, and all intersections of the strip with them and
  /// with itself. Throws GeometryError when two triangles meet in more than a segment. Pauses may
  /// throw, here and in split().
  void meet(CrackStats& stats);
  /// Triangulates each element alone, constrained to its intersections. Throws as
  /// Triangulator::triangulate().
  void split();

  /// All points.
  const Points& points() const { return points_; }
  /// The vertex of K at a point; invalid for a new point.
  VertexId id(PointIndex p) const { return p < ids_.size() ? ids_[p] : VertexId(); }
  /// The side of the element's plane on which p lies: Points::orient3d() of its corners and p.
  int side(std::uint32_t element, PointIndex p) const {
    const auto& c = elements[element].corner;
    return points_.orient3d(c[0], c[1], c[2], p);
  }
  /// True when child `c` of strip element `e` lies on a face of K, or on an earlier triangle of the
  /// strip.
  bool lies_on_other(std::uint32_t e, const Child& c) const;
  /// The points on edge k of an element, its ends included, in order from corner k.
  std::vector<PointIndex> along_edge(std::uint32_t e, int k) const;

  /// The faces of K near strip triangle s, including those that it does not meet.
  std::span<const FaceId> near(std::uint32_t s) const {
    return {strip_.near.data() + strip_.near_begin[s], strip_.near_begin[s + 1] - strip_.near_begin[s]};
  }

  std::vector<Element> elements;  ///< the strip's triangles first
  std::uint32_t strip_size = 0;   ///< number of the strip's triangles
  std::vector<Child> children;    ///< of all elements, after split()

 private:
  // A point that two elements share, with the bits of the edges on which it lies in each.
  struct SharedPoint {
    PointIndex point;
    std::uint8_t on[2];
  };
  // A point or a segment that divides an element.
  struct Division {
    std::uint32_t element;
    PointIndex a, b;  // b = no_point: point a, on these edges of the element
    std::uint8_t edges;
  };
  // The name of an intersection point: an edge, and a face or another edge.
  struct Key {
    std::uint64_t edge, other;
    friend bool operator==(const Key&, const Key&) = default;
  };
  struct KeyHash {
    /// Hash of both words.
    std::size_t operator()(const Key& k) const {
      return SpreadHash()(k.edge ^ (k.other + 0x7f4a7c15ull) * 0xbf58476d1ce4e5b9ull);
    }
  };
  struct Corners {
    Vec3 p[3];
  };
  using Signs = int[2][3];  // sides of the corners of each of two elements against the other's plane

  PointIndex point_of(VertexId v);
  static Key edge_edge(PointIndex a, PointIndex b, PointIndex c, PointIndex d);
  Corners corners_of(std::uint32_t s) const;  // of a triangle of the strip
  void meet_faces(std::uint32_t s, CrackStats& stats);
  void meet_itself();
  void meet_pair(std::uint32_t a, std::uint32_t b, const Signs& sign);
  void meet_corner(std::uint32_t mine, std::uint32_t other, int k, int which);
  void meet_edge(std::uint32_t mine, std::uint32_t other, int k, int which);
  void meet_coplanar(std::uint32_t a, std::uint32_t b);
  bool signs_of(const Vec3 (&s)[3], const Vec3 (&t)[3], Signs& sign) const;
  int locate_coplanar(std::uint32_t e, PointIndex p, std::uint8_t& on) const;
  PointIndex crossing(std::uint32_t edge_of, int edge, std::uint32_t other, int other_edge);
  PointIndex crossing_coplanar(std::uint32_t a, int edge_a, std::uint32_t b, int edge_b);
  void add_shared(PointIndex p, int which, std::uint8_t on_mine, std::uint8_t on_other);
  void divide(std::uint32_t e, int which);
  void merge_coinciding_points();
  PointIndex canonical_point(PointIndex l);
  std::size_t collect_divisions(std::uint32_t e, std::size_t at);

  const Complex& complex_;
  const Strip& strip_;
  const Pause pause_;
  Points points_;
  Triangulator triangulator_;
  std::vector<VertexId> ids_;                         // per point: vertex of K
  IndexMap<std::uint64_t, SpreadHash> strip_points_;  // points of the strip by hash_of()
  IndexMap<std::uint64_t, SpreadHash> by_id_, by_face_;
  IndexMap<Key, KeyHash> by_key_;
  std::unordered_map<std::uint64_t, std::vector<PointIndex>> by_position_;  // where the strip meets itself
  std::vector<SharedPoint> shared_;                                         // of the pair at hand
  std::vector<Division> divisions_;
  std::vector<SteinerPoint> steiner_;  // by element, see steiner_begin_
  std::vector<std::uint32_t> steiner_begin_;
  std::vector<std::pair<PointIndex, PointIndex>> constraints_;  // of the element at hand
  std::vector<std::pair<std::uint32_t, std::uint32_t>>
      coplanar_pairs_;  // overlapping elements; after split() in both orders, sorted
  bool meets_itself_ = false;
};

}  // namespace geo::crack
