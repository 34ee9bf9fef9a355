#include "surface/complex.h"

#include <algorithm>
#include <map>
#include <set>
#include <string>

#include "base/error.h"
#include "surface/complex_internal.h"

namespace geo {

std::array<Vec3, 3> Complex::corners(FaceId f) const {
  const auto& v = face(f).v;
  return {point(v[0]), point(v[1]), point(v[2])};
}

Box3 Complex::box(FaceId f) const {
  const auto& v = face(f).v;
  return box_of(point(v[0]), point(v[1]), point(v[2]));
}

std::span<const FaceId> Complex::around(VertexId a, VertexId b) const {
  const auto it = edges_.find(key(a, b));
  return it == edges_.end() ? std::span<const FaceId>() : std::span<const FaceId>(it->second);
}

void Complex::near(const Box3& box, std::vector<FaceId>& out) const {
  std::vector<std::uint32_t> ids;
  index_.find(box, ids);
  out.reserve(out.size() + ids.size());
  for (const auto id : ids) out.push_back(FaceId(id));
}

Side Complex::neighbor(Side s, int k) const {
  const Face& f = face(s.face);
  const VertexId a = f.v[k], b = f.v[(k + 1) % 3];
  const auto ring = around(a, b);
  const std::size_t n = ring.size();
  const auto at = static_cast<std::size_t>(std::find(ring.begin(), ring.end(), s.face) - ring.begin());
  if (faces_counterclockwise(f, s.which, a, b)) {
    const FaceId g = ring[at + 1 == n ? 0 : at + 1];
    return {g, side_facing(face(g), a, b, false)};
  }
  const FaceId g = ring[at == 0 ? n - 1 : at - 1];
  return {g, side_facing(face(g), a, b, true)};
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
  if (std::adjacent_find(removed.begin(), removed.end()) != removed.end()) throw GeometryError("a face is removed twice");
  for (const FaceId f : removed)
    if (f.value >= old_faces || !alive(f)) throw GeometryError("face " + std::to_string(f.value) + " is not there to be removed");
  const auto is_removed = [&](FaceId f) { return std::binary_search(removed.begin(), removed.end(), f); };
  for (const auto& n : edit.new_faces) {
    for (const VertexId v : n.v)
      if (v.value >= vertex_total) throw GeometryError("a new face names vertex " + std::to_string(v.value) + ", which is not there");
    if (n.v[0] == n.v[1] || n.v[1] == n.v[2] || n.v[2] == n.v[0]) throw GeometryError("a new face has a vertex twice");
    if (n.crack < 0) throw GeometryError("a crack's number is negative");
  }
  const auto shape = [&](FaceId f) -> Face {
    if (f.value < old_faces) return face(f);
    const auto& n = edit.new_faces[f.value - old_faces];
    return {n.v, n.crack, true};
  };

  // The faces that each touched edge will have, unordered as yet.
  std::map<std::uint64_t, std::vector<FaceId>> rings;
  const auto touch = [&](VertexId a, VertexId b) -> std::vector<FaceId>& {
    const auto [it, fresh] = rings.try_emplace(key(a, b));
    if (fresh)
      for (const FaceId f : around(a, b)) it->second.push_back(f);
    return it->second;
  };
  for (const FaceId f : removed)
    for (int k = 0; k < 3; ++k) touch(face(f).v[k], face(f).v[(k + 1) % 3]);
  std::map<std::uint64_t, std::vector<FaceId>> gained;
  for (std::uint32_t i = 0; i < edit.new_faces.size(); ++i)
    for (int k = 0; k < 3; ++k) {
      const VertexId a = edit.new_faces[i].v[k], b = edit.new_faces[i].v[(k + 1) % 3];
      touch(a, b);
      gained[key(a, b)].push_back(FaceId(old_faces + i));
    }
  for (auto& [edge, ring] : rings) {
    auto& fresh = gained[edge];
    // A part of a face takes the face's place in the order.
    for (auto& f : ring) {
      if (!is_removed(f)) continue;
      const auto heir = std::find_if(fresh.begin(), fresh.end(), [&](FaceId n) { return edit.new_faces[n.value - old_faces].parent == f; });
      if (heir != fresh.end()) {
        f = *heir;
        fresh.erase(heir);
      } else {
        f = FaceId();
      }
    }
    std::erase(ring, FaceId());
    if (!fresh.empty()) {
      ring.insert(ring.end(), fresh.begin(), fresh.end());
      if (ring.size() >= 3) fresh.front() = FaceId();  // marks an order that has to be given
    }
  }
  for (const auto& given : edit.rings) {
    const auto it = rings.find(key(given.a, given.b));
    if (it == rings.end()) {
      // An order for an edge that nothing touched may only confirm what is there.
      continue;
    }
    auto wanted = given.faces;
    if (given.a > given.b) std::reverse(wanted.begin(), wanted.end());
    auto sorted_wanted = wanted, sorted_ring = it->second;
    std::sort(sorted_wanted.begin(), sorted_wanted.end());
    std::sort(sorted_ring.begin(), sorted_ring.end());
    if (sorted_wanted != sorted_ring)
      throw GeometryError("the order given for edge " + edge_name(given.a, given.b) + " does not list its faces");
    it->second = std::move(wanted);
    gained[it->first].clear();
  }
  for (const auto& [edge, ring] : rings) {
    const VertexId lo(static_cast<std::uint32_t>(edge >> 32)), hi(static_cast<std::uint32_t>(edge));
    const auto& fresh = gained[edge];
    if (!fresh.empty() && !fresh.front().valid())
      throw GeometryError("no order is given for edge " + edge_name(lo, hi) + ", which has " + std::to_string(ring.size()) + " faces");
    check_ring(ring, lo, hi, shape);
  }

  // Commit.
  CrackDelta delta;
  delta.removed_faces = removed;
  points_.insert(points_.end(), edit.new_vertices.begin(), edit.new_vertices.end());
  vertex_faces_.resize(points_.size());
  for (std::uint32_t i = 0; i < edit.new_vertices.size(); ++i) delta.new_vertices.push_back(VertexId(old_vertices + i));

  std::set<VertexId> touched;
  std::map<VertexId, std::vector<SurfaceVertexId>> old_ids;  // what stood at each touched site before
  const auto remember = [&](FaceId f) {
    for (int k = 0; k < 3; ++k) touched.insert(face(f).v[k]);
  };
  for (const FaceId f : removed) remember(f);
  std::vector<Face> dead;
  for (const FaceId f : removed) {
    index_.erase(f.value);
    faces_[f.index()].alive = false;
    for (const VertexId v : face(f).v) std::erase(vertex_faces_[v.index()], f);
    --live_faces_;
  }
  for (std::uint32_t i = 0; i < edit.new_faces.size(); ++i) {
    const auto& n = edit.new_faces[i];
    const FaceId f(old_faces + i);
    faces_.push_back({n.v, n.crack, true});
    corner_vertex_.resize(corner_vertex_.size() + 6);
    for (int k = 0; k < 3; ++k) {
      touched.insert(n.v[k]);
      auto& at = vertex_faces_[n.v[k].index()];
      at.insert(std::upper_bound(at.begin(), at.end(), f), f);
      // A part of a face keeps the face's surface vertices where it keeps its corners.
      if (n.parent.valid() && n.parent.value < old_faces)
        if (const int pk = corner_at(face(n.parent), n.v[k]); pk >= 0)
          for (int which = 0; which < 2; ++which)
            corner_vertex_[f.index() * 6 + which * 3 + k] = corner_vertex_[n.parent.index() * 6 + which * 3 + pk];
    }
    index_.insert(f.value, box(f));
    crack_count_ = std::max(crack_count_, n.crack);
    delta.new_faces.push_back(f);
    if (n.crack > 0 && !n.parent.valid()) delta.new_crack_faces.push_back(f);
    ++live_faces_;
  }
  for (auto& [edge, ring] : rings) {
    // Vertices at the far ends of re-sorted edges are corners of touched faces already; edges without faces go.
    if (ring.empty())
      edges_.erase(edge);
    else
      edges_[edge] = std::move(ring);
  }
  for (const FaceId f : removed)
    for (int k = 0; k < 3; ++k)
      for (int which = 0; which < (face(f).crack > 0 ? 2 : 1); ++which) {
        auto& ids = old_ids[face(f).v[k]];
        ids.push_back(corner_vertex_[f.index() * 6 + which * 3 + k]);
      }
  for (const VertexId v : touched) refan(v, old_ids[v], &delta);
  std::sort(delta.touched_surface_vertices.begin(), delta.touched_surface_vertices.end());
  std::sort(delta.removed_surface_vertices.begin(), delta.removed_surface_vertices.end());
  return delta;
}

void Complex::refan(VertexId v, std::vector<SurfaceVertexId> old_ids, CrackDelta* delta) {
  struct Fan {
    std::vector<std::pair<Side, int>> corners;
    std::vector<SurfaceVertexId> candidates;
  };
  std::vector<Fan> fans;
  std::vector<Side> seen;
  for (const FaceId f : faces_at(v))
    for (int which = 0; which < (face(f).crack > 0 ? 2 : 1); ++which) {
      const Side start{f, which};
      if (std::find(seen.begin(), seen.end(), start) != seen.end()) continue;
      Fan fan;
      std::vector<Side> stack{start};
      seen.push_back(start);
      while (!stack.empty()) {
        const Side s = stack.back();
        stack.pop_back();
        const int k = corner_at(face(s.face), v);
        fan.corners.push_back({s, k});
        if (const auto old = surface_vertex(s, k); old.valid()) fan.candidates.push_back(old), old_ids.push_back(old);
        for (const int edge : {k, (k + 2) % 3}) {
          const Side next = neighbor(s, edge);
          if (std::find(seen.begin(), seen.end(), next) == seen.end()) seen.push_back(next), stack.push_back(next);
        }
      }
      std::sort(fan.corners.begin(), fan.corners.end());
      std::sort(fan.candidates.begin(), fan.candidates.end());
      fans.push_back(std::move(fan));
    }
  // Fans with the lowest old ids choose first, so that the outcome does not depend on face order alone.
  std::sort(fans.begin(), fans.end(), [](const Fan& a, const Fan& b) {
    const auto ca = a.candidates.empty() ? SurfaceVertexId() : a.candidates.front();
    const auto cb = b.candidates.empty() ? SurfaceVertexId() : b.candidates.front();
    return ca != cb ? ca < cb : a.corners.front() < b.corners.front();
  });
  std::vector<SurfaceVertexId> claimed;
  for (const Fan& fan : fans) {
    SurfaceVertexId id;
    for (const auto c : fan.candidates)
      if (std::find(claimed.begin(), claimed.end(), c) == claimed.end()) {
        id = c;
        break;
      }
    const bool fresh = !id.valid();
    if (fresh) {
      id = SurfaceVertexId(site_.size());
      site_.push_back(v);
      fan_side_.emplace_back();
      fan_corner_.push_back(0);
    }
    claimed.push_back(id);
    site_[id.index()] = v;
    fan_side_[id.index()] = fan.corners.front().first;
    fan_corner_[id.index()] = static_cast<std::uint8_t>(fan.corners.front().second);
    for (const auto& [s, k] : fan.corners) corner_vertex_[s.face.index() * 6 + s.which * 3 + k] = id;
    if (!delta) continue;
    if (fresh) {
      delta->new_surface_vertices.push_back(id);
      delta->copied_from.push_back(fan.candidates.empty() ? SurfaceVertexId() : fan.candidates.front());
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
