// Passages too narrow for the sampling, and pieces without a node.
#include <algorithm>
#include <deque>
#include <set>
#include <unordered_map>

#include "base/random.h"
#include "body/binding.h"
#include "body/connect.h"
#include "body/locate.h"
#include "body/way_along.h"
#include "geometry/bvh.h"

namespace geo {
namespace {

// Nodes along the surface from where i looks at it to where j does: what the material joins is
// joined beside its boundary, however narrow it is. False, and no nodes, when the two see different
// shells only or doubles are too coarse.
bool insert_along(Body& body, NodeId i, NodeId j, double spacing, std::vector<NodePair>& joins) {
  const Complex& k = body.surface;
  const auto way = way_along(k, body.nodes.position[i.index()], body.nodes.position[j.index()], spacing);
  if (way.empty()) return false;
  // As few of them as see each other, none farther apart than the nodes are anyway. All give volume
  // in turn.
  std::deque<NodeId> donors{i};
  NodeId last = i;
  for (std::size_t s = 0; s + 1 < way.size();) {
    std::size_t next = s + 1;
    for (std::size_t n = s + 2; n < way.size() && (way[n] - way[s]).norm() <= body.grid.cell(); ++n)
      if (!is_blocked(k, way[s], way[n])) next = n;
    NodeId node = j;
    if (next + 1 < way.size()) {
      node = insert_node(body, way[next], donors.front(), spacing);
      donors.push_back(donors.front()), donors.push_back(node);
      donors.pop_front();
    }
    joins.push_back({std::min(last, node), std::max(last, node)});
    last = node;
    s = next;
  }
  return true;
}

NodeId insert_into(Body& body, SurfaceVertexId v) {
  const auto nearest = [&](const Vec3& x) {
    return NodeId(body.grid.nearest(body.nodes.position, x, 1, ~0u, [](auto) { return true; })[0]);
  };
  const double spacing = body.nodes.spacing[nearest(body.surface.point(body.surface.site(v))).index()];
  const auto x = room_in(body.surface, v, spacing,
                         [&](Side s) { return body.upkeep.piece[body.surface.surface_vertex(s, 0).index()]; });
  return x ? insert_node(body, *x, nearest(*x), spacing) : NodeId();
}

/// Finds other nodes of a node's piece; what was found out about a node is kept.
class Neighborhood {
 public:
  explicit Neighborhood(const Body& body) : body_(body), count_(static_cast<std::uint32_t>(body.nodes.size())) {}
  /// The nodes nearest to i in its piece, without those of `part` (ascending) and without nodes
  /// inserted since.
  std::vector<std::uint32_t> nearest(NodeId i, std::size_t count, const std::vector<std::uint32_t>& part) {
    const auto piece = of(i.value);
    return body_.grid.nearest(body_.nodes.position, body_.nodes.position[i.index()], count, i.value,
                              [&](std::uint32_t n) {
                                return n < count_ && !std::binary_search(part.begin(), part.end(), n) && of(n) == piece;
                              });
  }

 private:
  std::int32_t of(std::uint32_t i) {
    const auto [at, fresh] = piece_.try_emplace(i, 0);
    return fresh ? at->second = piece_of(body_, NodeId(i)) : at->second;
  }
  const Body& body_;
  std::uint32_t count_;
  std::unordered_map<std::uint32_t, std::int32_t> piece_;
};

// An edge between a part of G and another part of the same piece, not longer than edges are anyway:
// what is hidden from its k nearest nodes may see others. At most 16 of the part's nodes are asked.
bool join_by_sight(const Body& body, Neighborhood& pieces, const std::vector<std::uint32_t>& part,
                   std::vector<NodePair>& joins) {
  for (std::size_t n = 0; n < part.size(); n += 1 + part.size() / 16)
    for (const auto other : pieces.nearest(NodeId(part[n]), 8, part)) {
      const Vec3 &p = body.nodes.position[part[n]], &q = body.nodes.position[other];
      const auto [low, high] = std::minmax(part[n], other);
      if ((p - q).norm() > longest_reach(body) ||
          is_blocked(body.surface, body.nodes.position[low], body.nodes.position[high]))
        continue;
      joins.push_back({NodeId(low), NodeId(high)});
      return true;
    }
  return false;
}

// Needles have faces so narrow that their normals lead astray: of points between corners the
// clearest.
std::optional<Vec3> room_between(const Complex& k, const std::vector<std::pair<double, Side>>& sides,
                                 const std::function<std::int32_t(Side)>& piece, std::int32_t wanted) {
  constexpr std::size_t most_sides = 64;
  constexpr int most_tries = 256;
  if (sides.size() > most_sides) return {};  // no crumb
  std::vector<std::array<Vec3, 3>> around;
  std::vector<Vec3> corners;
  for (const auto& [area, s] : sides) {
    const Side other{s.face, 1 - s.which};
    const auto t = k.corners(s.face);
    if (!k.has(other) || piece(other) != wanted) around.push_back(t);
    corners.insert(corners.end(), t.begin(), t.end());
  }
  const TriangleBvh boundary(around);
  Random random(corners.size());
  std::optional<Vec3> best;
  double clear = 0;
  for (int i = 0; i < most_tries; ++i) {
    const auto corner = [&]() -> const Vec3& {
      return corners[random.below(static_cast<std::uint32_t>(corners.size()))];
    };
    const double u = random.uniform(), v = random.uniform(), w = random.uniform();
    const Vec3 &a = corner(), &b = corner(), &c = corner(), &d = corner();
    const Vec3 x = (1 - u) * a + u * ((1 - v) * b + v * ((1 - w) * c + w * d));
    const double distance = boundary.inside(x) ? boundary.closest(x).distance : 0;
    if (distance > clear && !is_blocked(k, x, x) && piece_around(k, x, piece) == wanted) clear = distance, best = x;
  }
  return best;
}

}  // namespace

std::optional<Vec3> room_in(const Complex& k, SurfaceVertexId v, double reach,
                            const std::function<std::int32_t(Side)>& piece) {
  const auto wanted = piece(k.corner_of(v).first);
  std::vector<SurfaceVertexId> shell{v}, around;
  std::set<SurfaceVertexId> seen{v};
  std::vector<std::pair<double, Side>> sides;  // by area, the largest first
  for (std::size_t i = 0; i < shell.size(); ++i) {
    for (const FaceId f : k.faces_at(k.site(shell[i])))
      for (int which = 0; which < 2; ++which)
        for (int c = 0; c < 3; ++c) {
          if (!k.has({f, which}) || k.surface_vertex({f, which}, c) != shell[i]) continue;
          const auto t = k.corners(f);
          sides.push_back({-(t[1] - t[0]).cross(t[2] - t[0]).norm(), Side{f, which}});
        }
    around.clear();
    k.surface_neighbors(shell[i], around);
    for (const auto w : around)
      if (seen.insert(w).second) shell.push_back(w);
  }
  std::sort(sides.begin(), sides.end());
  sides.erase(std::unique(sides.begin(), sides.end()), sides.end());
  for (std::size_t i = 0; i < std::min<std::size_t>(sides.size(), 16); ++i) {
    const Side s = sides[i].second;
    const auto t = k.corners(s.face);
    const Vec3 middle = (t[0] + t[1] + t[2]) / 3;
    const Vec3 inwards = (s.which ? 1.0 : -1.0) * (t[1] - t[0]).cross(t[2] - t[0]).normalized();
    for (double step = reach; step > 1e-16 * k.extent().diagonal(); step *= 0.6) {
      const Vec3 x = middle + 0.5 * step * inwards;
      if (stands_before(k, s, middle, middle + step * inwards) && stands_before(k, s, middle, x) &&
          !is_blocked(k, x, x) && piece_around(k, x, piece) == wanted)
        return x;
    }
  }
  return room_between(k, sides, piece, wanted);
}

void mend(Body& body, Disagreement& found, const GraphUpdater& after) {
  double scale = 0.7;
  // For a way, once, though later rounds look a little nearer: one that is not found takes longest,
  // and few are found at a second try.
  std::set<std::pair<NodeId, NodeId>> asked;
  for (int round = 0; round < 12 && !found.none(); ++round, scale *= 0.8) {
    const NodeId first_new(body.nodes.size());
    for (const auto v : found.empty) {
      const auto piece = body.upkeep.piece[v.index()];
      if (const NodeId i = insert_into(body, v); i.valid())
        found.known[piece] = i, body.upkeep.bare.erase(piece);
      else
        found.known.erase(piece), body.upkeep.bare.insert(piece);
    }
    Regions before = components_of(body);
    Neighborhood pieces(body);
    std::vector<NodePair> joins;
    std::vector<FaceId> narrow;
    std::set<std::uint32_t> done;  // parts, by their lowest nodes
    for (const auto& [a, b] : found.apart) {
      before.seed(a.value), before.seed(b.value);
      if (before.joined(a.value, b.value)) continue;
      const NodeId i = before.whole(a.value) ? a : b;  // in the smaller part
      if (!done.insert(before.lowest(i.value)).second) continue;
      auto part = before.inside(i.value);
      std::sort(part.begin(), part.end());
      if (join_by_sight(body, pieces, part, joins)) continue;
      if (round == 0)
        for (const auto n : part)
          body.surface.faces_near(
              Box3{body.nodes.position[n], body.nodes.position[n]}.grown(1.5 * body.nodes.spacing[n]), narrow);
      else
        for (const NodeId from : {i, NodeId(part.front()), NodeId(part.back())}) {
          const auto near = pieces.nearest(from, 4, part);
          const auto finds_way = [&](auto to) {
            return asked.insert({from, NodeId(to)}).second &&
                   insert_along(body, from, NodeId(to), scale * body.grid.cell(), joins);
          };
          if (std::any_of(near.begin(), near.end(), finds_way)) break;
        }
    }
    std::sort(narrow.begin(), narrow.end());
    narrow.erase(std::unique(narrow.begin(), narrow.end()), narrow.end());
    // Bounded, so that a passage that stays closed costs little.
    insert_near(body, narrow, scale * body.grid.cell(), 0x6b657266u, 100);
    if (first_new.index() < body.nodes.size() || !joins.empty())
      after(first_new, joins);
    else if (round >= 1)
      return;
    Disagreement left;
    left.known = std::move(found.known);
    Regions now = components_of(body);
    for (const auto& [a, b] : found.apart) {
      now.seed(a.value), now.seed(b.value);
      if (!now.joined(a.value, b.value)) left.apart.push_back({a, b});
    }
    pair_new_nodes(body, now, first_new, left);
    found = std::move(left);
  }
}

}  // namespace geo
