// Greedy merging of pieces: the smallest group joins the neighbour with the largest shared area. A
// crack face belongs to the wall triangle nearest to its centroid. A triangle is dropped where the
// same group lies on both sides of all its crack faces.
#include "score/join.h"

#include <algorithm>
#include <map>
#include <numeric>

#include "geometry/bvh.h"

namespace geo {
namespace {

using Pair = std::pair<std::uint32_t, std::uint32_t>;  // pieces on both sides of a wall, lower first

class Joining {
 public:
  Joining(const TriangleMesh& walls, const Complex& cut, std::int32_t crack, const Pieces& pieces)
      : between_(walls.triangles.size()), group_(pieces.count), members_(pieces.count), volume_(pieces.volume) {
    std::iota(group_.begin(), group_.end(), 0u);
    for (std::uint32_t p = 0; p < pieces.count; ++p) members_[p] = {p};
    const TriangleBvh tree(corners_of(walls));
    for (std::uint32_t f = 0; f < cut.face_count(); ++f) {
      if (!cut.alive(FaceId(f)) || cut.face(FaceId(f)).crack != crack) continue;
      const auto a = static_cast<std::uint32_t>(pieces.of_side[2 * f]),
                 b = static_cast<std::uint32_t>(pieces.of_side[2 * f + 1]);
      if (a == b) continue;
      const auto c = cut.corners(FaceId(f));
      const Pair pair{std::min(a, b), std::max(a, b)};
      const auto triangle = tree.closest((c[0] + c[1] + c[2]) / 3).triangle;
      auto& pairs = between_[triangle];
      if (std::find(pairs.begin(), pairs.end(), pair) == pairs.end()) {
        pairs.push_back(pair);
        walls_[pair].triangles.push_back(triangle);
      }
      walls_[pair].area += 0.5 * (c[1] - c[0]).cross(c[2] - c[0]).norm();
    }
  }

  // Joins the smallest group that can be joined with a neighbour. False when there is none.
  bool join_one() {
    std::vector<std::uint32_t> smallest;
    for (std::uint32_t g = 0; g < members_.size(); ++g)
      if (!members_[g].empty()) smallest.push_back(g);
    std::sort(smallest.begin(), smallest.end(),
              [&](auto a, auto b) { return std::tie(volume_[a], a) < std::tie(volume_[b], b); });
    for (const auto g : smallest) {
      std::map<std::uint32_t, double> shared;
      for (const auto& [pair, wall] : walls_) {
        const auto a = group_[pair.first], b = group_[pair.second];
        if (a != b && (a == g || b == g)) shared[a == g ? b : a] += wall.area;
      }
      std::vector<std::pair<double, std::uint32_t>> neighbors;
      for (const auto& [other, area] : shared) neighbors.push_back({-area, other});
      std::sort(neighbors.begin(), neighbors.end());
      for (const auto& [area, other] : neighbors)
        if (separates_only(g, other)) {
          for (const auto p : members_[g]) group_[p] = other;
          members_[other].insert(members_[other].end(), members_[g].begin(), members_[g].end());
          members_[g].clear();
          volume_[other] += volume_[g];
          return true;
        }
    }
    return false;
  }

  bool dropped(std::size_t triangle) const {
    return !between_[triangle].empty() &&
           std::all_of(between_[triangle].begin(), between_[triangle].end(),
                       [&](const Pair& p) { return group_[p.first] == group_[p.second]; });
  }

 private:
  struct Wall {
    double area = 0;
    std::vector<std::uint32_t> triangles;
  };
  // Whether no triangle between the two groups also bounds a third one.
  bool separates_only(std::uint32_t g, std::uint32_t other) const {
    const auto of_both = [&](std::uint32_t p) { return group_[p] == g || group_[p] == other; };
    for (const auto& [pair, wall] : walls_)
      if (group_[pair.first] != group_[pair.second] && of_both(pair.first) && of_both(pair.second))
        for (const auto t : wall.triangles)
          for (const Pair& p : between_[t])
            if (group_[p.first] != group_[p.second] && !(of_both(p.first) && of_both(p.second))) return false;
    return true;
  }

  std::vector<std::vector<Pair>> between_;  // per triangle of the walls
  std::map<Pair, Wall> walls_;
  std::vector<std::uint32_t> group_;                 // per piece
  std::vector<std::vector<std::uint32_t>> members_;  // pieces per group; a group has the index of one of its pieces
  std::vector<double> volume_;
};

}  // namespace

std::uint32_t join_small_pieces(TriangleMesh& walls, const Complex& cut, std::int32_t crack, const Pieces& pieces,
                                std::uint32_t wanted) {
  Joining joining(walls, cut, crack, pieces);
  std::uint32_t count = pieces.count;
  while (count > wanted && joining.join_one()) --count;
  std::size_t kept = 0;
  for (std::size_t t = 0; t < walls.triangles.size(); ++t)
    if (!joining.dropped(t)) walls.triangles[kept++] = walls.triangles[t];
  walls.triangles.resize(kept);
  return count;
}

}  // namespace geo
