// A walk over neighbouring sides from each new face, children of earlier ones included, since a
// strip may lie on these. Large parts of the surface end it early.
#include "crack/specks.h"

#include <algorithm>
#include <optional>
#include <unordered_set>

namespace geo::crack {
namespace {

std::uint64_t key_of(Side s) { return 2 * std::uint64_t(s.face.value) + static_cast<std::uint64_t>(s.which); }

class SpeckSearch {
 public:
  SpeckSearch(const Complex& complex, const std::vector<FaceId>& fresh, double thickness, std::size_t max_sides)
      : complex_(complex), fresh_(fresh), thickness_(thickness), max_sides_(max_sides) {}

  // Whether the part of the surface with this side is a speck that was not visited before.
  bool is_speck(Side start) {
    if (!complex_.has(start) || !visited_.insert(key_of(start)).second) return false;
    part_.assign(1, start);
    for (std::size_t i = 0; i < part_.size(); ++i) {
      if (part_.size() > max_sides_) return false;
      for (int k = 0; k < 3; ++k) {
        const Side next = complex_.neighbor(part_[i], k);
        if (visited_.insert(key_of(next)).second)
          part_.push_back(next);
        else if (!has(next))
          return false;  // larger than max_sides: an earlier walk gave up there
      }
    }
    return is_thin();
  }

  // The largest new face of a crack between the speck found last and the rest, if there is one.
  // Faces at the border of a sheet come last: fronts have their vertices there.
  std::optional<FaceId> joint() const {
    std::optional<FaceId> best;
    double largest = 0;
    bool best_is_inner = false;
    for (const Side s : part_) {
      if (complex_.face(s.face).crack == 0 || !std::binary_search(fresh_.begin(), fresh_.end(), s.face) ||
          has({s.face, 1 - s.which}))
        continue;
      const bool is_inner = !has_border(s.face);
      const auto [a, b, c] = complex_.corners(s.face);
      const double area = (b - a).cross(c - a).norm();
      if (best && (is_inner == best_is_inner ? area <= largest : best_is_inner)) continue;
      best = s.face;
      largest = area;
      best_is_inner = is_inner;
    }
    return best;
  }

 private:
  bool has(Side s) const { return std::find(part_.begin(), part_.end(), s) != part_.end(); }

  bool has_border(FaceId f) const {
    const auto& v = complex_.face(f).v;
    for (std::size_t k = 0; k < 3; ++k)
      if (complex_.faces_around(v[k], v[(k + 1) % 3]).size() == 1) return true;
    return false;
  }

  bool is_thin() const {
    const Vec3 origin = complex_.corners(part_[0].face)[0];
    double volume = 0;
    double area = 0;
    for (const Side s : part_) {
      const auto [a, b, c] = complex_.corners(s.face);
      const Vec3 normal = (s.which == 0 ? 1 : -1) * (b - a).cross(c - a);
      volume += normal.dot(a - origin) / 6;
      area += 0.5 * normal.norm();
    }
    return volume < thickness_ * 0.5 * area;
  }

  const Complex& complex_;
  const std::vector<FaceId>& fresh_;  // ascending
  double thickness_;
  std::size_t max_sides_;
  std::unordered_set<std::uint64_t> visited_;
  std::vector<Side> part_;
};

}  // namespace

std::vector<FaceId> find_specks(const Complex& complex, const CrackDelta& delta, double thickness,
                                std::size_t max_sides) {
  SpeckSearch search(complex, delta.new_faces, thickness, max_sides);
  std::vector<FaceId> joints;
  for (const FaceId f : delta.new_faces)
    for (int which = 0; which < 2 && complex.alive(f); ++which) {
      if (!search.is_speck({f, which})) continue;
      if (const auto joint = search.joint()) joints.push_back(*joint);
    }
  std::sort(joints.begin(), joints.end());
  joints.erase(std::unique(joints.begin(), joints.end()), joints.end());
  return joints;
}

}  // namespace geo::crack
