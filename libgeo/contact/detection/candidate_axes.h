// Axes that may separate pairs of simplices at the start and at the end of a motion, eight pairs at
// a time. Used by contact_candidates, motion_certifier and contact/motion.
//
// If one axis separates two convex sets at the start and at the end of a linear motion, the sets do
// not meet during it: a plane normal to the axis separates them throughout. No cubic equation is
// solved, and coplanar motion is no special case.
#pragma once

#include <limits>
#include <vector>

#include "contact/detection/simplex.h"

namespace geo {

/// A pair of simplices that must stay disjoint.
struct SimplexPair {
  Simplex a, b;
};

/// Candidate axes for up to eight pairs (a, b), one pair a SIMD lane; each may fail to separate.
/// Axes point from b to a. For disjoint pairs, between_closest has the largest separation of all
/// directions at the start, up to rounding.
struct CandidateAxes {
  /// Pairs to a batch.
  static constexpr std::size_t width = 8;
  /// The candidate axes: the difference of centroids, the two normals, the differences of closest
  /// points at the start and at the end.
  enum Axis { between_centroids, a_normal, b_normal, between_closest, between_closest_at_end, count };

  alignas(64) double normal[count][3][width] = {};         ///< unit vectors; zero: the axis does not exist
  alignas(64) double start_separation[count][width] = {};  ///< separation_along() at the start, model units
  alignas(64) double end_separation[count][width] = {};    ///< at the end
  /// min(start, end) over a − max(start, end) over b: holds for corners that are anywhere on their
  /// paths, independently of each other.
  alignas(64) double swept_separation[count][width] = {};
  alignas(64) double weights_a[3][width] = {};  ///< barycentric coordinates of a's closest point at the start
  alignas(64) double weights_b[3][width] = {};  ///< of b's closest point
};

/// The separation of one pair along one axis, as in CandidateAxes.
struct PairSeparation {
  double start, end, swept;
};

/// The separation along the difference of centroids at the start. It separates most pairs and is
/// therefore tried before the other axes.
inline PairSeparation centroid_separation(const SimplexPair& pair, const std::vector<Vec3>& from,
                                          const std::vector<Vec3>& to) {
  const auto centroid = [&](const Simplex& s) {
    return s.size == 1   ? from[s.v[0]]
           : s.size == 2 ? Vec3((from[s.v[0]] + from[s.v[1]]) / 2)
                         : Vec3((from[s.v[0]] + from[s.v[1]] + from[s.v[2]]) / 3);
  };
  Vec3 n = centroid(pair.a) - centroid(pair.b);
  if (const double length = n.norm(); length > 0) n /= length;
  constexpr double infinity = std::numeric_limits<double>::infinity();
  double a_start = infinity, a_end = infinity, b_start = -infinity, b_end = -infinity;
  for (int k = 0; k < pair.a.size; ++k) {
    a_start = std::min(a_start, n.dot(from[pair.a.v[k]]));
    a_end = std::min(a_end, n.dot(to[pair.a.v[k]]));
  }
  for (int k = 0; k < pair.b.size; ++k) {
    b_start = std::max(b_start, n.dot(from[pair.b.v[k]]));
    b_end = std::max(b_end, n.dot(to[pair.b.v[k]]));
  }
  return {a_start - b_start, a_end - b_end, std::min(a_start, a_end) - std::max(b_start, b_end)};
}

/// Computes the axes of `size` ≤ 8 pairs whose vertices move from `from` to `to`. Without `end`,
/// axis between_closest_at_end stays as it is: in a new object it does not exist. Lanes from `size`
/// on repeat the last pair, and their weights stay. Floating point; the same for any instruction
/// set.
void find_candidate_axes(const SimplexPair* pairs, std::size_t size, const std::vector<Vec3>& from,
                         const std::vector<Vec3>& to, bool end, CandidateAxes& out);

/// Axes for uneven surfaces that slide over each other: the normals of a and b and their sum,
/// untilted and tilted by four growing amounts towards the difference of closest points.
struct TiltedAxes {
  static constexpr int count = 15;                                    ///< number of axes
  static constexpr std::size_t width = 16;                            ///< with padding: the last element is undefined
  alignas(64) double normal[3][width];                                ///< unit, from b to a; zero: does not exist
  alignas(64) double start_separation[width], end_separation[width];  ///< as in CandidateAxes
};

/// The tilted axes of one pair whose other axes are in lane `lane` of `axes`. The same for any
/// instruction set.
void find_tilted_axes(const SimplexPair& pair, const CandidateAxes& axes, std::size_t lane,
                      const std::vector<Vec3>& from, const std::vector<Vec3>& to, TiltedAxes& out);

/// Whether accept(n, start_separation, end_separation) is true for one of the tilted axes n.
template <class Accept>
bool any_tilted_axis(const SimplexPair& pair, const CandidateAxes& axes, std::size_t lane,
                     const std::vector<Vec3>& from, const std::vector<Vec3>& to, const Accept& accept) {
  TiltedAxes tilted;
  find_tilted_axes(pair, axes, lane, from, to, tilted);
  for (int k = 0; k < TiltedAxes::count; ++k)
    if (accept(Vec3(tilted.normal[0][k], tilted.normal[1][k], tilted.normal[2][k]), tilted.start_separation[k],
               tilted.end_separation[k]))
      return true;
  return false;
}

/// Collects pairs into batches of eight. Calls use(number, axes, lane) for each pair, in order.
template <class Use>
class CandidateAxisBatch {
 public:
  /// `from`, `to`, `end`: as in find_candidate_axes(). Refers to `from`, `to` and `use`.
  CandidateAxisBatch(const std::vector<Vec3>& from, const std::vector<Vec3>& to, bool end, const Use& use)
      : from_(from), to_(to), end_(end), use_(use) {}
  /// Adds a pair, which `use` will see under this number.
  void add(const SimplexPair& pair, std::size_t number) {
    pairs_[size_] = pair;
    numbers_[size_] = number;
    if (++size_ == CandidateAxes::width) finish();
  }
  /// Processes the pairs that are left. Must be called after the last add().
  void finish() {
    if (size_ > 0) find_candidate_axes(pairs_, size_, from_, to_, end_, axes_);
    for (std::size_t lane = 0; lane < size_; ++lane) use_(numbers_[lane], axes_, lane);
    size_ = 0;
  }

 private:
  const std::vector<Vec3>&from_, &to_;
  bool end_;
  const Use& use_;
  std::size_t size_ = 0;
  SimplexPair pairs_[CandidateAxes::width];
  std::size_t numbers_[CandidateAxes::width];
  CandidateAxes axes_;
};

}  // namespace geo
