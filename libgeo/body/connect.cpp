#include "body/connect.h"

#include <algorithm>
#include <set>

namespace geo {
namespace {

// The nearest older node that is accepted; invalid when there is none.
template <class Accept>
NodeId nearest_old(const Body& body, const Vec3& x, NodeId first_new, const Accept& accept) {
  const auto near = body.grid.nearest(body.nodes.position, x, 1, ~0u,
                                      [&](std::uint32_t i) { return i < first_new.value && accept(NodeId(i)); });
  return near.empty() ? NodeId() : NodeId(near[0]);
}

// A node of a component; pairs it with the one that is known of its piece, where they are not connected.
void look_at(Regions& components, std::int32_t piece, NodeId i, Disagreement& found) {
  if (piece < 0) return;
  const NodeId other = found.known.try_emplace(piece, i).first->second;
  components.seed(i.value), components.seed(other.value);
  if (components.joined(other.value, i.value)) return;
  for (const auto& [a, b] : found.apart)
    if ((a == other && components.joined(b.value, i.value)) || (b == other && components.joined(a.value, i.value)))
      return;
  found.apart.push_back({std::min(i, other), std::max(i, other)});
}

// Rounding the parts of a face may take the node of a thin piece out of it, though nothing was cut off. Else some of
// what carries the vertices of a piece's surface is in it, mostly of the first that are asked.
void look_for_emptied(const Body& body, std::span<const SurfaceVertexId> touched, Disagreement& found) {
  std::map<std::int32_t, std::vector<SurfaceVertexId>> of;
  for (const auto v : touched)
    if (const auto piece = body.upkeep.piece[v.index()];
        piece >= 0 && !found.known.count(piece) && !body.upkeep.bare.count(piece))
      of[piece].push_back(v);
  const Binding& b = body.binding;
  for (const auto& [piece, vertices] : of) {
    std::set<NodeId> asked;
    const auto holds = [&](NodeId i) { return asked.insert(i).second && piece_of(body, i) == piece; };
    const auto carried = [&](SurfaceVertexId v) {
      return v.index() < b.master.size() && b.master[v.index()].valid() &&
             holds(b.master_node[b.master[v.index()].index()]);
    };
    if (std::any_of(vertices.begin(), vertices.end(), carried)) continue;
    std::set<SurfaceVertexId> seen(vertices.begin(), vertices.end());
    std::vector<SurfaceVertexId> shell(vertices), around;
    bool held = false;
    Box3 box;
    for (std::size_t s = 0; s < shell.size() && !held; ++s) {
      box.add(body.surface.point(body.surface.site(shell[s])));
      held = carried(shell[s]);
      around.clear();
      body.surface.surface_neighbors(shell[s], around);
      for (const auto w : around)
        if (seen.insert(w).second) shell.push_back(w);
    }
    if (!held)
      body.grid.walk(
          [&](int, const Vec3& middle, double half) {
            return !held && box.grown(half).meets(Box3{middle, middle});
          },
          [&](int, std::uint32_t i) {
            held = held || (box.meets(Box3{body.nodes.position[i], body.nodes.position[i]}) && holds(NodeId(i)));
          });
    if (held) continue;
    found.empty.push_back(vertices[0]);
    found.known.emplace(piece, NodeId());  // until it has one
  }
}

}  // namespace

Regions components_of(const Body& body) {
  return Regions([&body](std::uint32_t i, std::vector<std::uint32_t>& out) {
    for (const NodeId j : body.graph.edges(NodeId(i))) out.push_back(j.value);
  });
}

Disagreement find_disagreement(const Body& body, const std::vector<std::uint32_t>& component) {
  std::vector<std::uint32_t> size, first;
  for (std::uint32_t i = 0; i < component.size(); ++i) {
    if (component[i] == first.size()) first.push_back(i), size.push_back(0);
    ++size[component[i]];
  }
  const auto count = first.size();
  // The largest component of each piece stands for it.
  Disagreement found;
  std::vector<std::int32_t> piece(count);
  for (std::uint32_t c = 0; c < count; ++c) {
    piece[c] = piece_of(body, NodeId(first[c]));
    if (piece[c] < 0) continue;
    auto& known = found.known.try_emplace(piece[c], NodeId(first[c])).first->second;
    if (size[c] > size[component[known.index()]]) known = NodeId(first[c]);
  }
  for (std::uint32_t c = 0; c < count; ++c)
    if (piece[c] >= 0)
      if (const NodeId known = found.known.at(piece[c]); known.value != first[c])
        found.apart.push_back({std::min(known, NodeId(first[c])), std::max(known, NodeId(first[c]))});
  std::set<std::int32_t> empty;
  for (std::uint32_t v = 0; v < body.upkeep.piece.size(); ++v)
    if (const auto p = body.upkeep.piece[v]; p >= 0 && !found.known.count(p) && empty.insert(p).second)
      found.empty.push_back(SurfaceVertexId(v));
  return found;
}

Disagreement find_disagreement(const Body& body, std::span<const NodePair> cut, std::span<const Offcut> offcuts,
                               std::span<const SurfaceVertexId> touched, NodeId first_new) {
  Disagreement found;
  Regions components = components_of(body);
  for (const auto& [a, b] : cut) components.seed(a.value), components.seed(b.value);
  components.grow_seeds();
  std::map<std::int32_t, std::int32_t> origin;  // pieces cut off: what they were a part of before the step
  for (const Offcut& o : offcuts) origin[o.piece] = o.from;
  const auto origin_of = [&](std::int32_t piece) {
    const auto at = origin.find(piece);
    return at == origin.end() ? piece : at->second;
  };
  // Every part into which cut edges divided a component has an end of one that leads to another part.
  std::set<std::int32_t> divided;
  std::map<std::uint32_t, std::int32_t> piece_of_part;  // by its lowest node so far
  for (const auto& [a, b] : cut) {
    if (components.joined(a.value, b.value)) continue;
    for (const NodeId i : {a, b}) {
      const auto [at, fresh] = piece_of_part.try_emplace(components.lowest(i.value), -1);
      if (fresh) at->second = piece_of(body, i);
      if (at->second >= 0) divided.insert(origin_of(at->second)), look_at(components, at->second, i, found);
    }
  }
  // Rounding the parts of a face may take them past a node that stands some last places before it: it is alone in a
  // piece that nothing was cut off from.
  for (const auto& [part, piece] : piece_of_part) {
    if (piece < 0 || !components.whole(part) ||
        std::any_of(offcuts.begin(), offcuts.end(), [&](const Offcut& o) { return o.from == origin_of(piece); }))
      continue;
    auto inside = components.inside(part);
    std::sort(inside.begin(), inside.end());
    const NodeId other = nearest_old(body, body.nodes.position[part], first_new, [&](NodeId i) {
      return !std::binary_search(inside.begin(), inside.end(), i.value) && piece_of(body, i) == piece;
    });
    if (other.valid()) look_at(components, piece, other, found);
  }
  // Material came apart and the graph did not: its nodes are all in one of the parts.
  for (const Offcut& o : offcuts)
    if (divided.insert(o.from).second)
      if (const NodeId i = nearest_old(body, body.surface.point(body.surface.site(o.at)), first_new,
                                       [&](NodeId n) {
                                         const auto piece = piece_of(body, n);
                                         return piece >= 0 && origin_of(piece) == o.from;
                                       });
          i.valid())
        look_at(components, piece_of(body, i), i, found);
  // Of these pieces all old components are known; new nodes there are partners only for each other.
  for (std::uint32_t i = first_new.value; i < body.nodes.size(); ++i) components.seed(i);
  for (std::uint32_t i = first_new.value; i < body.nodes.size() && !offcuts.empty(); ++i) {
    while (components.lowest(i) >= first_new.value && !components.whole(i)) components.grow(i);
    if (components.lowest(i) == i)
      if (const auto piece = piece_of(body, NodeId(i)); divided.count(origin_of(piece)))
        found.known.try_emplace(piece, NodeId(i));
  }
  pair_new_nodes(body, components, first_new, found);
  for (const Offcut& o : offcuts)
    for (const SurfaceVertexId v : {o.at, o.rest})
      if (const auto piece = body.upkeep.piece[v.index()]; !found.known.count(piece)) {
        found.empty.push_back(v);
        found.known.emplace(piece, NodeId());  // until it has one
      }
  look_for_emptied(body, touched, found);
  return found;
}

void pair_new_nodes(const Body& body, Regions& components, NodeId first_new, Disagreement& found) {
  for (std::uint32_t i = first_new.value; i < body.nodes.size(); ++i) components.seed(i);
  for (std::uint32_t i = first_new.value; i < body.nodes.size(); ++i) {
    while (components.lowest(i) >= first_new.value && !components.whole(i)) components.grow(i);
    if (components.lowest(i) != i) continue;
    const auto piece = piece_of(body, NodeId(i));
    if (!found.known.count(piece))
      if (const NodeId old = nearest_old(body, body.nodes.position[i], first_new,
                                         [&](NodeId n) { return piece_of(body, n) == piece; });
          old.valid())
        found.known.emplace(piece, old);
    look_at(components, piece, NodeId(i), found);
  }
}

std::vector<std::vector<NodeId>> parted_nodes(const Body& body, std::span<const Offcut> offcuts,
                                              const Disagreement& found) {
  std::map<std::int32_t, std::set<std::int32_t>> families;
  for (const Offcut& o : offcuts)
    for (const SurfaceVertexId v : {o.at, o.rest}) families[o.from].insert(body.upkeep.piece[v.index()]);
  Regions components = components_of(body);
  std::vector<std::vector<NodeId>> parted;
  for (const auto& [from, pieces] : families) {
    NodeId largest;
    for (const auto piece : pieces) {
      const auto at = found.known.find(piece);
      if (at == found.known.end() || !at->second.valid()) continue;
      NodeId other = at->second;
      components.seed(other.value);
      if (!largest.valid()) largest = other;
      if (components.joined(largest.value, other.value)) continue;
      const bool smaller = components.whole(other.value) &&
                           (!components.whole(largest.value) ||
                            components.inside(other.value).size() <= components.inside(largest.value).size());
      if (!smaller) std::swap(largest, other);
      std::vector<NodeId> nodes;
      for (const auto i : components.inside(other.value)) nodes.push_back(NodeId(i));
      std::sort(nodes.begin(), nodes.end());
      parted.push_back(std::move(nodes));
    }
  }
  return parted;
}

}  // namespace geo
