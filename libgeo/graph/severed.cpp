#include "graph/severed.h"

#include <algorithm>
#include <cmath>

#include "geometry/predicates.h"

namespace geo {
namespace {

using Corners = std::array<Vec3, 3>;

// A triangle's plane, with a bound of the rounding of heights over it.
class Plane {
 public:
  explicit Plane(const Corners& t) : origin_(t[0]) {
    const Vec3 u = t[1] - t[0], v = t[2] - t[0];
    normal_ = u.cross(v);
    length_ = normal_.norm();
    // A height takes a dozen operations on products of these sizes, each with an error of 2⁻⁵³: 2⁻⁴⁸ is more than enough.
    rounding_ = 0x1p-48 * u.lpNorm<1>() * v.lpNorm<1>();
  }
  struct Height {
    double value, error;  // times the normal's length
    bool above() const { return value > error; }
    bool below() const { return value < -error; }
  };
  /// With an error that also serves for points as far from x as `beside`, by the sum of coordinates.
  Height height(const Vec3& x, double beside = 0) const {
    const double a = x.x() - origin_.x(), b = x.y() - origin_.y(), c = x.z() - origin_.z();
    return {(a * normal_.x() + b * normal_.y()) + c * normal_.z(), rounding_ * ((std::abs(a) + std::abs(b)) + std::abs(c) + beside)};
  }
  /// False only when a point is farther from the plane than `distance`.
  bool within(const Height& h, double distance) const { return std::abs(h.value) <= h.error + (length_ + rounding_) * distance; }

 private:
  Vec3 origin_, normal_;
  double length_, rounding_;
};

// Which nodes a face may cut something of: those within `reach` of it, and some more. A function of position alone, so
// that both ends of an edge agree about each other.
struct Surroundings {
  Surroundings(const Corners& t, double reach) : corners(t), plane(t), box(box_of(t[0], t[1], t[2])), around(box.grown(reach)), reach(reach) {}
  bool holds(const Vec3& x, const Plane::Height& h) const {
    return x.x() >= around.lo.x() && x.x() <= around.hi.x() && x.y() >= around.lo.y() && x.y() <= around.hi.y() && x.z() >= around.lo.z() &&
           x.z() <= around.hi.z() && plane.within(h, reach);
  }
  /// True unless it holds nothing of the cube.
  bool reaches(const Vec3& middle, double half) const {
    const Box3 cube{middle - Vec3::Constant(half), middle + Vec3::Constant(half)};
    return cube.meets(around) && plane.within(plane.height(middle, 3 * half), reach + std::sqrt(3.0) * half);
  }
  Corners corners;
  Plane plane;
  Box3 box, around;
  double reach;
};

}  // namespace

Severed find_severed(const NodeSet& nodes, const VisibilityGraph& graph, const NodeGrid& grid, NodeId first_new,
                     std::span<const Corners> faces) {
  Severed severed;
  const auto at = [&](std::uint32_t id) -> const Vec3& { return graph.position(nodes, id); };
  // What a face cuts has one end within half its length. A millionth more covers the rounding of these distances.
  const double half = 0.5 * graph.reach() * (1 + 1e-6);
  if (!(half > 0)) return severed;  // no edge yet
  std::vector<Surroundings> around;
  std::vector<std::vector<std::uint32_t>> faces_at(1);  // by depth: those that reach into the cube
  for (std::uint32_t f = 0; f < faces.size(); ++f) around.emplace_back(faces[f], half), faces_at[0].push_back(f);
  const auto into = [&](int depth, const Vec3& middle, double size) {
    const auto to = static_cast<std::size_t>(depth) + 1;
    if (faces_at.size() <= to) faces_at.resize(to + 1);
    faces_at[to].clear();
    for (const auto f : faces_at[to - 1])
      if (around[f].reaches(middle, size * (1 + 1e-12))) faces_at[to].push_back(f);
    return !faces_at[to].empty();
  };
  struct Side {
    const Surroundings* face;
    bool above, below;
  };
  std::vector<Side> sides;  // of the faces near a node or guide
  const auto see = [&](int depth, std::uint32_t i) {
    const Vec3& x = at(i);
    sides.clear();
    Box3 all;
    for (const auto f : faces_at[static_cast<std::size_t>(depth) + 1])
      if (const auto h = around[f].plane.height(x); around[f].holds(x, h)) sides.push_back({&around[f], h.above(), h.below()}), all.add(around[f].box);
    if (sides.empty()) return;
    const auto row = graph.entries(i);
    for (std::size_t k = 0; k < row.to.size(); ++k) {
      const auto j = row.to[k];
      const Vec3& y = at(j);
      const Box3 segment{x.cwiseMin(y), x.cwiseMax(y)};
      if (!segment.meets(all)) continue;
      const bool cut = std::any_of(sides.begin(), sides.end(), [&](const Side& side) {
        const Surroundings& face = *side.face;
        if (!segment.meets(face.box)) return false;
        const auto h = face.plane.height(y);
        if ((side.above && h.above()) || (side.below && h.below())) return false;
        if (j < i && face.holds(y, h)) return false;  // j asks, too
        return segment_meets_triangle(i < j ? x : y, i < j ? y : x, face.corners[0], face.corners[1], face.corners[2]);
      });
      if (!cut) continue;
      if (VisibilityGraph::is_edge(row.bits[k])) severed.edges.push_back(pair_key(i, j));
      if (VisibilityGraph::is_neighbor(row.bits[k])) severed.neighbors.push_back(pair_key(i, j));
    }
  };
  grid.walk(into, [&](int depth, std::uint32_t i) {
    if (i < first_new.value) see(depth, i);
  });
  graph.guides().grid().walk(into, [&](int depth, std::uint32_t g) { see(depth, VisibilityGraph::first_guide + g); });
  for (auto* pairs : {&severed.edges, &severed.neighbors}) {
    std::sort(pairs->begin(), pairs->end());
    pairs->erase(std::unique(pairs->begin(), pairs->end()), pairs->end());
  }
  return severed;
}

}  // namespace geo
