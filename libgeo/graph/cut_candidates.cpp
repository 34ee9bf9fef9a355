// An edge of length L that a face cuts has one end within L / 2 of the face. The octrees of nodes
// and guides are descended to cubes that such neighbourhoods of faces reach. The nodes in them are
// tested against box and plane of each face, with bounds on rounding.
#include "graph/cut_candidates.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

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
    // A height takes a dozen operations on products of these sizes, each with an error of 2⁻⁵³:
    // 2⁻⁴⁸ is more than enough.
    rounding_ = 0x1p-48 * u.lpNorm<1>() * v.lpNorm<1>();
  }
  /// False only when x is farther from the plane than `distance`.
  bool within(const Vec3& x, double distance) const {
    const double a = x.x() - origin_.x(), b = x.y() - origin_.y(), c = x.z() - origin_.z();
    const double height = (a * normal_.x() + b * normal_.y()) + c * normal_.z(),
                 error = rounding_ * ((std::abs(a) + std::abs(b)) + std::abs(c));
    return std::abs(height) <= error + (length_ + rounding_) * distance;
  }

 private:
  Vec3 origin_, normal_;
  double length_, rounding_;
};

// The surroundings of a face: all points within `reach` of it, and some more.
struct Surroundings {
  Surroundings(const Corners& t, double reach)
      : plane(t), around(box_of(t[0], t[1], t[2]).grown(reach)), reach(reach) {}
  /// False only for points farther than `distance`, which is `reach` at most.
  bool holds(const Vec3& x, double distance) const {
    const double less = reach - distance;
    return x.x() >= around.lo.x() + less && x.x() <= around.hi.x() - less && x.y() >= around.lo.y() + less &&
           x.y() <= around.hi.y() - less && x.z() >= around.lo.z() + less && x.z() <= around.hi.z() - less &&
           plane.within(x, distance);
  }
  /// False only for cubes without a point of it.
  bool reaches(const Vec3& middle, double half) const {
    const Box3 cube{middle - Vec3::Constant(half), middle + Vec3::Constant(half)};
    return cube.meets(around) && plane.within(middle, reach + std::sqrt(3.0) * half);
  }
  Plane plane;
  Box3 around;
  double reach;
};

// Descends the grids to small cubes that surroundings of faces reach, and tests the nodes in these
// cubes in batches.
class Search {
 public:
  Search(const NodeSet& nodes, const GraphStorage& graph, std::span<const Corners> faces, const TriangleBvh& tree)
      : nodes_(nodes),
        graph_(graph),
        faces_(faces),
        tree_(tree),
        reach_(graph.longest_edge() * (1 + 1e-6)),
        support_(std::min(graph.largest_support() * (1 + 1e-6), reach_)) {
    // One end of a cut edge is within half the edge's length of the face. A millionth more covers
    // the rounding of these distances.
    for (const Corners& face : faces) around_.emplace_back(face, 0.5 * reach_);
  }
  CutCandidates run(const NodeGrid& grid, NodeId first_new) {
    if (!(reach_ > 0)) return {};  // no edge yet
    walk(grid, 0, first_new.value);
    walk(graph_.guides().grid(), GraphStorage::guide_id(0), ~0u);
    return std::move(found_);
  }

 private:
  struct Cube {
    std::size_t begin, end;  // range of cube_faces_: faces that reach into it
    std::size_t region;
  };
  // A cube of the grid, one for several of the small cubes, whose nodes share a slab.
  struct Region {
    Vec3 middle;
    double half;
    std::uint32_t slab = ~0u;  // none yet
  };
  struct Suspect {
    std::uint32_t id, cube;
  };

  // Walks a grid whose indices below `end` are ids from `base` on.
  void walk(const NodeGrid& grid, std::uint32_t base, std::uint32_t end) {
    constexpr int none = std::numeric_limits<int>::max();
    faces_at_.resize(std::max<std::size_t>(faces_at_.size(), 1));
    faces_at_[0].resize(faces_.size());
    std::iota(faces_at_[0].begin(), faces_at_[0].end(), 0u);
    std::size_t depth_of_cube = 0;  // of the last cube entered
    bool is_new = false;
    int whole = none;  // depth of a cube so small that all nodes in it are suspects
    int depth_of_region = none;
    const auto enter = [&](int depth, const Vec3& middle, double half) {
      if (depth > whole) return true;
      const auto at = static_cast<std::size_t>(depth) + 1;
      if (faces_at_.size() <= at) faces_at_.resize(at + 1);
      faces_at_[at].clear();
      for (const auto f : faces_at_[at - 1])
        if (around_[f].reaches(middle, half * (1 + 1e-12))) faces_at_[at].push_back(f);
      const bool enters = !faces_at_[at].empty();
      whole = enters && 2 * half <= support_ ? depth : none;
      if (!enters) return false;
      depth_of_cube = at;
      is_new = true;
      if (depth <= depth_of_region) {
        regions_.push_back({middle, half});
        depth_of_region = half <= region_size * support_ ? depth : none;
      }
      return true;
    };
    grid.walk(enter, [&](int, std::uint32_t index) {
      if (index >= end) return;
      if (is_new) {
        if (suspects_.size() >= batch) test_suspects();
        const auto& here = faces_at_[depth_of_cube];
        cubes_.push_back({cube_faces_.size(), cube_faces_.size() + here.size(), regions_.size() - 1});
        cube_faces_.insert(cube_faces_.end(), here.begin(), here.end());
        is_new = false;
      }
      suspects_.push_back({base + index, static_cast<std::uint32_t>(cubes_.size() - 1)});
      __builtin_prefetch(&graph_.position(nodes_, base + index));
    });
    test_suspects();
  }

  // Keeps the suspects that are near a face, and empties the batch.
  void test_suspects() {
    far_edges_only_.clear();
    std::size_t count = 0;
    for (const auto& suspect : suspects_) {
      const Vec3& x = graph_.position(nodes_, suspect.id);
      const Cube& cube = cubes_[suspect.cube];
      const Slab& slab = slab_of(regions_[cube.region]);
      if (!slab.within(slab.height(x), 0.5 * reach_)) continue;
      const auto within = [&](double length) {
        for (auto f = cube.begin; f < cube.end; ++f)
          if (around_[cube_faces_[f]].holds(x, 0.5 * length)) return true;
        return false;
      };
      // Only few nodes have edges longer than the support.
      const bool is_near = within(support_);
      if (!is_near && !(reach_ > support_ && within(reach_))) continue;
      graph_.store(suspect.id).prefetch_location(GraphStorage::index_of(suspect.id));
      far_edges_only_.push_back(!is_near);
      suspects_[count++] = suspect;
    }
    for (std::size_t k = 0; k < count; ++k) {
      const auto id = suspects_[k].id;
      if (far_edges_only_[k] && !graph_.store(id).has_edge_only_entries(GraphStorage::index_of(id))) continue;
      found_.ids.push_back(id);
      found_.slabs.push_back(regions_[cubes_[suspects_[k].cube].region].slab);
    }
    suspects_.clear();
    cubes_.clear();
    cube_faces_.clear();
  }

  const Slab& slab_of(Region& region) {
    if (region.slab == ~0u) {
      indices_.clear();
      const Vec3 extent = Vec3::Constant(region.half + reach_);
      tree_.near({region.middle - extent, region.middle + extent}, indices_);
      region.slab = static_cast<std::uint32_t>(found_.slab.size());
      found_.slab.emplace_back(faces_, indices_, region.middle, 2 * extent.x());
    }
    return found_.slab[region.slab];
  }

  // Larger regions: fewer slabs, each with more faces and so thicker. The result is the same.
  static constexpr double region_size = 1;   // half its edge at most, in supports
  static constexpr std::size_t batch = 256;  // suspects: enough for prefetches to arrive
  const NodeSet& nodes_;
  const GraphStorage& graph_;
  std::span<const Corners> faces_;
  const TriangleBvh& tree_;
  double reach_, support_;
  std::vector<Surroundings> around_;
  std::vector<std::vector<std::uint32_t>> faces_at_;  // by depth, from 1: those that reach into the cube
  std::vector<Cube> cubes_;
  std::vector<Region> regions_;
  std::vector<std::uint32_t> cube_faces_, indices_;
  std::vector<Suspect> suspects_;
  std::vector<std::uint8_t> far_edges_only_;
  CutCandidates found_;
};

}  // namespace

Slab::Slab(std::span<const Corners> faces, std::span<const std::uint32_t> indices, const Vec3& origin, double reach)
    : origin(origin) {
  double largest = -1, far = reach;
  for (const auto f : indices)
    if (const Vec3 n = (faces[f][1] - faces[f][0]).cross(faces[f][2] - faces[f][0]); n.squaredNorm() > largest) {
      largest = n.squaredNorm();
      normal = n;
    }
  for (const auto f : indices)
    for (const Vec3& corner : faces[f]) {
      const double h = height(corner);
      from = std::min(from, h);
      to = std::max(to, h);
      far = std::max(far, (corner - origin).lpNorm<Eigen::Infinity>());
    }
  // A height takes six operations, each with an error of 2⁻⁵³ of a sum no larger than this.
  const double rounding = 0x1p-49 * normal.lpNorm<1>() * far;
  from -= rounding;
  to += rounding;
  // Rounded up: norm() is off by a few ulps (2⁻⁵³) at most.
  length = normal.norm() * (1 + 1e-12);
}

CutCandidates find_cut_candidates(const NodeSet& nodes, const GraphStorage& graph, const NodeGrid& grid,
                                  NodeId first_new, std::span<const Corners> faces, const TriangleBvh& tree) {
  return Search(nodes, graph, faces, tree).run(grid, first_new);
}

}  // namespace geo
