// Complex of kerf/complex.h: storage and queries. Corners at a vertex form a linked list in
// ascending order; radial_ links the faces around an edge in a cycle. The neighbour of a side on
// S_A is the next or previous face there: the other face of the same wedge, seen from that wedge.
#include "kerf/complex.h"

#include <algorithm>

#include "surface/complex_impl.h"
#include "surface/radial_edge.h"

namespace geo {

Complex::Complex() : impl_(Indirect<Impl>::of({})) {}

const Box3& Complex::box(FaceId f) const { return impl_->index.box(f.value); }

// The k for which ab is the edge from the face's k-th vertex to the next; the face has edge ab.
int Complex::edge_in(const Face& f, VertexId a, VertexId b) {
  const int k = corner_at(f, a);
  return f.v[(k + 1) % 3] == b ? k : (k + 2) % 3;
}

FaceId Complex::any_face_at(VertexId a, VertexId b) const {
  for (const FaceId f : faces_at(a))
    if (corner_at(face(f), b) >= 0) return f;
  return {};
}

RadialCycle Complex::faces_around(VertexId a, VertexId b) const {
  RadialCycle cycle;
  const FaceId first = any_face_at(a, b);
  if (!first.valid()) return cycle;
  FaceId f = first;
  do {
    cycle.push_back(f);
    f = next_around(f, a, b);
  } while (f != first);
  return cycle;
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

void Complex::link_radial_cycle(VertexId a, VertexId b, const FaceId* faces, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i)
    radial_[faces[i].index() * 3 + static_cast<std::size_t>(edge_in(face(faces[i]), a, b))] =
        faces[i + 1 == count ? 0 : i + 1];
}

void Complex::faces_near(const Box3& box, std::vector<FaceId>& out) const {
  thread_local std::vector<std::uint32_t> ids;
  ids.clear();
  impl_->index.find(box, ids);
  for (const auto id : ids) out.push_back(FaceId(id));
}

void Complex::faces_near_triangle(const Vec3& a, const Vec3& b, const Vec3& c, double reach,
                                  std::vector<FaceId>& out) const {
  thread_local std::vector<std::uint32_t> ids;
  ids.clear();
  impl_->index.find_near_triangle(a, b, c, reach, ids);
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
      if (std::find(seen.begin(), seen.end(), next) == seen.end()) {
        seen.push_back(next);
        stack.push_back(next);
      }
    }
  }
  std::sort(out.begin() + static_cast<std::ptrdiff_t>(first), out.end());
  out.erase(std::unique(out.begin() + static_cast<std::ptrdiff_t>(first), out.end()), out.end());
  std::erase(out, v);  // a front may join a vertex to itself through its other sheet
}

TriangleMesh Complex::two_sided(std::vector<std::uint32_t>* vertex_index) const {
  TriangleMesh mesh;
  std::vector<std::uint32_t> index(site_.size(), ~0u);
  for (std::uint32_t v = 0; v < site_.size(); ++v) {
    if (!site_[v].valid()) continue;
    index[v] = static_cast<std::uint32_t>(mesh.vertices.size());
    mesh.vertices.push_back(point(site_[v]));
    mesh.site.push_back(site_[v].value);
  }
  for (std::uint32_t f = 0; f < faces_.size(); ++f) {
    if (!faces_[f].alive) continue;
    for (int which = 0; which < side_count(faces_[f]); ++which) {
      Triangle t;
      for (int k = 0; k < 3; ++k) t[k] = index[surface_vertex({FaceId(f), which}, k).index()];
      if (which == 1) std::swap(t[1], t[2]);
      mesh.triangles.push_back(t);
      mesh.patch.push_back(which == 0 ? faces_[f].crack : -faces_[f].crack);
      mesh.source.push_back(faces_[f].source);
    }
  }
  if (vertex_index) *vertex_index = std::move(index);
  return mesh;
}

}  // namespace geo
