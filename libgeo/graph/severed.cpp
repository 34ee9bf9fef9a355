#include "graph/severed.h"

#include <algorithm>
#include <cmath>
#include <unordered_map>

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
  Height height(const Vec3& x) const {
    const double a = x.x() - origin_.x(), b = x.y() - origin_.y(), c = x.z() - origin_.z();
    return {(a * normal_.x() + b * normal_.y()) + c * normal_.z(), rounding_ * ((std::abs(a) + std::abs(b)) + std::abs(c))};
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
  Corners corners;
  Plane plane;
  Box3 box, around;
  double reach;
};

// The cubes of a lattice that faces pass through: one question to the grid for all faces in a cube.
class Cubes {
 public:
  explicit Cubes(double edge) : edge_(edge) { numbers_.reserve(64); }
  void add(std::uint32_t face, const Corners& t) {
    const Box3 box = box_of(t[0], t[1], t[2]);
    if ((box.hi - box.lo).maxCoeff() > edge_) {
      std::size_t a = 0;
      for (std::size_t k = 1; k < 3; ++k)
        if (squared_distance(t[k], t[(k + 1) % 3]) > squared_distance(t[a], t[(a + 1) % 3])) a = k;
      const Vec3 &p = t[a], &q = t[(a + 1) % 3], &r = t[(a + 2) % 3], half = 0.5 * (p + q);
      add(face, {p, half, r}), add(face, {half, q, r});
      return;
    }
    const Eigen::Array3d lo = (box.lo / edge_).array().floor(), hi = (box.hi / edge_).array().floor();
    for (double x = lo.x(); x <= hi.x(); ++x)
      for (double y = lo.y(); y <= hi.y(); ++y)
        for (double z = lo.z(); z <= hi.z(); ++z) {
          const std::array<double, 3> place{x, y, z};
          const auto number = numbers_.try_emplace(place, cubes_.size()).first->second;
          if (number == cubes_.size()) cubes_.push_back({edge_ * (Vec3(x, y, z) + Vec3::Constant(0.5)), {}});
          auto& faces = cubes_[number].faces;
          if (faces.empty() || faces.back() != face) faces.push_back(face);
        }
  }
  struct Cube {
    Vec3 center;
    std::vector<std::uint32_t> faces;
  };
  const std::vector<Cube>& all() const { return cubes_; }

 private:
  struct Hash {
    std::size_t operator()(const std::array<double, 3>& p) const {
      return static_cast<std::size_t>(static_cast<std::int64_t>(p[0]) * 73856093 ^ static_cast<std::int64_t>(p[1]) * 19349663 ^ static_cast<std::int64_t>(p[2]) * 83492791);
    }
  };
  double edge_;
  std::unordered_map<std::array<double, 3>, std::size_t, Hash> numbers_;
  std::vector<Cube> cubes_;
};

}  // namespace

Severed find_severed(const NodeSet& nodes, const VisibilityGraph& graph, const NodeGrid& grid, NodeId first_new,
                     std::span<const Corners> faces) {
  Severed severed;
  const auto& x = nodes.position;
  // What a face cuts has one end within half its length. A millionth more covers the rounding of these distances.
  const double half = 0.5 * graph.reach() * (1 + 1e-6);
  if (!(half > 0)) return severed;  // no edge yet
  std::vector<Surroundings> around;
  Cubes cubes(2 * half);
  for (std::uint32_t f = 0; f < faces.size(); ++f) {
    around.emplace_back(faces[f], half);
    cubes.add(f, faces[f]);
  }
  // Nodes with faces near them, in the lower half.
  std::vector<std::uint64_t> candidates;
  std::vector<std::uint32_t> near;
  for (const auto& cube : cubes.all()) {
    near.clear();
    grid.within(x, cube.center, (std::sqrt(3.0) + 1) * half * (1 + 1e-6), near);
    for (const auto i : near)
      if (i < first_new.value)
        for (const auto f : cube.faces)
          if (around[f].holds(x[i], around[f].plane.height(x[i]))) candidates.push_back(std::uint64_t(i) << 32 | f);
  }
  std::sort(candidates.begin(), candidates.end());
  candidates.erase(std::unique(candidates.begin(), candidates.end()), candidates.end());

  struct Side {
    const Surroundings* face;
    bool above, below;
  };
  std::vector<Side> sides;
  for (std::size_t c = 0; c < candidates.size();) {
    const auto i = static_cast<std::uint32_t>(candidates[c] >> 32);
    sides.clear();
    for (; c < candidates.size() && candidates[c] >> 32 == i; ++c) {
      const Surroundings& face = around[static_cast<std::uint32_t>(candidates[c])];
      const auto h = face.plane.height(x[i]);
      sides.push_back({&face, h.above(), h.below()});
    }
    const auto row = graph.rows().entries(i);
    for (std::size_t k = 0; k < row.to.size(); ++k) {
      const auto j = row.to[k];
      const bool cut = std::any_of(sides.begin(), sides.end(), [&](const Side& side) {
        const Surroundings& face = *side.face;
        const auto h = face.plane.height(x[j]);
        if ((side.above && h.above()) || (side.below && h.below())) return false;
        if (j < i && face.holds(x[j], h)) return false;  // j has asked
        Box3 segment{x[i], x[i]};
        segment.add(x[j]);
        return segment.meets(face.box) && segment_meets_triangle(x[std::min(i, j)], x[std::max(i, j)], face.corners[0], face.corners[1], face.corners[2]);
      });
      if (!cut) continue;
      if (VisibilityGraph::is_edge(row.bits[k])) severed.edges.push_back(pair_key(i, j));
      if (VisibilityGraph::is_neighbor(row.bits[k])) severed.neighbors.push_back(pair_key(i, j));
    }
  }
  for (auto* pairs : {&severed.edges, &severed.neighbors}) {
    std::sort(pairs->begin(), pairs->end());
    pairs->erase(std::unique(pairs->begin(), pairs->end()), pairs->end());
  }
  return severed;
}

}  // namespace geo
