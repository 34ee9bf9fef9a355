// From scratch: components of G are labelled with the piece of one of their nodes. After a step:
// regions grow on both sides of cut edges and detached pieces, the smaller one first, until they
// meet or the smaller one is complete.
#include "body/connectivity.h"

#include <algorithm>
#include <set>

namespace geo {
namespace {

// The nearest accepted node to x among those before `first_new`; invalid when there is none.
template <class Accept>
NodeId nearest_old(const Body& body, const Vec3& x, NodeId first_new, const Accept& accept) {
  const auto near = body.cache->grid.nearest(body.nodes.position, x, 1, ~0u,
                                             [&](std::uint32_t i) { return i < first_new.value && accept(NodeId(i)); });
  return near.empty() ? NodeId() : NodeId(near[0]);
}

// Node i stands for its component. Records it with the representative of its piece, unless G or a
// recorded pair connects them.
void pair_with_representative(Regions& components, std::int32_t piece, NodeId i, ConnectivityMismatch& mismatch) {
  if (piece < 0) return;
  const NodeId other = mismatch.representative.try_emplace(piece, i).first->second;
  components.seed(i.value);
  components.seed(other.value);
  if (components.joined(other.value, i.value)) return;
  for (const auto& [a, b] : mismatch.disconnected)
    if ((a == other && components.joined(b.value, i.value)) || (b == other && components.joined(a.value, i.value)))
      return;
  mismatch.disconnected.push_back({std::min(i, other), std::max(i, other)});
}

void record_empty_piece(std::int32_t piece, SurfaceVertexId v, ConnectivityMismatch& mismatch) {
  mismatch.empty_pieces.push_back(v);
  mismatch.representative.emplace(piece, NodeId());
}

// Does a piece hold a node? `vertices`: some of its surface. Tests carrying nodes of `vertices`,
// then carrying nodes of the rest of the shell, then all nodes in the shell's box. Where shells
// bound a piece from inside, nodes are beyond that box: the nearest ones are tested last.
bool holds_node(const Body& body, std::int32_t piece, const std::vector<SurfaceVertexId>& vertices) {
  const Binding& b = body.binding;
  std::set<NodeId> tested;
  const auto inside = [&](NodeId i) { return tested.insert(i).second && piece_of(body, i) == piece; };
  const auto carrier_inside = [&](SurfaceVertexId v) {
    return v.index() < b.master.size() && b.master[v.index()].valid() &&
           inside(b.master_node[b.master[v.index()].index()]);
  };
  if (std::any_of(vertices.begin(), vertices.end(), carrier_inside)) return true;
  std::set<SurfaceVertexId> visited(vertices.begin(), vertices.end());
  std::vector<SurfaceVertexId> shell(vertices), around;
  bool found = false;
  Box3 box;
  for (std::size_t s = 0; s < shell.size() && !found; ++s) {
    box.add(body.surface.point(body.surface.site(shell[s])));
    found = carrier_inside(shell[s]);
    around.clear();
    body.surface.surface_neighbors(shell[s], around);
    for (const auto w : around)
      if (visited.insert(w).second) shell.push_back(w);
  }
  if (found) return true;
  body.cache->grid.walk(
      [&](int, const Vec3& middle, double half) {
        return !found && box.grown(half).meets(Box3{middle, middle});
      },
      [&](int, std::uint32_t i) {
        found = found || (box.meets(Box3{body.nodes.position[i], body.nodes.position[i]}) && inside(NodeId(i)));
      });
  if (found || !body.cache->inner_shells) return found;
  const Vec3& x = body.surface.point(body.surface.site(vertices[0]));
  return !body.cache->grid.nearest(body.nodes.position, x, 1, ~0u, [&](std::uint32_t i) { return inside(NodeId(i)); })
              .empty();
}

// The comparison after a step, in phases.
class StepComparison {
 public:
  StepComparison(const Body& body, std::span<const DetachedPiece> detached, NodeId first_new)
      : body_(body), detached_(detached), first_new_(first_new), components_(components_of(body)) {
    for (const DetachedPiece& d : detached) origin_[d.piece] = d.from;
  }

  /// Each part into which cut edges divide a component has an end of a cut edge to another part.
  void pair_ends_of_cut_edges(std::span<const NodePair> cut) {
    for (const auto& [a, b] : cut) {
      components_.seed(a.value);
      components_.seed(b.value);
    }
    components_.grow_seeds();
    for (const auto& [a, b] : cut) {
      if (components_.joined(a.value, b.value)) continue;
      for (const NodeId i : {a, b}) {
        const auto [at, fresh] = piece_of_part_.try_emplace(components_.lowest(i.value), -1);
        if (fresh) at->second = piece_of(body_, i);
        if (at->second < 0) continue;
        divided_.insert(origin_of(at->second));
        pair_with_representative(components_, at->second, i, mismatch);
      }
    }
  }
  /// Rounding the children of a face may move them past a node some ulps in front of it. The node
  /// is then alone in another piece, from which nothing was detached.
  void pair_stranded_nodes() {
    for (const auto& [part, piece] : piece_of_part_) {
      const auto origin = origin_of(piece);
      if (piece < 0 || !components_.whole(part) ||
          std::any_of(detached_.begin(), detached_.end(), [&](const DetachedPiece& d) { return d.from == origin; }))
        continue;
      auto inside = components_.inside(part);
      std::sort(inside.begin(), inside.end());
      const auto label = piece;
      const NodeId other = nearest_old(body_, body_.nodes.position[part], first_new_, [&](NodeId i) {
        return !std::binary_search(inside.begin(), inside.end(), i.value) && piece_of(body_, i) == label;
      });
      if (other.valid()) pair_with_representative(components_, label, other, mismatch);
    }
  }
  /// Where material came apart and no edge was cut, all nodes are in one of the parts.
  void find_undivided_nodes() {
    for (const DetachedPiece& d : detached_) {
      if (!divided_.insert(d.from).second) continue;
      const NodeId i = nearest_old(body_, body_.surface.point(body_.surface.site(d.at)), first_new_, [&](NodeId n) {
        const auto piece = piece_of(body_, n);
        return piece >= 0 && origin_of(piece) == d.from;
      });
      if (i.valid()) pair_with_representative(components_, piece_of(body_, i), i, mismatch);
    }
  }
  /// All old components of divided pieces are known by now. New nodes in other parts represent
  /// these.
  void pair_components_of_new_nodes() {
    for (std::uint32_t i = first_new_.value; i < body_.nodes.size(); ++i) components_.seed(i);
    for (std::uint32_t i = first_new_.value; i < body_.nodes.size() && !detached_.empty(); ++i) {
      while (components_.lowest(i) >= first_new_.value && !components_.whole(i)) components_.grow(i);
      if (components_.lowest(i) == i)
        if (const auto piece = piece_of(body_, NodeId(i)); divided_.count(origin_of(piece)))
          mismatch.representative.try_emplace(piece, NodeId(i));
    }
    pair_new_nodes(body_, components_, first_new_, mismatch);
  }
  void find_empty_pieces(std::span<const SurfaceVertexId> touched) {
    for (const DetachedPiece& d : detached_)
      for (const SurfaceVertexId v : {d.at, d.rest})
        if (const auto piece = body_.cache->piece[v.index()]; !mismatch.representative.count(piece))
          record_empty_piece(piece, v, mismatch);
    find_emptied_pieces(touched);
    for (const SurfaceVertexId v : mismatch.empty_pieces) pair_escaped_node(v);
  }

  ConnectivityMismatch mismatch;

 private:
  // A face's children are rounded, so that the only node of a thin piece may end up outside of it
  // though nothing was detached.
  void find_emptied_pieces(std::span<const SurfaceVertexId> touched) {
    std::map<std::int32_t, std::vector<SurfaceVertexId>> pieces;
    for (const auto v : touched)
      if (const auto piece = body_.cache->piece[v.index()];
          piece >= 0 && !mismatch.representative.count(piece) && !body_.cache->pieces_without_node.count(piece))
        pieces[piece].push_back(v);
    for (const auto& [piece, vertices] : pieces)
      if (!holds_node(body_, piece, vertices)) record_empty_piece(piece, vertices[0], mismatch);
  }

  // The only node of a piece that is empty now may be alone in another one. It carries no vertex
  // any more. Looks at the nearest nodes without an edge, most of which are the only ones of their
  // pieces.
  void pair_escaped_node(SurfaceVertexId v) {
    constexpr std::size_t most = 8;
    const auto is_alone = [&](std::uint32_t i) {
      const auto edges = body_.graph.edges(NodeId(i));
      return i < first_new_.value && !(edges.begin() != edges.end());
    };
    const Vec3& x = body_.surface.point(body_.surface.site(v));
    for (const auto node : body_.cache->grid.nearest(body_.nodes.position, x, most, ~0u, is_alone)) {
      const std::int32_t piece = piece_of(body_, NodeId(node));
      const NodeId other = nearest_old(body_, body_.nodes.position[node], first_new_,
                                       [&](NodeId i) { return i.value != node && piece_of(body_, i) == piece; });
      if (piece < 0 || !other.valid()) continue;
      mismatch.representative.try_emplace(piece, other);
      pair_with_representative(components_, piece, NodeId(node), mismatch);
    }
  }

  // The label before the step.
  std::int32_t origin_of(std::int32_t piece) const {
    const auto at = origin_.find(piece);
    return at == origin_.end() ? piece : at->second;
  }

  const Body& body_;
  std::span<const DetachedPiece> detached_;
  const NodeId first_new_;
  Regions components_;
  std::map<std::int32_t, std::int32_t> origin_;          // of detached pieces
  std::set<std::int32_t> divided_;                       // labels before the step
  std::map<std::uint32_t, std::int32_t> piece_of_part_;  // by the lowest node of the part so far
};

}  // namespace

Regions components_of(const Body& body) {
  return Regions([&body](std::uint32_t i, std::vector<std::uint32_t>& out) {
    for (const NodeId j : body.graph.edges(NodeId(i))) out.push_back(j.value);
  });
}

ConnectivityMismatch find_mismatch(const Body& body, const std::vector<std::uint32_t>& component) {
  std::vector<std::uint32_t> size, first;
  for (std::uint32_t i = 0; i < component.size(); ++i) {
    if (component[i] == first.size()) {
      first.push_back(i);
      size.push_back(0);
    }
    ++size[component[i]];
  }
  const auto count = first.size();
  // The largest component of each piece represents it.
  ConnectivityMismatch mismatch;
  std::vector<std::int32_t> piece(count);
  for (std::uint32_t c = 0; c < count; ++c) {
    piece[c] = piece_of(body, NodeId(first[c]));
    if (piece[c] < 0) continue;
    auto& node = mismatch.representative.try_emplace(piece[c], NodeId(first[c])).first->second;
    if (size[c] > size[component[node.index()]]) node = NodeId(first[c]);
  }
  for (std::uint32_t c = 0; c < count; ++c)
    if (piece[c] >= 0)
      if (const NodeId node = mismatch.representative.at(piece[c]); node.value != first[c])
        mismatch.disconnected.push_back({std::min(node, NodeId(first[c])), std::max(node, NodeId(first[c]))});
  std::set<std::int32_t> empty;
  for (std::uint32_t v = 0; v < body.cache->piece.size(); ++v)
    if (const auto p = body.cache->piece[v]; p >= 0 && !mismatch.representative.count(p) && empty.insert(p).second)
      mismatch.empty_pieces.push_back(SurfaceVertexId(v));
  return mismatch;
}

ConnectivityMismatch find_mismatch(const Body& body, std::span<const NodePair> cut,
                                   std::span<const DetachedPiece> detached, std::span<const SurfaceVertexId> touched,
                                   NodeId first_new) {
  StepComparison comparison(body, detached, first_new);
  comparison.pair_ends_of_cut_edges(cut);
  comparison.pair_stranded_nodes();
  comparison.find_undivided_nodes();
  comparison.pair_components_of_new_nodes();
  comparison.find_empty_pieces(touched);
  return std::move(comparison.mismatch);
}

void note_parts(const Body& body, std::span<const DetachedPiece> detached, ConnectivityMismatch& mismatch) {
  std::map<std::int32_t, std::set<std::int32_t>> parts;  // by the label before
  for (const DetachedPiece& d : detached)
    for (const SurfaceVertexId v : {d.at, d.rest}) parts[d.from].insert(body.cache->piece[v.index()]);
  for (const auto& [from, labels] : parts)
    for (const auto label : labels) mismatch.parts[label] = labels;
}

void pair_new_nodes(const Body& body, Regions& components, NodeId first_new, ConnectivityMismatch& mismatch) {
  for (std::uint32_t i = first_new.value; i < body.nodes.size(); ++i) components.seed(i);
  for (std::uint32_t i = first_new.value; i < body.nodes.size(); ++i) {
    while (components.lowest(i) >= first_new.value && !components.whole(i)) components.grow(i);
    if (components.lowest(i) != i) continue;
    const auto piece = piece_of(body, NodeId(i));
    if (!mismatch.representative.count(piece))
      if (const NodeId old = nearest_old(body, body.nodes.position[i], first_new,
                                         [&](NodeId n) { return piece_of(body, n) == piece; });
          old.valid())
        mismatch.representative.emplace(piece, old);
    pair_with_representative(components, piece, NodeId(i), mismatch);
  }
}

std::vector<std::vector<NodeId>> detached_nodes(const Body& body, std::span<const DetachedPiece> detached,
                                                const ConnectivityMismatch& mismatch) {
  std::map<std::int32_t, std::set<std::int32_t>> parts;  // by label before the step: labels after it
  for (const DetachedPiece& d : detached)
    for (const SurfaceVertexId v : {d.at, d.rest}) parts[d.from].insert(body.cache->piece[v.index()]);
  Regions components = components_of(body);
  std::vector<std::vector<NodeId>> result;
  for (const auto& [from, pieces] : parts) {
    NodeId largest;
    for (const auto piece : pieces) {
      const auto at = mismatch.representative.find(piece);
      if (at == mismatch.representative.end() || !at->second.valid()) continue;
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
      result.push_back(std::move(nodes));
    }
  }
  return result;
}

}  // namespace geo
