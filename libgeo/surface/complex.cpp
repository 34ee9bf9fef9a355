#include "kerf/complex.h"

#include <algorithm>
#include <string>

#include "kerf/error.h"
#include "surface/complex_internal.h"

namespace geo {

int Complex::edge_in(const Face& f, VertexId a, VertexId b) {
  const int k = corner_at(f, a);
  return f.v[(k + 1) % 3] == b ? k : (k + 2) % 3;
}

FaceId Complex::any_at(VertexId a, VertexId b) const {
  for (const FaceId f : faces_at(a))
    if (corner_at(face(f), b) >= 0) return f;
  return {};
}

FaceRing Complex::around(VertexId a, VertexId b) const {
  FaceRing ring;
  const FaceId first = any_at(a, b);
  if (!first.valid()) return ring;
  FaceId f = first;
  do {
    ring.push_back(f);
    f = next_around(f, a, b);
  } while (f != first);
  return ring;
}

void Complex::link_corners(FaceId f) {
  for (std::uint32_t k = 0; k < 3; ++k) {
    const std::uint32_t corner = f.value * 3 + k;
    std::uint32_t* at = &first_corner_[face(f).v[k].index()];
    while (*at != no_corner && *at < corner) at = &next_corner_[*at];
    next_corner_[corner] = *at;
    *at = corner;
  }
}

void Complex::unlink_corners(FaceId f) {
  for (std::uint32_t k = 0; k < 3; ++k) {
    const std::uint32_t corner = f.value * 3 + k;
    std::uint32_t* at = &first_corner_[face(f).v[k].index()];
    while (*at != corner) at = &next_corner_[*at];
    *at = next_corner_[corner];
  }
}

void Complex::link_ring(VertexId a, VertexId b, const FaceId* faces, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i)
    radial_[faces[i].index() * 3 + static_cast<std::size_t>(edge_in(face(faces[i]), a, b))] =
        faces[i + 1 == count ? 0 : i + 1];
}

void Complex::near(const Box3& box, std::vector<FaceId>& out) const {
  thread_local std::vector<std::uint32_t> ids;
  ids.clear();
  index_.find(box, ids);
  for (const auto id : ids) out.push_back(FaceId(id));
}

void Complex::near_triangle(const Vec3& a, const Vec3& b, const Vec3& c, double reach, std::vector<FaceId>& out) const {
  thread_local std::vector<std::uint32_t> ids;
  ids.clear();
  index_.find_near_triangle(a, b, c, reach, ids);
  for (const auto id : ids) out.push_back(FaceId(id));
}

Side Complex::neighbor(Side s, int k) const {
  const Face& f = face(s.face);
  const VertexId a = f.v[k], b = f.v[(k + 1) % 3];
  const FaceId after = radial_[s.face.index() * 3 + static_cast<std::size_t>(k)];
  if (faces_counterclockwise(f, s.which, a, b)) return {after, side_facing(face(after), a, b, false)};
  FaceId before = after;
  for (FaceId next = next_around(before, a, b); next != s.face; next = next_around(before, a, b)) before = next;
  return {before, side_facing(face(before), a, b, true)};
}

void Complex::surface_neighbors(SurfaceVertexId v, std::vector<SurfaceVertexId>& out) const {
  const std::size_t first = out.size();
  const VertexId site_of = site(v);
  std::vector<Side> stack{fan_side_[v.index()]}, seen = stack;
  while (!stack.empty()) {
    const Side s = stack.back();
    stack.pop_back();
    const int k = corner_at(face(s.face), site_of);
    out.push_back(surface_vertex(s, (k + 1) % 3));
    out.push_back(surface_vertex(s, (k + 2) % 3));
    for (const int edge : {k, (k + 2) % 3}) {
      const Side next = neighbor(s, edge);
      if (std::find(seen.begin(), seen.end(), next) == seen.end()) seen.push_back(next), stack.push_back(next);
    }
  }
  std::sort(out.begin() + static_cast<std::ptrdiff_t>(first), out.end());
  out.erase(std::unique(out.begin() + static_cast<std::ptrdiff_t>(first), out.end()), out.end());
  std::erase(out, v);  // a front may join a vertex to itself through its other sheet
}

TriangleMesh Complex::two_sided(std::vector<std::uint32_t>* rows) const {
  TriangleMesh mesh;
  std::vector<std::uint32_t> row(site_.size(), ~0u);
  for (std::uint32_t v = 0; v < site_.size(); ++v) {
    if (!site_[v].valid()) continue;
    row[v] = static_cast<std::uint32_t>(mesh.vertices.size());
    mesh.vertices.push_back(point(site_[v]));
    mesh.site.push_back(site_[v].value);
  }
  for (std::uint32_t f = 0; f < faces_.size(); ++f) {
    if (!faces_[f].alive) continue;
    for (int which = 0; which < (faces_[f].crack > 0 ? 2 : 1); ++which) {
      Triangle t;
      for (int k = 0; k < 3; ++k) t[k] = row[surface_vertex({FaceId(f), which}, k).index()];
      if (which == 1) std::swap(t[1], t[2]);
      mesh.triangles.push_back(t);
      mesh.patch.push_back(which == 0 ? faces_[f].crack : -faces_[f].crack);
      mesh.source.push_back(faces_[f].source);
    }
  }
  if (rows) *rows = std::move(row);
  return mesh;
}

CrackDelta Complex::apply(const ComplexEdit& edit) {
  const std::uint32_t old_faces = face_count(), old_vertices = vertex_count();
  const auto vertex_total = old_vertices + edit.new_vertices.size();

  // Everything is checked on the side first; K is touched only when nothing can fail any more.
  std::vector<FaceId> removed = edit.removed_faces;
  std::sort(removed.begin(), removed.end());
  if (std::adjacent_find(removed.begin(), removed.end()) != removed.end())
    throw GeometryError("a face is removed twice");
  for (const FaceId f : removed)
    if (f.value >= old_faces || !alive(f))
      throw GeometryError("face " + std::to_string(f.value) + " is not there to be removed");
  const auto is_removed = [&](FaceId f) { return std::binary_search(removed.begin(), removed.end(), f); };
  for (const auto& n : edit.new_faces) {
    for (const VertexId v : n.v)
      if (v.value >= vertex_total)
        throw GeometryError("a new face names vertex " + std::to_string(v.value) + ", which is not there");
    if (n.v[0] == n.v[1] || n.v[1] == n.v[2] || n.v[2] == n.v[0]) throw GeometryError("a new face has a vertex twice");
    if (n.crack < 0) throw GeometryError("a crack's number is negative");
  }
  const auto shape = [&](FaceId f) -> Face {
    if (f.value < old_faces) return face(f);
    const auto& n = edit.new_faces[f.value - old_faces];
    return {n.v, n.crack, true, ~0u};
  };

  // The faces that each touched edge will have: edges in order of their keys, each with the new faces it gains.
  struct Gain {
    std::uint64_t edge;
    FaceId face;  // invalid: loses one only
  };
  std::vector<Gain> gains;
  gains.reserve(3 * (removed.size() + edit.new_faces.size()));
  for (const FaceId f : removed)
    for (int k = 0; k < 3; ++k) gains.push_back({key(face(f).v[k], face(f).v[(k + 1) % 3]), FaceId()});
  for (std::uint32_t i = 0; i < edit.new_faces.size(); ++i)
    for (int k = 0; k < 3; ++k)
      gains.push_back({key(edit.new_faces[i].v[k], edit.new_faces[i].v[(k + 1) % 3]), FaceId(old_faces + i)});
  std::sort(gains.begin(), gains.end(),
            [](const Gain& x, const Gain& y) { return x.edge != y.edge ? x.edge < y.edge : x.face < y.face; });
  std::vector<std::pair<std::uint64_t, const ComplexEdit::Ring*>> given;
  for (const auto& ring : edit.rings) given.push_back({key(ring.a, ring.b), &ring});
  std::sort(given.begin(), given.end(), [](const auto& x, const auto& y) { return x.first < y.first; });

  struct NewRing {
    std::uint64_t edge;
    std::uint32_t begin, end;
  };
  std::vector<NewRing> rings;
  std::vector<FaceId> ring_faces, fresh, ring, wanted, sorted_wanted;
  rings.reserve(gains.size()), ring_faces.reserve(2 * gains.size());
  auto order = given.begin();
  for (std::size_t at = 0; at < gains.size();) {
    const std::uint64_t edge = gains[at].edge;
    const VertexId lo(static_cast<std::uint32_t>(edge >> 32)), hi(static_cast<std::uint32_t>(edge));
    fresh.clear(), ring.clear();
    for (; at < gains.size() && gains[at].edge == edge; ++at)
      if (gains[at].face.valid()) fresh.push_back(gains[at].face);
    // A part of a face takes the face's place in the order.
    if (hi.value < old_vertices)
      for (const FaceId f : around(lo, hi)) {
        if (!is_removed(f)) {
          ring.push_back(f);
          continue;
        }
        const auto heir = std::find_if(fresh.begin(), fresh.end(),
                                       [&](FaceId n) { return edit.new_faces[n.value - old_faces].parent == f; });
        if (heir == fresh.end()) continue;
        ring.push_back(*heir);
        fresh.erase(heir);
      }
    ring.insert(ring.end(), fresh.begin(), fresh.end());
    while (order != given.end() && order->first < edge)
      ++order;  // an order for an edge that nothing touched says nothing new
    if (order != given.end() && order->first == edge) {
      wanted = order->second->faces;
      if (order->second->a > order->second->b) std::reverse(wanted.begin(), wanted.end());
      sorted_wanted = wanted;
      std::sort(sorted_wanted.begin(), sorted_wanted.end());
      std::sort(ring.begin(), ring.end());
      if (sorted_wanted != ring)
        throw GeometryError("the order given for edge " + edge_name(lo, hi) + " does not list its faces");
      ring = wanted;
    } else if (!fresh.empty() && ring.size() >= 3) {
      throw GeometryError("no order is given for edge " + edge_name(lo, hi) + ", which has " +
                          std::to_string(ring.size()) + " faces");
    }
    check_ring(ring, lo, hi, shape);
    const auto begin = static_cast<std::uint32_t>(ring_faces.size());
    ring_faces.insert(ring_faces.end(), ring.begin(), ring.end());
    rings.push_back({edge, begin, static_cast<std::uint32_t>(ring_faces.size())});
  }

  // Commit.
  undo_ = {true, old_vertices, old_faces, surface_vertex_count(), crack_count_, removed, {}, {}, {}};
  CrackDelta delta;
  delta.removed_faces = removed;
  points_.insert(points_.end(), edit.new_vertices.begin(), edit.new_vertices.end());
  first_corner_.resize(points_.size(), no_corner);
  for (std::uint32_t i = 0; i < edit.new_vertices.size(); ++i) delta.new_vertices.push_back(VertexId(old_vertices + i));

  std::vector<VertexId> touched;
  ++epoch_;
  mark_.resize(points_.size(), 0);
  const auto touch = [&](VertexId v) {
    if (mark_[v.index()] != epoch_) mark_[v.index()] = epoch_, touched.push_back(v);
  };
  std::vector<std::pair<VertexId, SurfaceVertexId>> old_ids;  // what stood at each touched site before
  for (const FaceId f : removed) {
    for (int k = 0; k < 3; ++k) {
      touch(face(f).v[k]);
      for (int which = 0; which < (face(f).crack > 0 ? 2 : 1); ++which)
        old_ids.push_back({face(f).v[k], corner_vertex_[f.index() * 6 + which * 3 + k]});
    }
    index_.erase(f.value);
    faces_[f.index()].alive = false;
    unlink_corners(f);
    --live_faces_;
  }
  const std::size_t total = old_faces + edit.new_faces.size();
  faces_.reserve(std::max(total, faces_.capacity() < total ? 2 * faces_.size() : total));
  radial_.resize(3 * total);
  next_corner_.resize(3 * total, no_corner);
  corner_vertex_.resize(6 * total);
  for (std::uint32_t i = 0; i < edit.new_faces.size(); ++i) {
    const auto& n = edit.new_faces[i];
    const FaceId f(old_faces + i);
    faces_.push_back(
        {n.v, n.crack, true, n.parent.valid() && n.parent.value < old_faces ? face(n.parent).source : ~0u});
    link_corners(f);
    for (int k = 0; k < 3; ++k) {
      touch(n.v[k]);
      // A part of a face keeps the face's surface vertices where it keeps its corners.
      if (n.parent.valid() && n.parent.value < old_faces)
        if (const int pk = corner_at(face(n.parent), n.v[k]); pk >= 0)
          for (int which = 0; which < 2; ++which)
            corner_vertex_[f.index() * 6 + which * 3 + k] = corner_vertex_[n.parent.index() * 6 + which * 3 + pk];
    }
    const auto c = corners(f);
    index_.insert(f.value, box_of(c[0], c[1], c[2]));
    crack_count_ = std::max(crack_count_, n.crack);
    delta.new_faces.push_back(f);
    if (n.crack > 0 && !n.parent.valid()) delta.new_crack_faces.push_back(f);
    ++live_faces_;
  }
  for (const NewRing& r : rings) {
    const VertexId lo(static_cast<std::uint32_t>(r.edge >> 32)), hi(static_cast<std::uint32_t>(r.edge));
    for (auto i = r.begin; i < r.end; ++i)
      if (const FaceId f = ring_faces[i]; f.value < old_faces) {
        const auto at = f.index() * 3 + static_cast<std::size_t>(edge_in(face(f), lo, hi));
        undo_.radial.push_back({at, radial_[at]});
      }
    link_ring(lo, hi, ring_faces.data() + r.begin, r.end - r.begin);
  }
  std::sort(touched.begin(), touched.end());
  std::sort(old_ids.begin(), old_ids.end());
  std::size_t at = 0;
  std::vector<SurfaceVertexId> here;
  FanScratch scratch;
  for (const VertexId v : touched) {
    here.clear();
    for (; at < old_ids.size() && old_ids[at].first == v; ++at) here.push_back(old_ids[at].second);
    remember(v, here);
    refan(v, here, &delta, scratch);
  }
  std::sort(delta.touched_surface_vertices.begin(), delta.touched_surface_vertices.end());
  std::sort(delta.removed_surface_vertices.begin(), delta.removed_surface_vertices.end());
  return delta;
}

void Complex::remember(VertexId v, const std::vector<SurfaceVertexId>& gone) {
  const auto keep = [&](SurfaceVertexId id) {
    if (undo_.stands.empty() || undo_.stands.back().v != id)
      undo_.stands.push_back({id, site(id), fan_side_[id.index()], fan_corner_[id.index()]});
  };
  for (const FaceId f : faces_at(v)) {
    if (f.value >= undo_.faces) break;
    for (std::size_t which = 0; which < (face(f).crack > 0 ? 2 : 1); ++which) {
      const auto at = f.index() * 6 + which * 3 + static_cast<std::size_t>(corner_at(face(f), v));
      undo_.corners.push_back({at, corner_vertex_[at]});
      keep(corner_vertex_[at]);
    }
  }
  for (const auto id : gone) keep(id);
}

void Complex::take_back() {
  if (!undo_.possible) throw GeometryError("there is no edit to take back");
  for (std::uint32_t f = undo_.faces; f < faces_.size(); ++f) {
    index_.erase(f);
    unlink_corners(FaceId(f));
    --live_faces_;
  }
  points_.resize(undo_.vertices), first_corner_.resize(undo_.vertices), mark_.resize(undo_.vertices);
  faces_.resize(undo_.faces), radial_.resize(std::size_t(3) * undo_.faces),
      next_corner_.resize(std::size_t(3) * undo_.faces);
  corner_vertex_.resize(std::size_t(6) * undo_.faces);
  site_.resize(undo_.surface_vertices), fan_side_.resize(undo_.surface_vertices),
      fan_corner_.resize(undo_.surface_vertices);
  for (const FaceId f : undo_.removed) {
    faces_[f.index()].alive = true;
    link_corners(f);
    const auto c = corners(f);
    index_.insert(f.value, box_of(c[0], c[1], c[2]));
    ++live_faces_;
  }
  for (const auto& [at, next] : undo_.radial) radial_[at] = next;
  for (const auto& [at, id] : undo_.corners) corner_vertex_[at] = id;
  for (const auto& s : undo_.stands)
    site_[s.v.index()] = s.site, fan_side_[s.v.index()] = s.side, fan_corner_[s.v.index()] = s.corner;
  crack_count_ = undo_.cracks;
  undo_ = {};
}

// Groups the sides at v into fans and gives each a surface vertex: one of those it had before where it can.
void Complex::refan(VertexId v, std::vector<SurfaceVertexId>& old_ids, CrackDelta* delta, FanScratch& scratch) {
  auto& corners = scratch.corners;
  auto& candidates = scratch.candidates;
  auto& fans = scratch.fans;
  auto& claimed = scratch.claimed;
  corners.clear(), candidates.clear(), fans.clear(), claimed.clear();
  // Each side at v has a next one across either of its edges there, so that fans are rings.
  for (const FaceId f : faces_at(v))
    for (int which = 0; which < (face(f).crack > 0 ? 2 : 1); ++which) {
      const Side start{f, which};
      if (std::any_of(corners.begin(), corners.end(), [&](const auto& c) { return c.first == start; })) continue;
      Fan fan{start, 0, corners.size(), 0, candidates.size(), 0};
      Side s = start;
      for (int edge = corner_at(face(f), v), k = edge;;) {
        corners.push_back({s, k});
        if (s <= fan.lowest) fan.lowest = s, fan.corner = k;
        if (const auto old = surface_vertex(s, k);
            old.valid() && (candidates.size() == fan.first_candidate || candidates.back() != old))
          candidates.push_back(old);
        const VertexId far = face(s.face).v[edge == k ? (k + 1) % 3 : edge];
        s = neighbor(s, edge);
        if (s == start) break;
        k = corner_at(face(s.face), v);
        edge = face(s.face).v[(k + 1) % 3] == far ? (k + 2) % 3 : k;  // out by the edge that it was not entered by
      }
      const auto first = candidates.begin() + static_cast<std::ptrdiff_t>(fan.first_candidate);
      std::sort(first, candidates.end());
      candidates.erase(std::unique(first, candidates.end()), candidates.end());
      old_ids.insert(old_ids.end(), candidates.begin() + static_cast<std::ptrdiff_t>(fan.first_candidate),
                     candidates.end());
      fan.end_corner = corners.size(), fan.end_candidate = candidates.size();
      fans.push_back(fan);
    }
  // Fans with the lowest old ids choose first, so that the outcome does not depend on face order alone.
  std::sort(fans.begin(), fans.end(), [&](const Fan& a, const Fan& b) {
    const auto ca = a.first_candidate == a.end_candidate ? SurfaceVertexId() : candidates[a.first_candidate];
    const auto cb = b.first_candidate == b.end_candidate ? SurfaceVertexId() : candidates[b.first_candidate];
    return ca != cb ? ca < cb : a.lowest < b.lowest;
  });
  for (const Fan& fan : fans) {
    SurfaceVertexId id;
    for (auto c = fan.first_candidate; c < fan.end_candidate && !id.valid(); ++c)
      if (std::find(claimed.begin(), claimed.end(), candidates[c]) == claimed.end()) id = candidates[c];
    const bool fresh = !id.valid();
    if (fresh) {
      id = SurfaceVertexId(site_.size());
      site_.push_back(v);
      fan_side_.emplace_back();
      fan_corner_.push_back(0);
    }
    claimed.push_back(id);
    site_[id.index()] = v;
    fan_side_[id.index()] = fan.lowest;
    fan_corner_[id.index()] = static_cast<std::uint8_t>(fan.corner);
    for (auto c = fan.first_corner; c < fan.end_corner; ++c) {
      const auto& [s, k] = corners[c];
      corner_vertex_[s.face.index() * 6 + s.which * 3 + k] = id;
    }
    if (!delta) continue;
    if (fresh) {
      delta->new_surface_vertices.push_back(id);
      delta->copied_from.push_back(fan.first_candidate == fan.end_candidate ? SurfaceVertexId()
                                                                            : candidates[fan.first_candidate]);
    } else {
      delta->touched_surface_vertices.push_back(id);
    }
  }
  std::sort(old_ids.begin(), old_ids.end());
  old_ids.erase(std::unique(old_ids.begin(), old_ids.end()), old_ids.end());
  for (const auto id : old_ids)
    if (std::find(claimed.begin(), claimed.end(), id) == claimed.end()) {
      site_[id.index()] = VertexId();
      if (delta) delta->removed_surface_vertices.push_back(id);
    }
}

}  // namespace geo
