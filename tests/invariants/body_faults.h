// What does not hold of a body after a step: everything is found again from scratch, as slowly as it takes.
#pragma once

#include <algorithm>
#include <map>
#include <numeric>
#include <set>
#include <string>

#include "body/locate.h"
#include "body/upkeep.h"
#include "surface/pieces.h"

namespace body_faults {

using namespace geo;

inline double total(const std::vector<double>& v) { return std::accumulate(v.begin(), v.end(), 0.0); }

/// The node that carries a surface vertex; invalid: none.
inline NodeId carrier(const Body& body, std::size_t v) {
  const auto& b = body.binding;
  return v < b.master.size() && b.master[v].valid() ? b.master_node[b.master[v].index()] : NodeId();
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
      if (j.value > i && faces.blocks(x[i], x[j.index()])) return "edge " + name(i) + "-" + name(j.value) + " crosses a face";
  }
  if (std::abs(total(body.nodes.volume) - volume) > 1e-12 * volume) return "the volumes of the nodes do not sum to what they did";

  const Pieces pieces = find_pieces(k);
  std::vector<std::uint32_t> component;
  const auto components = body.graph.components(component);
  // Dust, some last places thick, has no room for a node in doubles; rounding may have turned it inside out.
  const auto dust = [&](std::int32_t piece) { return std::abs(pieces.volume[static_cast<std::size_t>(piece)]) < 1e-11 * volume; };
  std::vector<std::set<std::int32_t>> met(components);
  std::set<std::int32_t> all;
  for (std::uint32_t i = 0; i < x.size(); ++i) {
    const Side s = side_seen_from(k, x[i], body.nodes.spacing[i]);
    const auto piece = k.has(s) ? pieces.of_side[s.face.index() * 2 + static_cast<std::size_t>(s.which)] : -1;
    if (piece >= 0 && dust(piece)) continue;
    met[component[i]].insert(piece), all.insert(piece);
    if (met[component[i]].size() > 1) return "node " + name(i) + " is connected to another piece";
  }
  if (const auto found = static_cast<std::size_t>(std::ranges::count_if(met, [](const auto& of) { return !of.empty(); })); found != all.size())
    return std::to_string(found) + " components in " + std::to_string(all.size()) + " pieces";
  for (std::int32_t p = 0; p < static_cast<std::int32_t>(pieces.count); ++p)
    if (!all.count(p) && !dust(p)) return "piece " + std::to_string(p) + " has no node";

  VisibilityGraph scratch = body.graph;
  build_neighborhoods(body.nodes, scratch, faces);
  for (std::uint32_t i = 0; i < x.size(); ++i) {
    const RowView a = scratch.rows().row(i), b = body.graph.rows().row(i);
    if (a == b) continue;
    const auto [at, other] = std::mismatch(a.to.begin(), a.to.end(), b.to.begin(), b.to.end());
    const auto tell = [](const RowView& row, auto n) { return n == row.to.end() ? "none" : std::to_string(*n); };
    return "the row of node " + name(i) + " is not that of scratch: " + tell(b, other) + " for " + tell(a, at) + " is the first other node";
  }
  const Binding binding = build_binding(body);
  for (std::uint32_t v = 0; v < k.surface_vertex_count(); ++v) {
    if (k.alive(SurfaceVertexId(v)) && !binding.master[v].valid()) {
      const Side s = k.corner_of(SurfaceVertexId(v)).first;
      if (!dust(pieces.of_side[s.face.index() * 2 + static_cast<std::size_t>(s.which)])) return "surface vertex " + name(v) + " has no master";
    }
    if (binding.master[v] != body.binding.master[v] || binding.parent[v] != body.binding.parent[v] || binding.master_node[v] != body.binding.master_node[v])
      return "surface vertex " + name(v) + " is not bound as from scratch";
  }
  if (binding.closest != body.binding.closest) return "a node's closest vertex is not that of scratch";

  // What is kept for the next step.
  Body again;
  again.surface = k, again.binding = body.binding;
  begin_upkeep(again);
  const Upkeep &kept = body.upkeep, &fresh = again.upkeep;
  if (kept.depth.empty()) return {};  // nothing was split yet
  if (kept.depth != fresh.depth) return "depths are not those of scratch";
  if (kept.strays != fresh.strays) return "strays are not those of scratch";
  if (fresh.inner_shells && !kept.inner_shells) return "an inner shell is not known: " + std::to_string(kept.pieces) + " pieces known, " + std::to_string(fresh.pieces) + " from scratch";
  std::map<std::int32_t, std::int32_t> number, back;
  for (std::size_t v = 0; v < kept.piece.size(); ++v)
    if (number.try_emplace(kept.piece[v], fresh.piece[v]).first->second != fresh.piece[v] || back.try_emplace(fresh.piece[v], kept.piece[v]).first->second != kept.piece[v])
      return "surface vertex " + name(static_cast<std::uint32_t>(v)) + " is in piece " + std::to_string(kept.piece[v]) + " of " + std::to_string(kept.pieces) + ", from scratch in " + std::to_string(fresh.piece[v]) + " of " + std::to_string(fresh.pieces);
  return {};
}

/// The same, and what a step made of `before`.
inline std::string fault_of(const Body& before, const Body& body, const BodyDelta& delta, double volume) {
  if (const auto fault = fault_of(body, volume); !fault.empty()) return fault;
  const auto& x = body.nodes.position;
  std::vector<std::array<Vec3, 3>> soup;
  for (std::uint32_t f = 0; f < body.surface.face_count(); ++f)
    if (body.surface.alive(FaceId(f))) soup.push_back(body.surface.corners(FaceId(f)));
  const TriangleBvh faces(soup);
  const auto stood = [&](NodeId i) { return !std::binary_search(delta.moved_nodes.begin(), delta.moved_nodes.end(), i); };
  for (std::uint32_t i = 0; i < before.nodes.size(); ++i) {
    if (stood(NodeId(i)) != (x[i] == before.nodes.position[i])) return "node " + std::to_string(i) + " moved unsaid";
    for (const NodeId j : before.graph.edges(NodeId(i)))
      if (j.value > i && stood(NodeId(i)) && stood(j) && !body.graph.has(NodeId(i), j) && !faces.blocks(x[i], x[j.index()]))
        return "edge " + std::to_string(i) + "-" + std::to_string(j.value) + " was removed for nothing";
    const bool updated = std::binary_search(delta.updated_nodes.begin(), delta.updated_nodes.end(), NodeId(i));
    if (!updated && !(before.graph.rows().row(i) == body.graph.rows().row(i))) return "row " + std::to_string(i) + " changed unsaid";
  }
  std::vector<SurfaceVertexId> rebound;
  for (std::uint32_t v = 0; v < body.surface.surface_vertex_count(); ++v)
    if (body.surface.alive(SurfaceVertexId(v)) && carrier(before, v) != carrier(body, v)) rebound.push_back(SurfaceVertexId(v));
  if (rebound != delta.rebound) return "other vertices were rebound than it says";
  std::vector<std::uint32_t> component;
  const auto count = body.graph.components(component);
  std::vector<std::uint32_t> component_before;
  if (const auto more = count - before.graph.components(component_before); delta.parted.size() != more)
    return std::to_string(delta.parted.size()) + " parts came off, but there are " + std::to_string(more) + " components more";
  std::vector<std::size_t> size(count, 0);
  for (const auto c : component) ++size[c];
  for (const auto& part : delta.parted)
    for (const NodeId i : part)
      if (component[i.index()] != component[part[0].index()] || size[component[i.index()]] != part.size()) return "a part is not a component";
  return {};
}

}  // namespace body_faults
