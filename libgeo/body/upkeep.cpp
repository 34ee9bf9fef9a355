#include "body/upkeep.h"

#include <algorithm>
#include <map>

#include "body/locate.h"
#include "body/regions.h"
#include "kerf/pieces.h"

namespace geo {
namespace {

Regions shells_of(const Complex& k) {
  return Regions(
      [&k, around = std::vector<SurfaceVertexId>()](std::uint32_t v, std::vector<std::uint32_t>& out) mutable {
        around.clear();
        k.surface_neighbors(SurfaceVertexId(v), around);
        for (const auto w : around) out.push_back(w.value);
      });
}

// The surface vertices without a piece that hang together with v take the piece beside them, or the one given; returns
// whether there was one.
bool fill(Body& body, SurfaceVertexId v, std::int32_t piece) {
  auto& of = body.upkeep.piece;
  std::vector<SurfaceVertexId> found{v}, around;
  of[v.index()] = -2;
  for (std::size_t i = 0; i < found.size(); ++i) {
    around.clear();
    body.surface.surface_neighbors(found[i], around);
    for (const auto w : around) {
      if (of[w.index()] == -1) of[w.index()] = -2, found.push_back(w);
      if (of[w.index()] >= 0) piece = of[w.index()];
    }
  }
  for (const auto w : found) of[w.index()] = piece;
  return piece >= 0;
}

// A closed shell of new faces with both sides of each: a crack inside the material. Its piece is found as from scratch.
void place_inner(Body& body) {
  const Complex& k = body.surface;
  auto& of = body.upkeep.piece;
  const auto own = of;
  const auto pieces = body.upkeep.pieces;
  const auto bare = body.upkeep.bare;
  count_pieces(body);
  std::vector<std::int32_t> number(static_cast<std::size_t>(body.upkeep.pieces), -1);
  for (std::size_t v = 0; v < own.size(); ++v)
    if (own[v] >= 0) number[static_cast<std::size_t>(of[v])] = own[v];
  for (std::size_t v = 0; v < own.size(); ++v)
    if (k.alive(SurfaceVertexId(v))) of[v] = own[v] >= 0 ? own[v] : number[static_cast<std::size_t>(of[v])];
  body.upkeep.pieces = pieces, body.upkeep.bare = bare;
  body.upkeep.inner_shells = true;
}

// True when vertices of several pieces hang together: where rounding had exchanged the sheets of a crumb, a later crack
// may join it to what is beside it.
bool have_joined(const Body& body, const CrackDelta& delta) {
  const auto& of = body.upkeep.piece;
  std::vector<SurfaceVertexId> around;
  for (const auto* vertices : {&delta.touched_surface_vertices, &delta.new_surface_vertices})
    for (const auto v : *vertices) {
      around.clear();
      body.surface.surface_neighbors(v, around);
      if (std::any_of(around.begin(), around.end(), [&](SurfaceVertexId w) { return of[w.index()] != of[v.index()]; }))
        return true;
    }
  return false;
}

}  // namespace

void count_pieces(Body& body) {
  const Complex& k = body.surface;
  const Pieces pieces = find_pieces(k);
  auto& keep = body.upkeep;
  keep.piece.assign(k.surface_vertex_count(), -1);
  for (std::uint32_t v = 0; v < k.surface_vertex_count(); ++v)
    if (k.alive(SurfaceVertexId(v))) {
      const Side s = k.corner_of(SurfaceVertexId(v)).first;
      keep.piece[v] = pieces.of_side[s.face.index() * 2 + static_cast<std::size_t>(s.which)];
    }
  keep.pieces = static_cast<std::int32_t>(pieces.count);
  keep.bare.clear();
  keep.inner_shells = pieces.shells > pieces.count;
}

void begin_upkeep(Body& body) {
  auto& keep = body.upkeep;
  const std::size_t n = body.surface.surface_vertex_count();
  if (keep.piece.size() != n) count_pieces(body);
  if (keep.depth.size() == n) return;
  const Binding& b = body.binding;
  std::vector<std::uint8_t> looked_at(n, 0);
  for (const auto v : b.closest)
    if (v.valid()) looked_at[v.index()] = 1;
  keep.depth.assign(n, ~0u);
  keep.strays.clear();
  std::vector<SurfaceVertexId> way;
  for (std::uint32_t v = 0; v < n; ++v) {
    if (!b.master[v].valid()) continue;
    SurfaceVertexId at(v);
    for (way.clear(); keep.depth[at.index()] == ~0u && b.parent[at.index()] != at; at = b.parent[at.index()])
      way.push_back(at);
    if (b.parent[at.index()] == at) keep.depth[at.index()] = 0;
    for (std::uint32_t depth = keep.depth[at.index()]; !way.empty(); way.pop_back())
      keep.depth[way.back().index()] = ++depth;
    if (b.parent[v].value == v && !looked_at[v]) keep.strays.push_back(SurfaceVertexId(v));
  }
}

std::int32_t piece_of(const Body& body, NodeId i) { return piece_at(body, body.nodes.position[i.index()]); }

std::int32_t piece_at(const Body& body, const Vec3& p) {
  return piece_around(body.surface, p,
                      [&](Side s) { return body.upkeep.piece[body.surface.surface_vertex(s, 0).index()]; });
}

std::vector<Offcut> part_pieces(Body& body, const CrackDelta& delta, bool& recounted) {
  const Complex& k = body.surface;
  auto& of = body.upkeep.piece;
  of.resize(k.surface_vertex_count(), -1);
  for (std::size_t i = 0; i < delta.new_surface_vertices.size(); ++i)
    if (const auto old = delta.copied_from[i]; old.valid())
      of[delta.new_surface_vertices[i].index()] = std::int32_t(of[old.index()]);
  for (const auto v : delta.removed_surface_vertices) of[v.index()] = -1;
  bool unknown = false;
  for (const auto v : delta.new_surface_vertices)
    if (of[v.index()] == -1) unknown |= !fill(body, v, -1);

  std::vector<std::array<SurfaceVertexId, 2>> across;  // the two sides of each crack face where there was material
  for (const FaceId f : delta.new_crack_faces)
    across.push_back({k.surface_vertex({f, 0}, 0), k.surface_vertex({f, 1}, 0)});
  // A piece of new surface vertices alone was a part of what is across its faces.
  const auto fill_across = [&] {
    for (bool more = unknown; more;) {
      more = unknown = false;
      for (const auto& [a, b] : across) {
        const bool has_a = of[a.index()] >= 0, has_b = of[b.index()] >= 0;
        if (has_a != has_b) more |= fill(body, has_a ? b : a, of[(has_a ? a : b).index()]);
        unknown |= !has_a && !has_b;
      }
    }
  };
  fill_across();
  if (unknown) place_inner(body), fill_across();

  const bool joined = have_joined(body, delta);
  Regions shells = shells_of(k);
  std::erase_if(
      across, [&](const auto& sides) { return sides[0] == sides[1] || of[sides[0].index()] != of[sides[1].index()]; });
  for (const auto& sides : across)
    for (const auto v : sides) shells.seed(v.value);
  shells.grow_seeds();
  std::map<std::int32_t, std::vector<SurfaceVertexId>> parts;  // of each piece that came apart
  for (const auto& [a, b] : across) {
    if (shells.joined(a.value, b.value)) continue;
    auto& known = parts[of[a.index()]];
    for (const auto v : {a, b})
      if (std::none_of(known.begin(), known.end(), [&](SurfaceVertexId w) { return shells.joined(v.value, w.value); }))
        known.push_back(v);
  }
  std::vector<Offcut> offcuts;
  for (const auto& [from, known] : parts) {
    SurfaceVertexId rest = known[0];  // keeps the number
    for (const auto v : known)
      if (shells.whole(rest.value) &&
          (!shells.whole(v.value) || shells.inside(v.value).size() > shells.inside(rest.value).size()))
        rest = v;
    for (const auto v : known) {
      if (v == rest) continue;
      offcuts.push_back({body.upkeep.pieces++, from, v, rest});
      for (const auto w : shells.inside(v.value)) of[w] = offcuts.back().piece;
    }
  }
  recounted = joined || (!offcuts.empty() && body.upkeep.inner_shells);
  if (recounted) count_pieces(body);
  return offcuts;
}

}  // namespace geo
