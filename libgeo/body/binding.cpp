// § 6.5: masters by visibility edges, slaves breadth-first along the derived surface, which no
// crack connects.
#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "body/binding.h"
#include "body/incremental_cache.h"
#include "body/locate.h"
#include "geometry/predicates.h"
#include "graph/graph_storage.h"
#include "kerf/parallel.h"
#include "kerf/pieces.h"
#include "surface/radial_edge.h"

namespace geo {
namespace {

// True when no face but those at `v` (the end of the segment) touches the segment from p to v.
bool sees_vertex(const Complex& k, const Vec3& p, VertexId v) {
  const Vec3& q = k.point(v);
  Box3 box{p, p};
  box.add(q);
  std::vector<FaceId> faces;
  k.faces_near(box, faces);
  for (const FaceId f : faces) {
    const auto& c = k.face(f).v;
    const auto t = k.corners(f);
    const auto at = std::find(c.begin(), c.end(), v);
    if (at == c.end()) {
      if (segment_meets_triangle(p, q, t[0], t[1], t[2])) return false;
      continue;
    }
    // A face at v: only lying along it would hide v.
    if (orient3d(t[0], t[1], t[2], p) != 0) continue;
    const auto i = static_cast<std::size_t>(at - c.begin());
    if (segment_meets_triangle(p, p, t[0], t[1], t[2]) ||
        segment_meets_triangle(p, q, t[(i + 1) % 3], t[(i + 1) % 3], t[(i + 2) % 3]))
      return false;
  }
  return true;
}

// The surface vertex at v on the side that p sees: a side faces p, and p sees a point of its face
// near v.
SurfaceVertexId visible_fan(const Complex& k, const Vec3& p, VertexId v) {
  SurfaceVertexId only;
  bool several = false;
  for (const FaceId f : k.faces_at(v))
    for (int which = 0; which < 2; ++which) {
      if (!k.has({f, which})) continue;
      const auto id = k.surface_vertex({f, which}, corner_at(k.face(f), v));
      several |= only.valid() && only != id;
      only = id;
    }
  if (!several) return only;
  for (const FaceId f : k.faces_at(v)) {
    const auto t = k.corners(f);
    const int above = orient3d(t[0], t[1], t[2], p);
    const Side s{f, above > 0 ? 1 : 0};
    if (above == 0 || !k.has(s)) continue;
    // A point of the face near its corner at v: at most a twentieth of the way to the face's middle
    // and of the distance of p, so that few faces can stand between.
    const int corner = corner_at(k.face(f), v);
    const Vec3 inwards = (t[0] + t[1] + t[2]) / 3 - k.point(v);
    const Vec3 q = k.point(v) + std::min(0.05, 0.05 * (p - k.point(v)).norm() / inwards.norm()) * inwards;
    if (!is_blocked(k, p, q, f)) return k.surface_vertex(s, corner);
  }
  return {};
}

// The corner of a crack's face where both of its sides have this surface vertex; −1: there is none.
int joined_corner(const Complex& k, FaceId f, SurfaceVertexId v) {
  if (k.face(f).crack == 0) return -1;
  const int c = corner_at(k.face(f), k.site(v));
  return k.surface_vertex({f, 0}, c) == v && k.surface_vertex({f, 1}, c) == v ? c : -1;
}

}  // namespace

SurfaceVertexId closest_vertex(const Complex& k, const Vec3& p, double reach) {
  // Nearest vertices tested. A node that sees none of them has no closest vertex: part of the rule,
  // so a change of this number changes bindings.
  constexpr std::size_t candidates = 12;
  std::vector<FaceId> faces;
  std::vector<std::pair<double, VertexId>> near;
  std::size_t tested = 0;
  // As a rule the nearest vertex is visible, so a small ball with few faces suffices.
  for (const double share : {0.125, 0.25, 0.5, 1.0}) {
    const double r = share * reach;
    faces.clear();
    near.clear();
    k.faces_near(Box3{p, p}.grown(r * (1 + 1e-9)), faces);  // a margin for rounding
    for (const FaceId f : faces)
      for (const VertexId v : k.face(f).v)
        if (const double d = (k.point(v) - p).norm(); d <= r) near.push_back({d, v});
    std::sort(near.begin(), near.end());
    near.erase(std::unique(near.begin(), near.end()), near.end());
    for (; tested < std::min(near.size(), candidates); ++tested)
      if (sees_vertex(k, p, near[tested].second))
        if (const auto fan = visible_fan(k, p, near[tested].second); fan.valid()) return fan;
    if (tested == candidates) break;
  }
  return {};
}

double longest_reach(const Body& body) { return GraphStorage::of(body.graph).plain_unit() * 0x1p26; }

bool is_on_border(const Complex& k, SurfaceVertexId v) {
  const auto& faces = k.faces_at(k.site(v));
  return std::any_of(faces.begin(), faces.end(), [&](FaceId f) { return joined_corner(k, f, v) >= 0; });
}

NodeId carrying_node(const Body& body, SurfaceVertexId v) {
  const SurfaceVertexId master = body.binding.master[v.index()];
  return master.valid() ? body.binding.master_node[master.index()] : NodeId();
}

std::uint32_t step_from(const Complex& k, SurfaceVertexId v) {
  constexpr std::uint32_t past_border = 1u << 20;  // deeper than trees are, and a sum of thousands fits
  return is_on_border(k, v) ? past_border : 1;
}

NodeId master_node_of(const Body& body, const Binding& binding, SurfaceVertexId v) {
  const Vec3& q = body.surface.point(body.surface.site(v));
  std::vector<std::uint32_t> near;
  body.cache->grid.within(body.nodes.position, q, longest_reach(body) * (1 + 1e-9), near);  // a margin for rounding
  NodeId best;
  double least = 0;
  for (const auto i : near) {
    if (binding.closest[i] != v) continue;
    const double d = (body.nodes.position[i] - q).norm();
    if (!best.valid() || d < least) {
      least = d;
      best = NodeId(i);
    }
  }
  return best;
}

NodeId carrier_of_unseen_shell(const Body& body, SurfaceVertexId v, const std::function<bool(NodeId)>& accept) {
  const auto near = body.cache->grid.nearest(body.nodes.position, body.surface.point(body.surface.site(v)), 1, ~0u,
                                             [&](std::uint32_t i) { return accept(NodeId(i)); });
  return near.empty() ? NodeId() : NodeId(near[0]);
}

Binding build_binding(const Body& body) {
  const Complex& k = body.surface;
  Binding b;
  b.closest.resize(body.nodes.size());
  parallel_for(body.nodes.size(), 64, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      b.closest[i] = closest_vertex(k, body.nodes.position[i], body.nodes.radius[i]);
  });
  const std::size_t n = k.surface_vertex_count();
  b.master_node.assign(n, NodeId());
  b.master.assign(n, SurfaceVertexId());
  b.parent.assign(n, SurfaceVertexId());
  const auto nearer = [&](NodeId i, NodeId j, SurfaceVertexId v) {
    const Vec3& q = k.point(k.site(v));
    const double di = (body.nodes.position[i.index()] - q).norm(), dj = (body.nodes.position[j.index()] - q).norm();
    return di != dj ? di < dj : i < j;
  };
  for (std::uint32_t i = 0; i < body.nodes.size(); ++i)
    if (const auto v = b.closest[i]; v.valid())
      if (auto& node = b.master_node[v.index()]; !node.valid() || nearer(NodeId(i), node, v)) node = NodeId(i);
  // Parents and vertices that they may get, by depth. In a level the lowest parent comes first: the
  // tree does not depend on the order in which the level was found.
  std::map<std::uint32_t, std::vector<std::pair<SurfaceVertexId, SurfaceVertexId>>> levels;
  const auto spread = [&] {
    std::vector<SurfaceVertexId> around;
    while (!levels.empty()) {
      const std::uint32_t depth = levels.begin()->first;
      auto level = std::move(levels.begin()->second);
      levels.erase(levels.begin());
      std::sort(level.begin(), level.end());
      for (const auto& [parent, v] : level) {
        if (b.master[v.index()].valid()) continue;
        b.master[v.index()] = parent == v ? v : b.master[parent.index()];
        b.parent[v.index()] = parent;
        around.clear();
        k.surface_neighbors(v, around);
        auto& below = levels[depth + step_from(k, v)];
        for (const auto w : around)
          if (!b.master[w.index()].valid()) below.push_back({v, w});
      }
    }
  };
  for (std::uint32_t v = 0; v < n; ++v)
    if (b.master_node[v].valid()) levels[0].push_back({SurfaceVertexId(v), SurfaceVertexId(v)});
  spread();
  // An unseen shell (a small cavity, a piece without a node) takes the nearest node of its piece,
  // else the nearest of all.
  Pieces pieces;
  const auto piece_of_side = [&](Side s) {
    return pieces.of_side[s.face.index() * 2 + static_cast<std::size_t>(s.which)];
  };
  constexpr std::int32_t unknown = -2;
  std::vector<std::int32_t> piece_of_node;
  for (std::uint32_t v = 0; v < n; ++v) {
    const SurfaceVertexId id(v);
    if (!k.alive(id) || b.master[v].valid()) continue;
    if (pieces.of_side.empty()) {
      pieces = find_pieces(k);
      piece_of_node.assign(body.nodes.size(), unknown);
    }
    const auto piece = piece_of_side(k.corner_of(id).first);
    NodeId node = carrier_of_unseen_shell(body, id, [&](NodeId i) {
      auto& known = piece_of_node[i.index()];
      if (known == unknown) known = piece_containing(k, body.nodes.position[i.index()], piece_of_side);
      return known == piece;
    });
    if (!node.valid()) node = carrier_of_unseen_shell(body, id, [](NodeId) { return true; });
    b.master_node[v] = node;
    levels[0].push_back({id, id});
    spread();
  }
  return b;
}

std::array<NodeId, 2> master_nodes(const Body& body, SurfaceVertexId v) {
  const Complex& k = body.surface;
  const NodeId own = carrying_node(body, v);
  if (!own.valid()) return {};
  const Vec3& x = k.point(k.site(v));
  // The nearest node of the vertices beside v on each side of the crack, where these are two.
  std::array<NodeId, 2> of_side;
  std::array<double, 2> least{};
  for (const FaceId f : k.faces_at(k.site(v))) {
    const int c = joined_corner(k, f, v);
    if (c < 0) continue;
    for (const int other : {(c + 1) % 3, (c + 2) % 3}) {
      const std::array<SurfaceVertexId, 2> w{k.surface_vertex({f, 0}, other), k.surface_vertex({f, 1}, other)};
      if (w[0] == w[1]) continue;
      for (std::size_t s = 0; s < 2; ++s) {
        const NodeId node = carrying_node(body, w[s]);
        if (!node.valid()) continue;
        const double d = (body.nodes.position[node.index()] - x).norm();
        if (of_side[s].valid() && (d > least[s] || (d == least[s] && of_side[s] < node))) continue;
        of_side[s] = node;
        least[s] = d;
      }
    }
  }
  if (of_side[0].valid() && of_side[1].valid() && of_side[0] != of_side[1]) return of_side;
  return {own, NodeId()};
}

void carrier_nodes(const Body& body, SurfaceVertexId v, std::vector<std::pair<NodeId, double>>& out) {
  carriers_beside(body, v, master_nodes(body, v), out);
}

void carriers_beside(const Body& body, SurfaceVertexId v, const std::array<NodeId, 2>& masters,
                     std::vector<std::pair<NodeId, double>>& out) {
  out.clear();
  const Vec3& x = body.surface.point(body.surface.site(v));
  const auto add = [&](NodeId j) {
    const double d = (body.nodes.position[j.index()] - x).norm();
    if (d < body.nodes.radius[j.index()]) out.push_back({j, d});
  };
  for (const NodeId m : masters) {
    if (!m.valid()) continue;
    add(m);
    for (const auto& n : body.graph.neighbors(body.nodes, m)) add(n.to);
  }
  if (masters[1].valid()) {
    std::sort(out.begin(), out.end());
    out.erase(std::unique(out.begin(), out.end()), out.end());
  }
  if (out.empty() && masters[0].valid()) out.push_back({masters[0], 0.0});
}

}  // namespace geo
