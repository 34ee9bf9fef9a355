// Faces that may hide nodes from points. Trees over them outlive a cut, which changes few faces.
#pragma once

#include <span>
#include <vector>

#include "geometry/wide_bvh.h"
#include "kerf/complex.h"

namespace geo {

/// A set of faces that tells which segments they block. Exact; queries are thread-safe.
class OccludingFaces {
 public:
  /// Makes this the set of the faces `ids`. Other living faces of earlier sets may stay in it. The
  /// large tree is kept while faces that went and new ones are at most a quarter of it. The cost is
  /// then a comparison of each face, and a small tree over the new ones.
  void update(const Complex& surface, std::span<const FaceId> ids);
  /// Whether no face is in the set.
  bool empty() const { return known_.face.size() == removed_ && fresh_.face.empty(); }
  /// For the closed segments from p to each of `ends`: writes 1 to result[i] if it touches a face,
  /// else 0. Fast if the ends are near p and near each other.
  void blocks(const Vec3& p, std::span<const Vec3> ends, std::uint8_t* result) const;

 private:
  using Corners = std::array<Vec3, 3>;
  // A tree over faces along the Morton curve of their centres. It takes less time to build than
  // TriangleBvh; its queries take a little more.
  struct Tree {
    std::vector<FaceId> face;
    std::vector<Corners> corners;      // of `face`
    std::vector<std::uint32_t> order;  // 0, 1, …
    WideBvh boxes;
  };
  static Tree tree_over(const Complex& surface, std::span<const FaceId> ids);
  void remove_changed(const Complex& surface);
  bool is_known(FaceId f) const { return f.index() < place_.size() && place_[f.index()] != none; }

  static constexpr std::uint32_t none = ~0u;
  Tree known_, fresh_;
  std::vector<std::uint32_t> place_;  // per face: its place in known_, or none
  std::size_t removed_ = 0;           // faces of known_ that have changed; their places in `face` are invalid
};

}  // namespace geo
