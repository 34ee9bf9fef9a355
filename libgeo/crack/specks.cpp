// A walk over neighbouring sides from each new crack face. Large parts of the surface end it early.
#include "crack/specks.h"

#include <algorithm>
#include <unordered_set>
#include <vector>

namespace geo::crack {
namespace {

std::uint64_t key_of(Side s) { return 2 * std::uint64_t(s.face.value) + static_cast<std::uint64_t>(s.which); }

class SpeckSearch {
 public:
  SpeckSearch(const Complex& complex, double thickness, std::size_t most_sides)
      : complex_(complex), thickness_(thickness), most_sides_(most_sides) {}

  // Whether the part of the surface with this side is a speck that was not visited before.
  bool is_speck(Side start) {
    if (!complex_.has(start) || !visited_.insert(key_of(start)).second) return false;
    part_.assign(1, start);
    bool is_new = true;  // else it is larger than most_sides: an earlier walk gave up there
    for (std::size_t i = 0; i < part_.size(); ++i) {
      if (part_.size() > most_sides_) return false;
      for (int k = 0; k < 3; ++k) {
        const Side next = complex_.neighbor(part_[i], k);
        if (visited_.insert(key_of(next)).second)
          part_.push_back(next);
        else
          is_new = is_new && std::find(part_.begin(), part_.end(), next) != part_.end();
      }
    }
    return is_new && is_thin();
  }

 private:
  bool is_thin() const {
    const Vec3& origin = complex_.corners(part_[0].face)[0];
    double volume = 0, area = 0;
    for (const Side s : part_) {
      const auto [a, b, c] = complex_.corners(s.face);
      const Vec3 normal = (s.which == 0 ? 1 : -1) * (b - a).cross(c - a);
      volume += normal.dot(a - origin) / 6;
      area += 0.5 * normal.norm();
    }
    return volume < thickness_ * 0.5 * area;
  }

  const Complex& complex_;
  double thickness_;
  std::size_t most_sides_;
  std::unordered_set<std::uint64_t> visited_;
  std::vector<Side> part_;
};

}  // namespace

bool leaves_speck(const Complex& complex, const CrackDelta& delta, double thickness, std::size_t most_sides) {
  SpeckSearch search(complex, thickness, most_sides);
  for (const FaceId f : delta.new_crack_faces)
    for (int which = 0; which < 2; ++which)
      if (search.is_speck({f, which})) return true;
  return false;
}

}  // namespace geo::crack
