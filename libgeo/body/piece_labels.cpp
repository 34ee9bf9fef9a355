// Labels are copied to new vertices, or flooded over the surface from labelled ones. Both sides of
// each new crack face then grow along the surface until they meet; if they do not, the piece with
// less surface gets a new label.
#include "body/piece_labels.h"

#include <algorithm>
#include <array>
#include <map>

#include "body/locate.h"
#include "body/regions.h"
#include "kerf/pieces.h"

namespace geo {
namespace {

constexpr std::int32_t unlabelled = -1, in_progress = -2;

// Shells as connected regions of surface vertices.
Regions shells_of(const Complex& k) {
  return Regions(
      [&k, around = std::vector<SurfaceVertexId>()](std::uint32_t v, std::vector<std::uint32_t>& out) mutable {
        around.clear();
        k.surface_neighbors(SurfaceVertexId(v), around);
        for (const auto w : around) out.push_back(w.value);
      });
}

// Labels the connected unlabelled vertices around v: with the label of an adjacent vertex, else
// with `label`. False if both are missing.
bool flood(Body& body, SurfaceVertexId v, std::int32_t label) {
  auto& labels = body.cache->piece;
  std::vector<SurfaceVertexId> found{v}, around;
  labels[v.index()] = in_progress;
  for (std::size_t i = 0; i < found.size(); ++i) {
    around.clear();
    body.surface.surface_neighbors(found[i], around);
    for (const auto w : around) {
      if (labels[w.index()] == unlabelled) {
        labels[w.index()] = in_progress;
        found.push_back(w);
      }
      if (labels[w.index()] >= 0) label = labels[w.index()];
    }
  }
  for (const auto w : found) labels[w.index()] = label;
  return label >= 0;
}

// Labels shells that consist of new faces only, with both sides of each: cracks inside the
// material. Their pieces are found from scratch; vertices with a label keep it.
void label_inner_shells(Body& body) {
  const Complex& k = body.surface;
  IncrementalCache& cache = *body.cache;
  auto& labels = cache.piece;
  const auto kept = labels;
  const auto count = cache.piece_count;
  const auto without_node = cache.pieces_without_node;
  label_pieces(body);
  std::vector<std::int32_t> old_label(static_cast<std::size_t>(cache.piece_count), unlabelled);
  for (std::size_t v = 0; v < kept.size(); ++v)
    if (kept[v] >= 0) old_label[static_cast<std::size_t>(labels[v])] = kept[v];
  for (std::size_t v = 0; v < kept.size(); ++v)
    if (k.alive(SurfaceVertexId(v)))
      labels[v] = kept[v] >= 0 ? kept[v] : old_label[static_cast<std::size_t>(labels[v])];
  cache.piece_count = count;
  cache.pieces_without_node = without_node;
  cache.inner_shells = true;
}

// True when vertices with different labels are connected. Rounding may exchange the sheets around a
// sliver; a later crack may then join it to its surroundings.
bool have_joined(const Body& body, const CrackDelta& delta) {
  const auto& labels = body.cache->piece;
  std::vector<SurfaceVertexId> around;
  for (const auto* vertices : {&delta.touched_surface_vertices, &delta.new_surface_vertices})
    for (const auto v : *vertices) {
      around.clear();
      body.surface.surface_neighbors(v, around);
      if (std::any_of(around.begin(), around.end(),
                      [&](SurfaceVertexId w) { return labels[w.index()] != labels[v.index()]; }))
        return true;
    }
  return false;
}

using TwoSides = std::array<SurfaceVertexId, 2>;  // a vertex on each side of a crack face

// New vertices take the label of their original, if they are copies, else of their surroundings,
// else of the other side of their crack faces. Both sides were the same material before.
void label_new_vertices(Body& body, const CrackDelta& delta, const std::vector<TwoSides>& crack_faces) {
  auto& labels = body.cache->piece;
  labels.resize(body.surface.surface_vertex_count(), unlabelled);
  for (std::size_t i = 0; i < delta.new_surface_vertices.size(); ++i)
    if (const auto old = delta.copied_from[i]; old.valid())
      labels[delta.new_surface_vertices[i].index()] = std::int32_t(labels[old.index()]);
  for (const auto v : delta.removed_surface_vertices) labels[v.index()] = unlabelled;
  bool incomplete = false;
  for (const auto v : delta.new_surface_vertices)
    if (labels[v.index()] == unlabelled) incomplete |= !flood(body, v, unlabelled);
  const auto label_across = [&] {
    for (bool progress = incomplete; progress;) {
      progress = incomplete = false;
      for (const auto& [a, b] : crack_faces) {
        const bool has_a = labels[a.index()] >= 0, has_b = labels[b.index()] >= 0;
        if (has_a != has_b) progress |= flood(body, has_a ? b : a, labels[(has_a ? a : b).index()]);
        incomplete |= !has_a && !has_b;
      }
    }
  };
  label_across();
  if (incomplete) {
    label_inner_shells(body);
    label_across();
  }
}

// Walks the shells from both sides of new crack faces until they meet or the smaller one is
// complete. The largest part of each piece keeps its label; the others get new ones.
std::vector<DetachedPiece> detach(Body& body, std::vector<TwoSides> crack_faces) {
  auto& labels = body.cache->piece;
  Regions shells = shells_of(body.surface);
  std::erase_if(crack_faces, [&](const auto& sides) {
    return sides[0] == sides[1] || labels[sides[0].index()] != labels[sides[1].index()];
  });
  for (const auto& sides : crack_faces)
    for (const auto v : sides) shells.seed(v.value);
  shells.grow_seeds();
  std::map<std::int32_t, std::vector<SurfaceVertexId>> parts;  // by label: a vertex of each part
  for (const auto& [a, b] : crack_faces) {
    if (shells.joined(a.value, b.value)) continue;
    auto& known = parts[labels[a.index()]];
    for (const auto v : {a, b})
      if (std::none_of(known.begin(), known.end(), [&](SurfaceVertexId w) { return shells.joined(v.value, w.value); }))
        known.push_back(v);
  }
  std::vector<DetachedPiece> detached;
  for (const auto& [from, known] : parts) {
    SurfaceVertexId rest = known[0];
    for (const auto v : known)
      if (shells.whole(rest.value) &&
          (!shells.whole(v.value) || shells.inside(v.value).size() > shells.inside(rest.value).size()))
        rest = v;
    for (const auto v : known) {
      if (v == rest) continue;
      detached.push_back({.piece = body.cache->piece_count++, .from = from, .at = v, .rest = rest});
      for (const auto w : shells.inside(v.value)) labels[w] = detached.back().piece;
    }
  }
  return detached;
}

}  // namespace

void label_pieces(Body& body) {
  const Complex& k = body.surface;
  const Pieces pieces = find_pieces(k);
  IncrementalCache& cache = *body.cache;
  cache.piece.assign(k.surface_vertex_count(), unlabelled);
  for (std::uint32_t v = 0; v < k.surface_vertex_count(); ++v)
    if (k.alive(SurfaceVertexId(v))) {
      const Side s = k.corner_of(SurfaceVertexId(v)).first;
      cache.piece[v] = pieces.of_side[s.face.index() * 2 + static_cast<std::size_t>(s.which)];
    }
  cache.piece_count = static_cast<std::int32_t>(pieces.count);
  cache.pieces_without_node.clear();
  cache.inner_shells = pieces.shells > pieces.count;
}

std::int32_t piece_of(const Body& body, NodeId i) { return piece_at(body, body.nodes.position[i.index()]); }

std::int32_t piece_at(const Body& body, const Vec3& p) {
  return piece_containing(body.surface, p,
                          [&](Side s) { return body.cache->piece[body.surface.surface_vertex(s, 0).index()]; });
}

std::vector<DetachedPiece> update_piece_labels(Body& body, const CrackDelta& delta, bool& relabelled) {
  const Complex& k = body.surface;
  std::vector<TwoSides> crack_faces;
  for (const FaceId f : delta.new_crack_faces)
    crack_faces.push_back({k.surface_vertex({f, 0}, 0), k.surface_vertex({f, 1}, 0)});
  label_new_vertices(body, delta, crack_faces);
  const bool joined = have_joined(body, delta);
  auto detached = detach(body, std::move(crack_faces));
  relabelled = joined || (!detached.empty() && body.cache->inner_shells);
  if (relabelled) label_pieces(body);
  return detached;
}

}  // namespace geo
