// repair_connectivity() of body/connectivity.h: narrow passages, pieces without a node (§ 6.4).
// Components that see each other get an edge. Else nodes are put at the passage's walls, if these
// connect them, or along a taut path (docs/decisions/032).
#include <algorithm>
#include <deque>
#include <set>
#include <unordered_map>

#include "base/random.h"
#include "base/union_find.h"
#include "body/binding.h"
#include "body/connectivity.h"
#include "body/locate.h"
#include "body/taut_path.h"
#include "geometry/bvh.h"

namespace geo {
namespace {

// The node at exactly this place, if there is one: two taut paths through one passage may share
// their corners.
NodeId node_at(const Body& body, const Vec3& x) {
  const auto nearest = body.cache->grid.nearest(body.nodes.position, x, 1, ~0u, [](std::uint32_t) { return true; });
  return !nearest.empty() && body.nodes.position[nearest[0]] == x ? NodeId(nearest[0]) : NodeId();
}

// Inserts nodes along a taut path from node i to node j and records their joins. False, and no
// nodes, when there is no such path.
bool insert_nodes_along(NewNodes& inserted, NodeId i, NodeId j, double spacing, std::vector<NodePair>& joins) {
  const Body& body = inserted.body();
  const Complex& k = body.surface;
  const auto path = taut_path(k, body.nodes.position[i.index()], body.nodes.position[j.index()], spacing);
  if (path.empty()) return false;
  // As few nodes as see each other, none farther apart than a grid cell. They give volume in turn.
  std::deque<NodeId> donors{i};
  NodeId last = i;
  for (std::size_t s = 0; s + 1 < path.size();) {
    std::size_t next = s + 1;
    for (std::size_t n = s + 2; n < path.size() && (path[n] - path[s]).norm() <= body.cache->grid.cell(); ++n)
      if (!is_blocked(k, path[s], path[n])) next = n;
    NodeId node = j;
    if (next + 1 < path.size()) {
      node = node_at(body, path[next]);
      if (!node.valid()) {
        node = inserted.insert(path[next], donors.front(), spacing);
        donors.push_back(donors.front());
        donors.push_back(node);
        donors.pop_front();
      }
    }
    if (node != last) joins.push_back({std::min(last, node), std::max(last, node)});
    last = node;
    s = next;
  }
  return true;
}

// The node that gives volume and motion to a new one at x, in a piece without nodes: the nearest in
// `parts`, the pieces that were one with it before the step; else the nearest of all. A node of
// another piece may have moved far away.
NodeId donor_of(const Body& body, const Vec3& x, const std::set<std::int32_t>& parts) {
  const auto nearest = [&](const auto& accept) {
    const auto found = body.cache->grid.nearest(body.nodes.position, x, 1, ~0u, accept);
    return found.empty() ? NodeId() : NodeId(found[0]);
  };
  NodeId donor;
  if (!parts.empty()) donor = nearest([&](std::uint32_t i) { return parts.count(piece_of(body, NodeId(i))) != 0; });
  return donor.valid() ? donor : nearest([](std::uint32_t) { return true; });
}

// Inserts a node into the piece without nodes that has surface vertex v; invalid where none fits.
NodeId insert_node_into_piece(NewNodes& inserted, SurfaceVertexId v, const std::set<std::int32_t>& parts) {
  const Body& body = inserted.body();
  const NodeId near = donor_of(body, body.surface.point(body.surface.site(v)), {});
  const double spacing = body.nodes.spacing[near.index()];
  const auto x = point_in_piece(body.surface, v, spacing,
                                [&](Side s) { return body.cache->piece[body.surface.surface_vertex(s, 0).index()]; });
  return x ? inserted.insert(*x, donor_of(body, *x, parts), spacing) : NodeId();
}

// Nearest nodes within a piece. Remembers the pieces of nodes; ignores nodes inserted later.
class NearestInPiece {
 public:
  explicit NearestInPiece(const Body& body) : body_(body), count_(static_cast<std::uint32_t>(body.nodes.size())) {}
  /// The nodes nearest to i in its piece, without those of `component` (ascending).
  std::vector<std::uint32_t> outside(NodeId i, std::size_t count, const std::vector<std::uint32_t>& component) {
    const auto piece = piece_of_node(i.value);
    return body_.cache->grid.nearest(
        body_.nodes.position, body_.nodes.position[i.index()], count, i.value, [&](std::uint32_t n) {
          return n < count_ && !std::binary_search(component.begin(), component.end(), n) && piece_of_node(n) == piece;
        });
  }

  /// piece_of() a node.
  std::int32_t piece_of_node(std::uint32_t i) {
    const auto [at, fresh] = piece_.try_emplace(i, 0);
    return fresh ? at->second = piece_of(body_, NodeId(i)) : at->second;
  }

 private:
  const Body& body_;
  std::uint32_t count_;
  std::unordered_map<std::uint32_t, std::int32_t> piece_;
};

// Joins a component to another one of its piece by a visible edge no longer than the longest
// support radius. The k nearest nodes of a node may all be hidden while others are visible. Tests
// at most 16 nodes of the component, each against 8 others. If none succeeds, nodes are inserted.
bool join_by_visible_edge(const Body& body, NearestInPiece& nearest, const std::vector<std::uint32_t>& component,
                          std::vector<NodePair>& joins) {
  for (std::size_t n = 0; n < component.size(); n += 1 + component.size() / 16)
    for (const auto other : nearest.outside(NodeId(component[n]), 8, component)) {
      const Vec3 &p = body.nodes.position[component[n]], &q = body.nodes.position[other];
      const auto [low, high] = std::minmax(component[n], other);
      if ((p - q).norm() > longest_reach(body) ||
          is_blocked(body.surface, body.nodes.position[low], body.nodes.position[high]))
        continue;
      joins.push_back({NodeId(low), NodeId(high)});
      return true;
    }
  return false;
}

using SideByArea = std::pair<double, Side>;  // −2 × area first, so that the largest sorts first

// The sides of the shell of surface vertex v, the largest first.
std::vector<SideByArea> sides_of_shell(const Complex& k, SurfaceVertexId v) {
  std::vector<SurfaceVertexId> shell{v}, around;
  std::set<SurfaceVertexId> visited{v};
  std::vector<SideByArea> sides;
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
      if (visited.insert(w).second) shell.push_back(w);
  }
  std::sort(sides.begin(), sides.end());
  sides.erase(std::unique(sides.begin(), sides.end()), sides.end());
  return sides;
}

// For needles, whose normals are mostly rounding: the best of 256 random convex combinations of
// four corners, by distance from the boundary. More samples: thinner needles get a node.
std::optional<Vec3> point_between_corners(const Complex& k, const std::vector<SideByArea>& sides,
                                          const std::function<std::int32_t(Side)>& piece, std::int32_t wanted) {
  constexpr std::size_t max_sides = 64;  // slivers too thin for other points have few
  constexpr int samples = 256;
  if (sides.size() > max_sides) return {};
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
  double clearance = 0;
  for (int i = 0; i < samples; ++i) {
    const auto corner = [&]() -> const Vec3& {
      return corners[random.below(static_cast<std::uint32_t>(corners.size()))];
    };
    const double u = random.uniform(), v = random.uniform(), w = random.uniform();
    const Vec3 &a = corner(), &b = corner(), &c = corner(), &d = corner();
    const Vec3 x = (1 - u) * a + u * ((1 - v) * b + v * ((1 - w) * c + w * d));
    const double distance = boundary.inside(x) ? boundary.closest(x).distance : 0;
    if (distance > clearance && !is_blocked(k, x, x) && piece_containing(k, x, piece) == wanted) {
      clearance = distance;
      best = x;
    }
  }
  return best;
}

// The rounds of a repair. Each inserts nodes and joins, updates the graph, and finds the remaining
// mismatch.
class ConnectivityRepair {
 public:
  ConnectivityRepair(NewNodes& inserted, ConnectivityMismatch& mismatch, const GraphUpdater& update,
                     const FreshCut& cut)
      : inserted_(inserted), body_(inserted.body()), mismatch_(mismatch), update_(update), cut_(cut) {}
  void run() {
    // Rounds have spacing 0.7 · 0.8^round: the first is denser than the sampling, which missed the
    // passage, and the last (round 11) has 6 % of it. More rounds: finer nodes in passages.
    double scale = 0.7;  // of the spacing
    for (int round = 0; round < 12 && !mismatch_.none(); ++round, scale *= 0.8) {
      const NodeId first_new(body_.nodes.size());
      fill_empty_pieces();
      joins_.clear();
      connect_components(round, scale * body_.cache->grid.cell());
      if (first_new.index() < body_.nodes.size() || !joins_.empty())
        update_(first_new, joins_);
      else if (round >= 1)
        return;
      find_remaining(first_new);
    }
  }

 private:
  void fill_empty_pieces() {
    for (const auto v : mismatch_.empty_pieces) {
      const auto piece = body_.cache->piece[v.index()];
      if (const NodeId i = insert_node_into_piece(inserted_, v, mismatch_.parts[piece]); i.valid()) {
        mismatch_.representative[piece] = i;
        body_.cache->pieces_without_node.erase(piece);
      } else {
        mismatch_.representative.erase(piece);
        body_.cache->pieces_without_node.insert(piece);
      }
    }
  }
  // By an edge where two components see each other. Else by nodes: at the walls of the passage in
  // the first round, if they suffice, or along a taut path. Walls get nodes, too, where the passage
  // may be anywhere, and where there is no path.
  void connect_components(int round, double spacing) {
    const NodeId first_new(body_.nodes.size());
    if (round == 1) tried_.clear();  // the first round searched farther from the surface than the others
    Regions components = components_of(body_);
    NearestInPiece nearest(body_);
    std::vector<FaceId> walls;
    std::set<std::uint32_t> handled;  // components, by their lowest nodes
    for (const auto& [a, b] : mismatch_.disconnected) {
      components.seed(a.value);
      components.seed(b.value);
      if (components.joined(a.value, b.value)) continue;
      const NodeId i = components.whole(a.value) ? a : b;  // in the smaller component
      if (!handled.insert(components.lowest(i.value)).second) continue;
      auto component = components.inside(i.value);
      std::sort(component.begin(), component.end());
      if (join_by_visible_edge(body_, nearest, component, joins_)) continue;
      const auto ends = ends_at_passage(nearest, component);
      const auto is_joined_by_path = [&] { return join_by_taut_path(nearest, i, component, ends, spacing); };
      if (round > 0)
        is_joined_by_path();
      else if (ends.empty() || !(join_by_walls(first_new, component, ends, spacing) || is_joined_by_path()))
        add_walls(ends.empty() ? component : ends, walls);
    }
    insert_nodes_at(std::move(walls), first_new, spacing);
  }
  // Adds the faces within 1.5 spacings of nodes: walls of a passage near them.
  void add_walls(std::span<const std::uint32_t> nodes, std::vector<FaceId>& walls) const {
    for (const auto n : nodes) {
      const Vec3& x = body_.nodes.position[n];
      body_.surface.faces_near(Box3{x, x}.grown(1.5 * body_.nodes.spacing[n]), walls);
    }
  }
  // Inserts nodes at walls. Few in a round, so that a passage that stays closed costs little.
  void insert_nodes_at(std::vector<FaceId> walls, NodeId first_of_round, double spacing) {
    constexpr std::size_t most = 100;
    const std::size_t inserted = body_.nodes.size() - first_of_round.index();
    if (inserted >= most) return;
    std::sort(walls.begin(), walls.end());
    walls.erase(std::unique(walls.begin(), walls.end()), walls.end());
    insert_nodes_near(inserted_, walls,
                      {.spacing = spacing, .seed = 0x6b657266u, .limit = most - inserted, .fresh = cut_.faces});
  }
  // Inserts nodes at the walls near the ends of cut edges. False, and no nodes, if they would not
  // connect the component to another one: they would make steps slower and serve nothing.
  bool join_by_walls(NodeId first_of_round, const std::vector<std::uint32_t>& component,
                     std::span<const std::uint32_t> ends, double spacing) {
    const NodeId first_new(body_.nodes.size());
    std::vector<FaceId> walls;
    add_walls(ends, walls);
    insert_nodes_at(std::move(walls), first_of_round, spacing);
    if (is_connected_by(first_new, component)) return true;
    inserted_.remove_from(first_new);
    return false;
  }
  // Whether nodes from `first_new` on connect a component to another one by lines of sight.
  bool is_connected_by(NodeId first_new, const std::vector<std::uint32_t>& component) const {
    constexpr std::size_t candidates = 24;                     // neighbours of a node; as many as at a crack
    constexpr std::uint32_t inside = 0, outside = 1, own = 2;  // the component, other old nodes, each new one
    const auto set_of = [&](std::uint32_t i) {
      if (i >= first_new.value) return own + i - first_new.value;
      return std::binary_search(component.begin(), component.end(), i) ? inside : outside;
    };
    const double reach = longest_reach(body_);
    UnionFind sets(own + body_.nodes.size() - first_new.index());
    const auto& position = body_.nodes.position;
    for (std::uint32_t i = first_new.value; i < body_.nodes.size(); ++i)
      for (const auto j : body_.cache->grid.nearest(position, position[i], candidates, i, [](auto) { return true; })) {
        if (sets.find(set_of(i)) == sets.find(set_of(j)) || (position[i] - position[j]).norm() > reach ||
            is_blocked(body_.surface, position[j], position[i]))
          continue;
        sets.unite(set_of(i), set_of(j));
        if (sets.find(inside) == sets.find(outside)) return true;
      }
    return false;
  }
  // The nodes of a component that lost an edge to the rest of its piece in this step, those of
  // short edges first: the rest of the passage is near them. None where no edge was cut, as in
  // a build.
  std::vector<std::uint32_t> ends_at_passage(NearestInPiece& nearest,
                                             const std::vector<std::uint32_t>& component) const {
    const auto is_inside = [&](NodeId n) { return std::binary_search(component.begin(), component.end(), n.value); };
    std::vector<std::pair<double, std::uint32_t>> crossing;  // squared length, end inside
    for (const auto& [a, b] : cut_.edges)
      if (is_inside(a) != is_inside(b) && nearest.piece_of_node(a.value) == nearest.piece_of_node(b.value))
        crossing.emplace_back((body_.nodes.position[a.index()] - body_.nodes.position[b.index()]).squaredNorm(),
                              (is_inside(a) ? a : b).value);
    std::sort(crossing.begin(), crossing.end());
    std::vector<std::uint32_t> ends;
    for (const auto& [length, end] : crossing)
      if (std::find(ends.begin(), ends.end(), end) == ends.end()) ends.push_back(end);
    return ends;
  }
  // Each pair of nodes is tried once after the first round, though later ones search nearer to the
  // surface. A failed search takes longest, and few succeed at another try. `ends`: of
  // ends_at_passage().
  bool join_by_taut_path(NearestInPiece& nearest, NodeId i, const std::vector<std::uint32_t>& component,
                         std::span<const std::uint32_t> ends, double spacing) {
    std::vector<std::uint32_t> starts(ends.begin(),
                                      ends.begin() + std::ptrdiff_t(std::min<std::size_t>(ends.size(), 3)));
    starts.insert(starts.end(), {i.value, component.front(), component.back()});
    for (const auto from : starts) {
      const auto near = nearest.outside(NodeId(from), 4, component);
      const auto joins = [&](auto to) {
        return tried_.insert({NodeId(from), NodeId(to)}).second &&
               insert_nodes_along(inserted_, NodeId(from), NodeId(to), spacing, joins_);
      };
      if (std::any_of(near.begin(), near.end(), joins)) return true;
    }
    return false;
  }
  void find_remaining(NodeId first_new) {
    ConnectivityMismatch left;
    left.representative = std::move(mismatch_.representative);
    left.parts = std::move(mismatch_.parts);
    Regions components = components_of(body_);
    for (const auto& [a, b] : mismatch_.disconnected) {
      components.seed(a.value);
      components.seed(b.value);
      if (!components.joined(a.value, b.value)) left.disconnected.push_back({a, b});
    }
    pair_new_nodes(body_, components, first_new, left);
    mismatch_ = std::move(left);
  }

  NewNodes& inserted_;
  Body& body_;
  ConnectivityMismatch& mismatch_;
  const GraphUpdater& update_;
  const FreshCut cut_;
  std::vector<NodePair> joins_;                // of this round
  std::set<std::pair<NodeId, NodeId>> tried_;  // ends of taut paths
};

}  // namespace

std::optional<Vec3> point_in_piece(const Complex& k, SurfaceVertexId v, double reach,
                                   const std::function<std::int32_t(Side)>& piece) {
  const auto wanted = piece(k.corner_of(v).first);
  const auto sides = sides_of_shell(k, v);
  for (std::size_t i = 0; i < std::min<std::size_t>(sides.size(), 16); ++i) {
    const Side s = sides[i].second;
    const auto t = k.corners(s.face);
    const Vec3 middle = (t[0] + t[1] + t[2]) / 3;
    const Vec3 inwards = (s.which ? 1.0 : -1.0) * (t[1] - t[0]).cross(t[2] - t[0]).normalized();
    // Steps of factor 0.6 down to 1e-16 of the extent, the resolution of doubles (2⁻⁵³).
    for (double step = reach; step > 1e-16 * k.extent().diagonal(); step *= 0.6) {
      const Vec3 x = middle + 0.5 * step * inwards;
      if (is_in_front(k, s, middle, middle + step * inwards) && is_in_front(k, s, middle, x) && !is_blocked(k, x, x) &&
          piece_containing(k, x, piece) == wanted)
        return x;
    }
  }
  return point_between_corners(k, sides, piece, wanted);
}

void repair_connectivity(NewNodes& inserted, ConnectivityMismatch& mismatch, const GraphUpdater& update,
                         const FreshCut& cut) {
  ConnectivityRepair(inserted, mismatch, update, cut).run();
}

}  // namespace geo
