#include "graph/severed.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "geometry/bvh.h"
#include "graph/id_flags.h"
#include "graph/id_map.h"

namespace geo {
namespace {

using Corners = std::array<Vec3, 3>;
constexpr double infinity = std::numeric_limits<double>::infinity();

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
  /// False only for what is farther than `distance`, which is `reach` at most.
  bool holds(const Vec3& x, double distance) const {
    const double less = reach - distance;
    return x.x() >= around.lo.x() + less && x.x() <= around.hi.x() - less && x.y() >= around.lo.y() + less && x.y() <= around.hi.y() - less &&
           x.z() >= around.lo.z() + less && x.z() <= around.hi.z() - less && plane.within(x, distance);
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

// The stretch that some faces cover along one's normal, from `origin`, and some more: a segment beyond it touches none.
struct Slab {
  Slab(std::span<const Corners> faces, std::span<const std::uint32_t> rows, const Vec3& origin, double reach) : origin(origin) {
    double largest = -1, far = reach;
    for (const auto f : rows)
      if (const Vec3 n = (faces[f][1] - faces[f][0]).cross(faces[f][2] - faces[f][0]); n.squaredNorm() > largest) largest = n.squaredNorm(), normal = n;
    for (const auto f : rows)
      for (const Vec3& corner : faces[f]) {
        const double h = height(corner);
        from = std::min(from, h), to = std::max(to, h), far = std::max(far, (corner - origin).lpNorm<Eigen::Infinity>());
      }
    // A height takes six operations, each with an error of 2⁻⁵³ of a sum no larger than this.
    const double rounding = 0x1p-49 * normal.lpNorm<1>() * far;
    from -= rounding, to += rounding;
  }
  double height(const Vec3& x) const {
    return ((x.x() - origin.x()) * normal.x() + (x.y() - origin.y()) * normal.y()) + (x.z() - origin.z()) * normal.z();
  }
  Vec3 origin, normal = Vec3::Zero();
  double from = infinity, to = -infinity;
};

// Nodes and guides: one end at least of everything that the faces cut.
struct Near {
  std::vector<std::uint32_t> ids, slabs;  // for each id, one of `slab`
  std::vector<Slab> slab;                 // of all faces within reach
};

Near near_faces(const NodeSet& nodes, const VisibilityGraph& graph, const NodeGrid& grid, NodeId first_new, std::span<const Corners> faces,
                const TriangleBvh& tree) {
  // What a face cuts has one end within half its length. A millionth more covers the rounding of these distances.
  const double reach = graph.reach() * (1 + 1e-6), support = std::min(graph.support() * (1 + 1e-6), reach);
  Near near;
  if (!(reach > 0)) return near;  // no edge yet
  std::vector<Surroundings> around;
  std::vector<std::vector<std::uint32_t>> faces_at(1);  // by depth: those that reach into the cube
  for (std::uint32_t f = 0; f < faces.size(); ++f) around.emplace_back(faces[f], 0.5 * reach), faces_at[0].push_back(f);
  Vec3 cube = Vec3::Zero();  // the cube entered last
  double cube_size = 0;
  bool has_slab = false;
  const auto into = [&](int depth, const Vec3& middle, double size) {
    const auto to = static_cast<std::size_t>(depth) + 1;
    if (faces_at.size() <= to) faces_at.resize(to + 1);
    faces_at[to].clear();
    for (const auto f : faces_at[to - 1])
      if (around[f].reaches(middle, size * (1 + 1e-12))) faces_at[to].push_back(f);
    cube = middle, cube_size = size, has_slab = false;
    return !faces_at[to].empty();
  };
  std::vector<std::uint32_t> rows;
  const auto see = [&](int depth, std::uint32_t id) {
    const Vec3& x = graph.position(nodes, id);
    const auto& here = faces_at[static_cast<std::size_t>(depth) + 1];
    const auto within = [&](double length) { return std::any_of(here.begin(), here.end(), [&](std::uint32_t f) { return around[f].holds(x, 0.5 * length); }); };
    // Only few nodes have edges longer than the support.
    if (!within(support) && !(reach > support && within(reach) && graph.store(id).has_bare_edges(VisibilityGraph::place(id)))) return;
    if (!has_slab) {
      rows.clear();
      const Vec3 way = Vec3::Constant(cube_size + reach);
      tree.near({cube - way, cube + way}, rows);
      near.slab.emplace_back(faces, rows, cube, 2 * way.x());
      has_slab = true;
    }
    near.ids.push_back(id), near.slabs.push_back(static_cast<std::uint32_t>(near.slab.size() - 1));
  };
  grid.walk(into, [&](int depth, std::uint32_t i) {
    if (i < first_new.value) see(depth, i);
  });
  graph.guides().grid().walk(into, [&](int depth, std::uint32_t g) { see(depth, VisibilityGraph::first_guide + g); });
  return near;
}

std::size_t guides_in(const RowView& row) {
  std::size_t count = 0;
  while (count < row.to.size() && VisibilityGraph::is_guide(row.to[row.to.size() - 1 - count])) ++count;
  return count;
}

struct Pair {
  std::uint32_t a, b;  // numbers of ids
  std::uint16_t bits;
};

// Pairs are put in rows from both ends, in any order. Then each entry goes to the row of its other end, rows ascending: these
// are the same rows, but in order.
Severed rows_of(std::span<const Pair> pairs, std::span<const std::uint32_t> ids, const std::vector<bool>& above) {
  Severed severed;
  std::vector<std::uint64_t> order;
  for (std::uint32_t k = 0; k < ids.size(); ++k) order.push_back(std::uint64_t(ids[k]) << 32 | k);
  std::sort(order.begin(), order.end());
  std::vector<std::uint32_t> next(ids.size(), 0);  // how many entries, then where the next one goes
  for (const Pair& p : pairs) ++next[p.a], ++next[p.b];
  std::uint32_t sum = 0;
  for (const auto entry : order) {
    const auto k = static_cast<std::uint32_t>(entry), count = std::exchange(next[k], sum);
    severed.rows.push_back({ids[k], sum, sum + count, above[k]});
    sum += count;
  }
  std::vector<Severed::Entry> mixed(sum);
  auto next_mixed = next;
  for (const Pair& p : pairs) mixed[next_mixed[p.a]++] = {p.b, p.bits}, mixed[next_mixed[p.b]++] = {p.a, p.bits};
  severed.entries.resize(sum);
  for (const auto& row : severed.rows)
    for (auto e = row.begin; e < row.end; ++e) severed.entries[next[mixed[e].to]++] = {row.id, mixed[e].bits};
  return severed;
}

}  // namespace

Severed find_severed(const NodeSet& nodes, const VisibilityGraph& graph, const NodeGrid& grid, NodeId first_new,
                     std::span<const Corners> faces) {
  const TriangleBvh tree(faces);
  const Near near = near_faces(nodes, graph, grid, first_new, faces, tree);
  if (near.ids.empty()) return {};
  thread_local IdFlags has_asked;
  thread_local IdMap number;  // of those that lose something
  has_asked.clear();
  number.clear(near.ids.size());
  std::vector<Pair> pairs;
  std::vector<bool> is_above;  // by number
  std::vector<std::uint32_t> asked;
  std::vector<Vec3> ends;
  std::vector<std::uint8_t> blocked;
  for (std::uint32_t at = 0; at < near.ids.size(); ++at) {
    constexpr std::size_t ahead = 4;
    if (at + 2 * ahead < near.ids.size()) graph.store(near.ids[at + 2 * ahead]).prefetch_place(VisibilityGraph::place(near.ids[at + 2 * ahead]));
    if (at + ahead < near.ids.size()) graph.store(near.ids[at + ahead]).prefetch(VisibilityGraph::place(near.ids[at + ahead]));
    const auto i = near.ids[at];
    const auto row = graph.entries(i);
    // What is not beyond the slab on the same side.
    const Slab& slab = near.slab[near.slabs[at]];
    const double height = slab.height(graph.position(nodes, i));
    const double least = height < slab.from ? slab.from : -infinity, most = height > slab.to ? slab.to : infinity;
    asked.resize(std::max(asked.size(), row.to.size()));
    std::size_t count = 0;
    const auto ask = [&](std::uint32_t k, const Vec3& x) {
      const double h = slab.height(x);
      asked[count] = k;
      count += (h >= least) & (h <= most);
    };
    std::uint32_t k = 0;
    for (const auto end = static_cast<std::uint32_t>(row.to.size() - guides_in(row)); k < end; ++k) ask(k, nodes.position[row.to[k]]);
    for (; k < row.to.size(); ++k) ask(k, graph.position(nodes, row.to[k]));
    ends.clear();
    std::size_t kept = 0;
    for (std::size_t a = 0; a < count; ++a) {
      const auto j = row.to[asked[a]];
      asked[kept] = asked[a];
      kept += !has_asked.has(j);
    }
    for (std::size_t a = 0; a < kept; ++a) ends.push_back(graph.position(nodes, row.to[asked[a]]));
    has_asked.add(i);
    blocked.resize(kept);
    tree.blocks(graph.position(nodes, i), ends, blocked.data());
    const auto first = std::find(blocked.begin(), blocked.end(), 1) - blocked.begin();
    if (static_cast<std::size_t>(first) == kept) continue;
    const auto number_of = [&](std::uint32_t id) {
      const auto it = number.add(id);
      if (it == is_above.size()) is_above.push_back(2 * slab.height(graph.position(nodes, id)) > slab.from + slab.to);
      return it;
    };
    const auto mine = number_of(i);
    for (auto a = static_cast<std::size_t>(first); a < kept; ++a)
      if (blocked[a]) pairs.push_back({mine, number_of(row.to[asked[a]]), row.bits[asked[a]]});
  }
  return rows_of(pairs, number.ids(), is_above);
}

}  // namespace geo
