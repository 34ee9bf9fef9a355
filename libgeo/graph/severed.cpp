#include "graph/severed.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "geometry/bvh.h"
#include "graph/id_map.h"

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
  /// False only when x is farther from the plane than `distance`.
  bool within(const Vec3& x, double distance) const {
    const double a = x.x() - origin_.x(), b = x.y() - origin_.y(), c = x.z() - origin_.z();
    const double height = (a * normal_.x() + b * normal_.y()) + c * normal_.z(), error = rounding_ * ((std::abs(a) + std::abs(b)) + std::abs(c));
    return std::abs(height) <= error + (length_ + rounding_) * distance;
  }

 private:
  Vec3 origin_, normal_;
  double length_, rounding_;
};

// Which nodes a face may cut something of: those within `reach` of it, and some more.
struct Surroundings {
  Surroundings(const Corners& t, double reach) : plane(t), around(box_of(t[0], t[1], t[2]).grown(reach)), reach(reach) {}
  bool holds(const Vec3& x) const {
    return x.x() >= around.lo.x() && x.x() <= around.hi.x() && x.y() >= around.lo.y() && x.y() <= around.hi.y() && x.z() >= around.lo.z() &&
           x.z() <= around.hi.z() && plane.within(x, reach);
  }
  /// True unless it holds nothing of the cube.
  bool reaches(const Vec3& middle, double half) const {
    const Box3 cube{middle - Vec3::Constant(half), middle + Vec3::Constant(half)};
    return cube.meets(around) && plane.within(middle, reach + std::sqrt(3.0) * half);
  }
  Plane plane;
  Box3 around;
  double reach;
};

// Nodes and guides, ascending, which have one end at least of everything that the faces cut.
std::vector<std::uint32_t> near_faces(const NodeSet& nodes, const VisibilityGraph& graph, const NodeGrid& grid, NodeId first_new,
                                      std::span<const Corners> faces) {
  // What a face cuts has one end within half its length. A millionth more covers the rounding of these distances.
  const double half = 0.5 * graph.reach() * (1 + 1e-6);
  std::vector<std::uint32_t> near;
  if (!(half > 0)) return near;  // no edge yet
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
  const auto see = [&](int depth, std::uint32_t id) {
    const Vec3& x = graph.position(nodes, id);
    const auto& here = faces_at[static_cast<std::size_t>(depth) + 1];
    if (std::any_of(here.begin(), here.end(), [&](std::uint32_t f) { return around[f].holds(x); })) near.push_back(id);
  };
  grid.walk(into, [&](int depth, std::uint32_t i) {
    if (i < first_new.value) see(depth, i);
  });
  graph.guides().grid().walk(into, [&](int depth, std::uint32_t g) { see(depth, VisibilityGraph::first_guide + g); });
  std::sort(near.begin(), near.end());
  return near;
}

struct Pair {
  std::uint32_t a, b;  // numbers of ids
  std::uint16_t bits;
};

Severed rows_of(std::span<const Pair> pairs, std::span<const std::uint32_t> ids) {
  Severed severed;
  std::vector<std::uint64_t> order;
  for (std::uint32_t k = 0; k < ids.size(); ++k) order.push_back(std::uint64_t(ids[k]) << 32 | k);
  std::sort(order.begin(), order.end());
  std::vector<std::uint32_t> next(ids.size(), 0);  // how many entries, then where the next one goes
  for (const Pair& p : pairs) ++next[p.a], ++next[p.b];
  std::uint32_t sum = 0;
  for (const auto entry : order) {
    const auto k = static_cast<std::uint32_t>(entry), count = std::exchange(next[k], sum);
    if (count > 0) severed.rows.push_back({ids[k], sum, sum + count});
    sum += count;
  }
  severed.entries.resize(sum);
  for (const Pair& p : pairs) severed.entries[next[p.a]++] = {ids[p.b], p.bits}, severed.entries[next[p.b]++] = {ids[p.a], p.bits};
  for (const auto& row : severed.rows)
    std::sort(severed.entries.begin() + row.begin, severed.entries.begin() + row.end, [](const auto& x, const auto& y) { return x.to < y.to; });
  return severed;
}

}  // namespace

Severed find_severed(const NodeSet& nodes, const VisibilityGraph& graph, const NodeGrid& grid, NodeId first_new,
                     std::span<const Corners> faces) {
  const auto near = near_faces(nodes, graph, grid, first_new, faces);
  if (near.empty()) return {};
  const TriangleBvh tree(faces);
  IdMap number;
  number.clear(near.size());
  for (const auto i : near) number.add(i);
  std::vector<Pair> pairs;
  std::vector<std::size_t> asked;
  std::vector<Vec3> ends;
  std::vector<std::uint8_t> blocked;
  for (std::uint32_t at = 0; at < near.size(); ++at) {
    constexpr std::size_t ahead = 4;
    if (at + 2 * ahead < near.size()) graph.store(near[at + 2 * ahead]).prefetch_place(VisibilityGraph::place(near[at + 2 * ahead]));
    if (at + ahead < near.size()) graph.store(near[at + ahead]).prefetch(VisibilityGraph::place(near[at + ahead]));
    const auto i = near[at];
    const auto row = graph.entries(i);
    asked.clear(), ends.clear();
    for (std::size_t k = 0; k < row.to.size(); ++k)
      if (row.to[k] > i || number.find(row.to[k]) >= near.size()) asked.push_back(k), ends.push_back(graph.position(nodes, row.to[k]));  // else j has asked
    blocked.assign(asked.size(), 0);
    tree.blocks(graph.position(nodes, i), ends, blocked.data());
    for (std::size_t a = 0; a < asked.size(); ++a)
      if (blocked[a]) pairs.push_back({at, number.add(row.to[asked[a]]), row.bits[asked[a]]});
  }
  return rows_of(pairs, number.ids());
}

}  // namespace geo
