// How far some directions part two triangles, where a motion begins and where it ends: eight couples at a time.
#pragma once

#include <vector>

#include "contact/simplex.h"

namespace geo {

/// For each of up to eight couples (a, b) of simplices some directions from b to a that part most, if any does.
struct Partings {
  static constexpr std::size_t width = 8;
  enum Direction { across, a_normal, b_normal, closest, closest_at_end, count };  ///< between the middles; normals; between closest places

  alignas(64) double normal[count][3][width];  ///< unit; zero: there is none
  alignas(64) double first[count][width];      ///< how far it parts them at the beginning, model units; negative: not
  alignas(64) double last[count][width];       ///< at the end
  alignas(64) double always[count][width];     ///< wherever on their ways the corners are, each for itself
  alignas(64) double from[3][width], to[3][width];  ///< weights of a's and b's corners for the places closest at the beginning
};

struct Couple {
  Simplex a, b;
};

/// Fills in the partings of couples, eight at most, whose rows are at `from`, then at `to`. Without `end` all but closest_at_end.
/// The same for any processor. Floating point.
void find_partings(const Couple* couples, std::size_t size, const std::vector<Vec3>& from, const std::vector<Vec3>& to, bool end, Partings& out);

/// Hands couples over as they come: use(number, partings, lane) for each, in order, the last ones after finish().
template <class Use>
class CouplesInLanes {
 public:
  CouplesInLanes(const std::vector<Vec3>& from, const std::vector<Vec3>& to, bool end, const Use& use) : from_(from), to_(to), end_(end), use_(use) {}
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
