// Violated invariants of a body after a step: everything is recomputed from scratch, by brute
// force.
#pragma once

#include <algorithm>
#include <map>
#include <numeric>
#include <set>
#include <string>

#include "base/random.h"
#include "body/locate.h"
#include "body/node_insertion.h"
#include "body/piece_labels.h"
#include "geometry/bvh.h"
#include "graph/build_graph.h"
#include "graph/graph_storage.h"
#include "kerf/check.h"
#include "kerf/pieces.h"

namespace body_faults {

using namespace geo;

inline double total(const std::vector<double>& v) { return std::accumulate(v.begin(), v.end(), 0.0); }

/// The node that carries a surface vertex; invalid: none.
inline NodeId carrier(const Body& body, std::size_t v) {
  const auto& b = body.binding;
  return v < b.master.size() && b.master[v].valid() ? b.master_node[b.master[v].index()] : NodeId();
}

/// Compares components of G with pieces of material: one for each, but for crumbs too thin for a
/// node in doubles. A point is in a piece when a ray from it crosses the piece's boundary an odd
/// number of times. No edge crosses a face.
inline std::string fault_of_components(const Body& body, const Pieces& pieces,
                                       const std::vector<std::uint32_t>& component, std::size_t components) {
  const Complex& k = body.surface;
  std::vector<std::vector<std::array<Vec3, 3>>> around(pieces.count);
  std::vector<std::vector<Vec3>> corners(pieces.count);
  for (std::uint32_t f = 0; f < k.face_count(); ++f)
    for (std::size_t which = 0; which < 2; ++which)
      if (const auto piece = pieces.of_side[f * 2 + which]; piece >= 0) {
        const auto t = k.corners(FaceId(f));
        if (piece != pieces.of_side[f * 2 + 1 - which]) around[static_cast<std::size_t>(piece)].push_back(t);
        corners[static_cast<std::size_t>(piece)].insert(corners[static_cast<std::size_t>(piece)].end(), t.begin(),
                                                        t.end());
      }
  std::vector<TriangleBvh> boundary(around.begin(), around.end());
  std::vector<std::uint32_t> component_of(pieces.count, ~0u);
  std::uint32_t next = 0;  // components are numbered by their lowest nodes
  for (std::uint32_t i = 0; i < component.size(); ++i) {
    if (component[i] != next) continue;
    std::size_t count = 0;
    for (std::size_t p = 0; p < pieces.count; ++p) {
      if (!boundary[p].inside(body.nodes.position[i])) continue;
      if (++count > 1) return "node " + std::to_string(i) + " is in several pieces";
      if (component_of[p] != ~0u) return "node " + std::to_string(i) + " is not connected to others of its piece";
      component_of[p] = next;
    }
    if (count == 0) return "node " + std::to_string(i) + " is in no piece";
    ++next;
  }
  if (next != components) return "components are not numbered by their lowest nodes";
  Random random(pieces.count);
  for (std::size_t p = 0; p < pieces.count; ++p) {
    if (component_of[p] != ~0u) continue;
    for (int attempt = 0; attempt < 300; ++attempt) {
      const auto corner = [&]() -> const Vec3& {
        return corners[p][random.below(static_cast<std::uint32_t>(corners[p].size()))];
      };
      const double u = random.uniform(), v = random.uniform(), w = random.uniform();
      const Vec3 q = (1 - u) * corner() + u * ((1 - v) * corner() + v * ((1 - w) * corner() + w * corner()));
      // A node needs a clearance of a few ulps. In a crumb whose sheets rounding has exchanged,
      // the winding number of a point is negative.
      if (boundary[p].inside(q) && boundary[p].closest(q).distance > 0x1p-48 * k.extent().diagonal() &&
          piece_containing(k, q, [&](Side s) {
            return pieces.of_side[s.face.index() * 2 + static_cast<std::size_t>(s.which)];
          }) == static_cast<std::int32_t>(p))
        return "piece " + std::to_string(p) + " has room, but no node";
    }
  }
  return {};
}

/// Nodes, graph, rows and binding alone; empty when all is well.
inline std::string fault_of(const Body& body, double volume) {
  const auto& x = body.nodes.position;
  const Complex& k = body.surface;
  const auto name = [](std::uint32_t i) { return std::to_string(i); };
  std::vector<std::array<Vec3, 3>> soup, skin;
  for (std::uint32_t f = 0; f < k.face_count(); ++f)
    if (k.alive(FaceId(f))) {
      soup.push_back(k.corners(FaceId(f)));
      if (k.face(FaceId(f)).crack == 0) skin.push_back(soup.back());
    }
  const TriangleBvh faces(soup), outside(skin);
  for (std::uint32_t i = 0; i < x.size(); ++i) {
    if (!outside.inside(x[i])) return "node " + name(i) + " is outside";
    if (faces.blocks(x[i], x[i])) return "node " + name(i) + " is on a face";
    if (!(body.nodes.volume[i] > 0)) return "node " + name(i) + " has no volume";
    for (const NodeId j : body.graph.edges(NodeId(i)))
      if (j.value > i && faces.blocks(x[i], x[j.index()]))
        return "edge " + name(i) + "-" + name(j.value) + " crosses a face";
  }
  if (std::abs(total(body.nodes.volume) - volume) > 1e-12 * volume)
    return "the volumes of the nodes do not sum to what they did";

  for (std::uint32_t g = 0; g < GraphStorage::of(body.graph).guides().size(); ++g) {
    const auto id = VisibilityGraph::first_guide + g;
    for (const auto to : GraphStorage::of(body.graph).entries(id).to)
      if (to < id && faces.blocks(GraphStorage::of(body.graph).position(body.nodes, to),
                                  GraphStorage::of(body.graph).guides().position(g)))
        return "an edge of guide " + name(g) + " crosses a face";
  }

  if (const auto report = check_complex(k, SelfIntersections::ignore); !report.good()) return report.first_problem;
  const Pieces pieces = find_pieces(k);
  std::vector<std::uint32_t> component;
  const auto components = body.graph.components(component);
  if (const auto fault = fault_of_components(body, pieces, component, components); !fault.empty()) return fault;

  VisibilityGraph scratch = body.graph;
  build_neighborhoods(body.nodes, scratch, faces);
  for (std::uint32_t i = 0; i < x.size(); ++i) {
    const AdjacencyRow a = scratch.row(NodeId(i)), b = body.graph.row(NodeId(i));
    if (a == b) continue;
    const auto [at, other] = std::mismatch(a.to.begin(), a.to.end(), b.to.begin(), b.to.end());
    const auto tell = [](const AdjacencyRow& row, auto n) { return n == row.to.end() ? "none" : std::to_string(*n); };
    return "the row of node " + name(i) + " is not that of scratch: " + tell(b, other) + " for " + tell(a, at) +
           " is the first other node";
  }
  const Binding binding = build_binding(body);
  for (std::uint32_t v = 0; v < k.surface_vertex_count(); ++v) {
    if (k.alive(SurfaceVertexId(v)) && !binding.master[v].valid())
      return "surface vertex " + name(v) + " has no master";
    if (binding.master[v] != body.binding.master[v] || binding.parent[v] != body.binding.parent[v] ||
        binding.master_node[v] != body.binding.master_node[v])
      return "surface vertex " + name(v) + " is not bound as from scratch";
  }
  if (binding.closest != body.binding.closest) return "a node's closest vertex is not that of scratch";
  Body marked;
  marked.nodes = body.nodes;
  marked.graph = body.graph;
  marked.debris.resize(x.size());
  std::vector<NodeId> all;
  for (std::uint32_t i = 0; i < x.size(); ++i) all.push_back(NodeId(i));
  mark_debris(marked, all);
  if (marked.debris != body.debris) return "debris is not that of scratch";

  // The cache for the next step.
  Body again;
  again.surface = k;
  again.binding = body.binding;
  prepare_cache(again);
  const IncrementalCache &kept = *body.cache, &fresh = *again.cache;
  if (kept.depth.empty()) return {};  // nothing was split yet
  if (kept.depth != fresh.depth) return "depths are not those of scratch";
  if (kept.unseen_masters != fresh.unseen_masters) return "strays are not those of scratch";
  if (fresh.inner_shells && !kept.inner_shells)
    return "an inner shell is not known: " + std::to_string(kept.piece_count) + " pieces known, " +
           std::to_string(fresh.piece_count) + " from scratch";
  std::map<std::int32_t, std::int32_t> number, back;
  for (std::size_t v = 0; v < kept.piece.size(); ++v)
    if (number.try_emplace(kept.piece[v], fresh.piece[v]).first->second != fresh.piece[v] ||
        back.try_emplace(fresh.piece[v], kept.piece[v]).first->second != kept.piece[v])
      return "surface vertex " + name(static_cast<std::uint32_t>(v)) + " is in piece " + std::to_string(kept.piece[v]) +
             " of " + std::to_string(kept.piece_count) + ", from scratch in " + std::to_string(fresh.piece[v]) +
             " of " + std::to_string(fresh.piece_count);
  return {};
}

/// New and moved nodes have edges to the nearest nodes that they see, guides to all that they see.
/// `mended`: the number of new nodes that were added last, to connect components; nodes added later
/// need no edge to a node.
inline std::string fault_of_new_edges(const Body& before, const Body& body, const BodyDelta& delta, std::size_t mended,
                                      const TriangleBvh& faces) {
  const auto& x = body.nodes.position;
  const auto n = static_cast<std::uint32_t>(x.size()), first = delta.first_new_node.value,
             first_mended = n - static_cast<std::uint32_t>(mended);
  std::vector<std::pair<double, std::uint32_t>> near;
  const auto sees = [&](std::uint32_t i, std::uint32_t j) {
    const auto [low, high] = std::minmax(i, j);
    return !faces.blocks(GraphStorage::of(body.graph).position(body.nodes, low),
                         GraphStorage::of(body.graph).position(body.nodes, high));
  };
  const auto is_moved = [&](std::uint32_t i) {
    return std::binary_search(delta.moved_nodes.begin(), delta.moved_nodes.end(), NodeId(i));
  };
  for (std::uint32_t i = 0; i < n; ++i) {
    if (i < first && !is_moved(i)) continue;
    near.clear();
    for (std::uint32_t j = 0; j < n; ++j)
      if (j != i) near.push_back({squared_distance(x[i], x[j]), j});
    const auto count = std::min(near.size(), static_cast<std::size_t>(3 * body.k));
    std::partial_sort(near.begin(), near.begin() + static_cast<std::ptrdiff_t>(count), near.end());
    int seen = 0;
    for (std::size_t c = 0; c < count && seen < body.k; ++c) {
      const auto j = near[c].second;
      if (!sees(i, j)) continue;
      ++seen;
      if ((j < i || j < first_mended) && !body.graph.has_edge(NodeId(i), NodeId(j)))
        return "node " + std::to_string(i) + " has no edge to " + std::to_string(j) +
               ", one of the nearest that it sees";
    }
  }
  const GuideSet &guides = GraphStorage::of(body.graph).guides(), &old = GraphStorage::of(before.graph).guides();
  for (std::uint32_t g = 0; g < guides.size(); ++g) {
    const auto id = VisibilityGraph::first_guide + g;
    const auto wrong = [&](std::uint32_t other, double reach, bool fresh) {
      const bool edge = body.graph.has_edge(NodeId(id), NodeId(other)),
                 had = g < old.size() && before.graph.has_edge(NodeId(id), NodeId(other));
      if (g < old.size() && !fresh && !had) return edge;
      return edge != (reach > 0 &&
                      squared_distance(GraphStorage::of(body.graph).position(body.nodes, other), guides.position(g)) <=
                          reach * reach &&
                      sees(id, other));
    };
    for (std::uint32_t i = 0; i < n; ++i)
      if (wrong(i, guides.radius(g), i >= first || is_moved(i)))
        return "the edge of guide " + std::to_string(g) + " to node " + std::to_string(i) + " is not as it should be";
    for (std::uint32_t h = 0; h < g; ++h)
      if (wrong(VisibilityGraph::first_guide + h,
                guides.retired(g) || guides.retired(h) ? 0.0 : std::max(guides.radius(g), guides.radius(h)), false))
        return "the edge of guides " + std::to_string(g) + " and " + std::to_string(h) + " is not as it should be";
  }
  return {};
}

/// The invariants of a body, and those of the step from `before`; see fault_of_new_edges().
inline std::string fault_of(const Body& before, const Body& body, const BodyDelta& delta, std::size_t mended,
                            double volume) {
  if (const auto fault = fault_of(body, volume); !fault.empty()) return fault;
  const auto& x = body.nodes.position;
  std::vector<std::array<Vec3, 3>> soup;
  for (std::uint32_t f = 0; f < body.surface.face_count(); ++f)
    if (body.surface.alive(FaceId(f))) soup.push_back(body.surface.corners(FaceId(f)));
  const TriangleBvh faces(soup);
  if (const auto fault = fault_of_new_edges(before, body, delta, mended, faces); !fault.empty()) return fault;
  const auto stood = [&](NodeId i) {
    return !std::binary_search(delta.moved_nodes.begin(), delta.moved_nodes.end(), i);
  };
  for (std::uint32_t i = 0; i < before.nodes.size(); ++i) {
    if (stood(NodeId(i)) != (x[i] == before.nodes.position[i])) return "node " + std::to_string(i) + " moved unsaid";
    for (const NodeId j : before.graph.edges(NodeId(i)))
      if (j.value > i && stood(NodeId(i)) && stood(j) && !body.graph.has_edge(NodeId(i), j) &&
          !faces.blocks(x[i], x[j.index()]))
        return "edge " + std::to_string(i) + "-" + std::to_string(j.value) + " was removed for nothing";
    const bool updated = std::binary_search(delta.updated_nodes.begin(), delta.updated_nodes.end(), NodeId(i));
    if (!updated && !(before.graph.row(NodeId(i)) == body.graph.row(NodeId(i))))
      return "row " + std::to_string(i) + " changed unsaid";
  }
  std::vector<SurfaceVertexId> rebound;
  for (std::uint32_t v = 0; v < body.surface.surface_vertex_count(); ++v)
    if (body.surface.alive(SurfaceVertexId(v)) && carrier(before, v) != carrier(body, v))
      rebound.push_back(SurfaceVertexId(v));
  if (rebound != delta.rebound_vertices) return "other vertices were rebound than it says";
  std::vector<std::uint32_t> component;
  const auto count = body.graph.components(component);
  std::vector<std::uint32_t> component_before;
  if (const auto more = count - before.graph.components(component_before); delta.detached.size() != more)
    return std::to_string(delta.detached.size()) + " parts came off, but there are " + std::to_string(more) +
           " components more";
  std::vector<std::size_t> size(count, 0);
  for (const auto c : component) ++size[c];
  for (const auto& part : delta.detached)
    for (const NodeId i : part)
      if (component[i.index()] != component[part[0].index()] || size[component[i.index()]] != part.size())
        return "a part is not a component";
  return {};
}

}  // namespace body_faults
