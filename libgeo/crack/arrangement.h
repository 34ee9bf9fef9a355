// The arrangement of one step: the strip, the faces of K that it meets, and their common pieces,
// exactly.
#pragma once

#include <array>
#include <unordered_map>
#include <vector>

#include "crack/index_map.h"
#include "crack/sweep.h"
#include "crack/triangulator.h"

namespace geo::crack {

/// A triangle of the strip or a face of K.
struct Element {
  std::array<Local, 3> corner;
  FaceId face;                       ///< invalid: of the strip
  bool cut = false;                  ///< divided into more than itself
  std::uint32_t first = 0, end = 0;  ///< its children: children[first..end)
};

/// Points that edges and faces define are named by them, so that one place has one row; only where
/// the strip meets itself are places compared.
class Arrangement {
 public:
  Arrangement(const Complex& complex, const Strip& strip);

  /// Finds the faces near the strip and what they share with it, and the strip with itself.
  void meet(CrackStats& work);
  /// Triangulates each element that something divides, alone and constrained to what it shares.
  void split();

  const Points& points() const { return points_; }
  VertexId id(Local p) const { return p < ids_.size() ? ids_[p] : VertexId(); }
  /// Sign of the side of the element's plane that p lies on, against its normal's direction.
  int side(std::uint32_t element, Local p) const {
    const auto& c = elements[element].corner;
    return points_.orient3d(c[0], c[1], c[2], p);
  }
  /// True when child `c` of strip element `e` lies on a face of K, or on an earlier triangle of the
  /// strip.
  bool lies_on_other(std::uint32_t e, const Child& c) const;
  /// The points on edge k of an element, its ends included, in order from corner k.
  std::vector<Local> along_edge(std::uint32_t e, int k) const;

  /// The faces of K near strip triangle s, those included that it does not meet.
  std::span<const FaceId> near(std::uint32_t s) const {
    return {strip_.near.data() + strip_.near_begin[s], strip_.near_begin[s + 1] - strip_.near_begin[s]};
  }

  std::vector<Element> elements;  ///< the strip's triangles first
  std::uint32_t strip_size = 0;
  std::vector<Child> children;

 private:
  /// What two elements have in common: a point, and where it lies on each.
  struct Feature {
    Local point;
    std::uint8_t on[2];
  };
  struct Key {
    std::uint64_t edge, other;
    friend bool operator==(const Key&, const Key&) = default;
  };
  struct KeyHash {
    std::size_t operator()(const Key& k) const {
      return Spread()(k.edge ^ (k.other + 0x7f4a7c15ull) * 0xbf58476d1ce4e5b9ull);
    }
  };
  Local local_of(VertexId v);
  static Key edge_edge(Local a, Local b, Local c, Local d);
  using Signs = int[2][3];  // of the corners of each of two elements against the other's plane
  void meet_pair(std::uint32_t a, std::uint32_t b, const Signs& sign);
  bool signs_of(const Vec3 (&s)[3], const Vec3 (&t)[3], Signs& sign) const;
  void meet_flat(std::uint32_t a, std::uint32_t b);
  int locate_flat(std::uint32_t e, Local p, std::uint8_t& on) const;
  Local crossing(std::uint32_t edge_of, int edge, std::uint32_t other, int other_edge);
  Local crossing_flat(std::uint32_t a, int edge_a, std::uint32_t b, int edge_b);
  void feature(Local p, std::uint8_t on_a, std::uint8_t on_b);
  void divide(std::uint32_t e, int which);
  void unify();
  Local known_place(Local l);

  const Complex& complex_;
  const Strip& strip_;
  Points points_;
  Triangulator triangulator_;
  std::vector<VertexId> ids_;
  Lookup<std::uint64_t, Spread> strip_places_;  ///< points of the strip by hash_of()
  Lookup<std::uint64_t, Spread> by_id_, by_face_;
  Lookup<Key, KeyHash> by_key_;
  std::unordered_map<std::uint64_t, std::vector<Local>> by_place_;  ///< where the strip meets itself
  std::vector<Feature> features_;                                   ///< of the pair at hand
  struct Shared {
    std::uint32_t element;
    Local a, b;  ///< b = no_local: a point with `edges`
    std::uint8_t edges;
  };
  std::vector<Shared> shared_;
  std::vector<Mark> marks_;  ///< by element, see mark_begin_
  std::vector<std::uint32_t> mark_begin_;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> flat_pairs_;  ///< elements that overlap in an area, strip first
  bool meets_itself_ = false;
};

}  // namespace geo::crack
