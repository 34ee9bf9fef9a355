// How far some directions part two triangles, where a motion begins and where it ends: eight couples at a time.
#pragma once

#include <limits>
#include <vector>

#include "contact/detection/simplex.h"

namespace geo {

/// For each of up to eight couples (a, b) of simplices some directions from b to a that part most, if any does.
struct Partings {
  static constexpr std::size_t width = 8;
  enum Direction {
    across,
    a_normal,
    b_normal,
    closest,
    closest_at_end,
    count
  };  ///< between the middles; normals; between closest places

  alignas(64) double normal[count][3][width];  ///< unit; zero: there is none
  alignas(64) double first[count][width];      ///< how far it parts them at the beginning, model units; negative: not
  alignas(64) double last[count][width];       ///< at the end
  alignas(64) double always[count][width];     ///< wherever on their ways the corners are, each for itself
  alignas(64) double from[3][width],
      to[3][width];  ///< weights of a's and b's corners for the places closest at the beginning
};

struct Couple {
  Simplex a, b;
};

/// The same of one couple's direction `across` alone, which parts most of them: the quick look before the others.
struct Parting {
  double first, last, always;
};
inline Parting part_across(const Couple& c, const std::vector<Vec3>& from, const std::vector<Vec3>& to) {
  const auto middle = [&](const Simplex& s) {
    return s.size == 1   ? from[s.v[0]]
           : s.size == 2 ? Vec3((from[s.v[0]] + from[s.v[1]]) / 2)
                         : Vec3((from[s.v[0]] + from[s.v[1]] + from[s.v[2]]) / 3);
  };
  Vec3 n = middle(c.a) - middle(c.b);
  if (const double length = n.norm(); length > 0) n /= length;
  constexpr double most = std::numeric_limits<double>::infinity();
  double a_first = most, a_last = most, b_first = -most, b_last = -most;
  for (int k = 0; k < c.a.size; ++k)
    a_first = std::min(a_first, n.dot(from[c.a.v[k]])), a_last = std::min(a_last, n.dot(to[c.a.v[k]]));
  for (int k = 0; k < c.b.size; ++k)
    b_first = std::max(b_first, n.dot(from[c.b.v[k]])), b_last = std::max(b_last, n.dot(to[c.b.v[k]]));
  return {a_first - b_first, a_last - b_last, std::min(a_first, a_last) - std::max(b_first, b_last)};
}

/// Fills in the partings of couples, eight at most, whose rows are at `from`, then at `to`. Without `end` all but
/// closest_at_end. The same for any processor. Floating point.
void find_partings(const Couple* couples, std::size_t size, const std::vector<Vec3>& from, const std::vector<Vec3>& to,
                   bool end, Partings& out);

/// Directions between the normals of a couple and the way between its closest places: the normals of a and b and their
/// sum, each as it is and then tilted more and more.
struct TiltedPartings {
  static constexpr int count = 15;
  static constexpr std::size_t width = 16;                         ///< the last says nothing
  alignas(64) double normal[3][width], first[width], last[width];  ///< as in Partings
};

/// Of a couple whose partings `p` has in `lane`. The same for any processor.
void find_tilted(const Couple& couple, const Partings& p, std::size_t lane, const std::vector<Vec3>& from,
                 const std::vector<Vec3>& to, TiltedPartings& out);

/// Hands couples over as they come: use(number, partings, lane) for each, in order, the last ones after finish().
template <class Use>
class CouplesInLanes {
 public:
  CouplesInLanes(const std::vector<Vec3>& from, const std::vector<Vec3>& to, bool end, const Use& use)
      : from_(from), to_(to), end_(end), use_(use) {}
  void add(const Couple& couple, std::size_t number) {
    couples_[size_] = couple, numbers_[size_] = number;
    if (++size_ == Partings::width) finish();
  }
  void finish() {
    if (size_ > 0) find_partings(couples_, size_, from_, to_, end_, partings_);
    for (std::size_t lane = 0; lane < size_; ++lane) use_(numbers_[lane], partings_, lane);
    size_ = 0;
  }

 private:
  const std::vector<Vec3>&from_, &to_;
  bool end_;
  const Use& use_;
  std::size_t size_ = 0;
  Couple couples_[Partings::width];
  std::size_t numbers_[Partings::width];
  Partings partings_;
};

}  // namespace geo
