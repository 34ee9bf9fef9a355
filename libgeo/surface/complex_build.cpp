// Making a crack complex from a skin or from a two-sided surface, and the edit between two complexes.
#include <algorithm>
#include <cmath>
#include <map>
#include <unordered_map>

#include "geometry/distance.h"
#include "geometry/predicates.h"
#include "kerf/complex.h"
#include "kerf/error.h"
#include "surface/complex_internal.h"

namespace geo {
namespace {

// Numbers of new cracks follow the largest one in use.
constexpr std::int64_t largest_crack = 1000000000;

void require_rows(const TriangleMesh& mesh) {
  if (mesh.triangles.empty()) throw InputError("the surface has no triangles; give a closed triangle mesh");
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto& [a, b, c] = mesh.triangles[t];
    for (const auto v : mesh.triangles[t])
      if (v >= mesh.vertices.size())
        throw InputError("triangle " + std::to_string(t) + " names vertex " + std::to_string(v) + ", but there are " +
                         std::to_string(mesh.vertices.size()));
    if (a == b || b == c || c == a)
      throw InputError("triangle " + std::to_string(t) + " is degenerate (a vertex twice); remove or repair it");
  }
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v)
    if (!in_range(mesh.vertices[v]))
      throw InputError("vertex " + std::to_string(v) +
                       " has a coordinate that is not a finite number of sensible size; repair the file");
}

std::array<std::uint32_t, 3> sorted(std::array<VertexId, 3> v) {
  std::sort(v.begin(), v.end());
  return {v[0].value, v[1].value, v[2].value};
}

// Orientation of a triple relative to its sorted order: true for an even permutation.
bool even(const std::array<VertexId, 3>& v) { return (v[0] < v[1]) != ((v[0] < v[2]) != (v[1] < v[2])); }

}  // namespace

/// Fills a complex's private parts; the two makers share it.
class ComplexBuilder {
 public:
  Complex k;

  void add_points(const std::vector<Vec3>& points) {
    k.points_ = points;
    k.first_corner_.assign(points.size(), Complex::no_corner);
    k.mark_.assign(points.size(), 0);
  }

  FaceId add_face(std::array<VertexId, 3> v, std::int32_t crack, std::uint32_t source) {
    const FaceId f(k.faces_.size());
    k.faces_.push_back({v, crack, true, source});
    k.corner_vertex_.resize(k.corner_vertex_.size() + 6);
    k.crack_count_ = std::max(k.crack_count_, crack);
    ++k.live_faces_;
    return f;
  }

  /// Corners by vertex and faces by edge, once all faces are there; rings in ascending order as yet.
  void link() {
    k.radial_.resize(3 * k.faces_.size());
    k.next_corner_.assign(3 * k.faces_.size(), Complex::no_corner);
    for (std::uint32_t f = k.face_count(); f-- > 0;)
      for (std::uint32_t c = 0; c < 3; ++c) {
        auto& first = k.first_corner_[k.face(FaceId(f)).v[c].index()];
        k.next_corner_[3 * f + c] = first;
        first = 3 * f + c;
      }
    std::vector<std::pair<VertexId, FaceId>> at;
    std::vector<FaceId> ring;
    for (std::uint32_t v = 0; v < k.points_.size(); ++v) {
      at.clear();
      for (const FaceId f : k.faces_at(VertexId(v)))
        for (const VertexId w : k.face(f).v)
          if (w.value > v) at.push_back({w, f});
      std::sort(at.begin(), at.end());
      for (std::size_t i = 0; i < at.size();) {
        ring.clear();
        const VertexId w = at[i].first;
        for (; i < at.size() && at[i].first == w; ++i) ring.push_back(at[i].second);
        k.link_ring(VertexId(v), w, ring.data(), ring.size());
      }
    }
  }

  void finish() {
    for (const auto& f : k.faces_)
      for (const VertexId v : f.v)
        if (f.crack == 0) k.extent_.add(k.point(v));
    if (k.extent_.empty()) throw InputError("the surface has cracks but no skin");
    if (!(k.extent_.diagonal() * largest_coordinate > 1))
      throw InputError("the surface has no extent: its points are at one place or nearly so; scale it up");
    for (std::uint32_t f = 0; f < k.faces_.size(); ++f) {
      const auto c = k.corners(FaceId(f));
      k.index_.insert(f, box_of(c[0], c[1], c[2]));
    }
  }

  /// Room for the first cracks, so that they do not copy everything to a larger place.
  void make_room() {
    const auto more = [](auto& v, std::size_t each) { v.reserve(v.size() + v.size() / 4 + 4096 * each); };
    more(k.points_, 1), more(k.mark_, 1), more(k.first_corner_, 1), more(k.site_, 1), more(k.fan_side_, 1),
        more(k.fan_corner_, 1);
    more(k.faces_, 1), more(k.radial_, 3), more(k.next_corner_, 3), more(k.corner_vertex_, 6);
    k.index_.reserve(k.faces_.capacity());
  }

  void fan_all() {
    std::vector<SurfaceVertexId> none;
    Complex::FanScratch scratch;
    for (std::uint32_t v = 0; v < k.points_.size(); ++v) {
      none.clear();
      if (!k.faces_at(VertexId(v)).empty()) k.refan(VertexId(v), none, nullptr, scratch);
    }
  }

  void set_corner(Side s, int corner, std::uint32_t row) {
    k.corner_vertex_[s.face.index() * 6 + s.which * 3 + corner] = SurfaceVertexId(row);
  }

  void order_edges(const TriangleMesh& mesh);
  void adopt_rows(const TriangleMesh& mesh);

 private:
  void order_ring(VertexId lo, VertexId hi, std::vector<FaceId>& ring);
  VertexId apex(FaceId f, VertexId lo, VertexId hi) const {
    for (const VertexId v : k.face(f).v)
      if (v != lo && v != hi) return v;
    return {};
  }
};

Complex Complex::from_skin(const TriangleMesh& skin) {
  require_rows(skin);
  ComplexBuilder builder;
  builder.add_points(skin.vertices);
  for (std::uint32_t row = 0; row < skin.triangles.size(); ++row) {
    const auto& t = skin.triangles[row];
    builder.add_face({VertexId(t[0]), VertexId(t[1]), VertexId(t[2])}, 0, row);
  }
  builder.link();
  // In row order, so that the first problem named is the same every time.
  for (std::uint32_t f = 0; f < builder.k.face_count(); ++f)
    for (int k = 0; k < 3; ++k) {
      const VertexId a = builder.k.face(FaceId(f)).v[k], b = builder.k.face(FaceId(f)).v[(k + 1) % 3];
      const auto ring = builder.k.around(a, b);
      if (ring.size() == 1)
        throw InputError("the surface is open: edge " + edge_name(a, b) +
                         " has one triangle only; close the holes first");
      if (ring.size() > 2)
        throw InputError("the surface is not manifold: edge " + edge_name(a, b) + " has " +
                         std::to_string(ring.size()) + " triangles; separate the parts that touch there");
      if (runs_upwards(builder.k.face(ring[0]), a, b) == runs_upwards(builder.k.face(ring[1]), a, b))
        throw InputError("triangles " + std::to_string(ring[0].value) + " and " + std::to_string(ring[1].value) +
                         " have opposite orientations; orient the surface consistently");
    }
  if (signed_volume(skin) <= 0)
    throw InputError("the surface is inside out (volume " + std::to_string(signed_volume(skin)) +
                     "); reverse its triangles");
  builder.finish();
  builder.fan_all();
  builder.make_room();
  return std::move(builder.k);
}

void ComplexBuilder::order_ring(VertexId lo, VertexId hi, std::vector<FaceId>& ring) {
  // Which side shares which derived edge. Two sides there bound one wedge; more than two (both ends of the edge lie on
  // one front) leave the choice to geometry.
  std::map<std::array<SurfaceVertexId, 2>, std::vector<std::pair<FaceId, bool>>> derived;  // face, looks ccw
  for (const FaceId f : ring)
    for (int which = 0; which < (k.face(f).crack > 0 ? 2 : 1); ++which) {
      const auto a = k.surface_vertex({f, which}, corner_at(k.face(f), lo)),
                 b = k.surface_vertex({f, which}, corner_at(k.face(f), hi));
      derived[{a, b}].push_back({f, faces_counterclockwise(k.face(f), which, lo, hi)});
    }
  const VertexId zero = apex(ring[0], lo, hi);
  const auto by_angle = [&](FaceId a, FaceId b) {
    const VertexId pa = apex(a, lo, hi), pb = apex(b, lo, hi);
    if (pa == zero || pb == zero) return pa == zero && pb != zero;
    const int c = compare_angle(k.point(lo), k.point(hi), k.point(zero), k.point(pa), k.point(pb));
    return c != 0 ? c < 0 : a < b;
  };
  std::map<FaceId, FaceId> next, previous;
  for (auto& [edge, sides] : derived) {
    if (sides.size() % 2 != 0)
      throw InputError("the surface is open: an edge between sites " + edge_name(lo, hi) + " has one triangle only");
    if (sides.size() > 2) continue;
    if (sides[0].second == sides[1].second)
      throw InputError("two triangles at the edge between sites " + edge_name(lo, hi) + " have opposite orientations");
    const FaceId from = sides[0].second ? sides[0].first : sides[1].first,
                 to = sides[0].second ? sides[1].first : sides[0].first;
    next[from] = to;
    previous[to] = from;
  }
  // Chains of wedges; their beginnings are ordered by angle.
  std::vector<FaceId> starts, order;
  for (const FaceId f : ring)
    if (!previous.count(f)) starts.push_back(f);
  if (starts.empty()) starts.push_back(ring[0]);
  std::sort(starts.begin(), starts.end(), by_angle);
  for (const FaceId start : starts) {
    FaceId f = start;
    do {
      order.push_back(f);
      const auto it = next.find(f);
      f = it == next.end() ? FaceId() : it->second;
    } while (f.valid() && f != start && order.size() <= ring.size());
  }
  if (order.size() != ring.size())
    throw InputError("the triangles around the edge between sites " + edge_name(lo, hi) + " do not form one ring");
  ring = std::move(order);
}

void ComplexBuilder::order_edges(const TriangleMesh&) {
  for (std::uint32_t f = 0; f < k.face_count(); ++f)
    for (int c = 0; c < 3; ++c) {
      const VertexId a = k.face(FaceId(f)).v[c], b = k.face(FaceId(f)).v[(c + 1) % 3];
      const FaceRing here = k.around(a, b);
      std::vector<FaceId> ring(here.begin(), here.end());
      if (*std::min_element(ring.begin(), ring.end()) != FaceId(f)) continue;  // its turn was with its lowest face
      const VertexId lo = std::min(a, b), hi = std::max(a, b);
      if (ring.size() >= 3) {
        order_ring(lo, hi, ring);
        k.link_ring(lo, hi, ring.data(), ring.size());
      }
      try {
        check_ring(ring, lo, hi, [&](FaceId g) { return k.face(g); });
      } catch (const GeometryError& e) {
        throw InputError(std::string(e.what()) + "; the surface is open or inconsistently oriented there");
      }
    }
}

void ComplexBuilder::adopt_rows(const TriangleMesh& mesh) {
  // The rows that the file gives its corners must be the fans that the rings make.
  std::vector<SurfaceVertexId> given = k.corner_vertex_;
  std::fill(k.corner_vertex_.begin(), k.corner_vertex_.end(), SurfaceVertexId());
  fan_all();
  std::vector<std::uint32_t> row_of_fan(k.site_.size(), ~0u), fan_of_row(mesh.vertices.size(), ~0u);
  for (std::size_t i = 0; i < given.size(); ++i) {
    if (!given[i].valid()) continue;
    const auto fan = k.corner_vertex_[i].value, row = given[i].value;
    if ((row_of_fan[fan] != ~0u && row_of_fan[fan] != row) || (fan_of_row[row] != ~0u && fan_of_row[row] != fan))
      throw InputError("vertex " + std::to_string(row) + " does not stand for one fan of triangles around site " +
                       std::to_string(mesh.site[row]) + "; the file was changed after it was cut");
    row_of_fan[fan] = row;
    fan_of_row[row] = fan;
  }
  const auto sides = k.fan_side_;
  const auto corners = k.fan_corner_;
  k.corner_vertex_ = std::move(given);
  k.site_.assign(mesh.vertices.size(), VertexId());
  k.fan_side_.assign(mesh.vertices.size(), Side{});
  k.fan_corner_.assign(mesh.vertices.size(), 0);
  for (std::size_t fan = 0; fan < row_of_fan.size(); ++fan) {
    const auto row = row_of_fan[fan];
    k.site_[row] = VertexId(mesh.site[row]);
    k.fan_side_[row] = sides[fan];
    k.fan_corner_[row] = corners[fan];
  }
}

Complex Complex::from_two_sided(const TriangleMesh& surface) {
  if (!surface.two_sided()) return from_skin(surface);
  require_rows(surface);
  if (surface.site.size() != surface.vertices.size() || surface.patch.size() != surface.triangles.size())
    throw InputError("the surface gives sites or patches for some rows only");
  for (std::size_t t = 0; t < surface.patch.size(); ++t)
    if (std::abs(std::int64_t(surface.patch[t])) > largest_crack)
      throw InputError("triangle " + std::to_string(t) + " is of crack " + std::to_string(surface.patch[t]) +
                       ", which is out of range");
  std::uint32_t sites = 0;
  for (const auto s : surface.site) {
    if (s > 4 * surface.vertices.size() + 1024 * 1024 * 4)
      throw InputError("site " + std::to_string(s) + " is out of range for " + std::to_string(surface.vertices.size()) +
                       " vertices");
    sites = std::max(sites, s + 1);
  }
  std::vector<Vec3> points(sites, Vec3::Zero());
  std::vector<bool> known(sites, false);
  for (std::size_t v = 0; v < surface.vertices.size(); ++v) {
    const auto s = surface.site[v];
    if (known[s] && points[s] != surface.vertices[v])
      throw InputError("vertices of site " + std::to_string(s) +
                       " are at different places; give the undeformed surface");
    points[s] = surface.vertices[v];
    known[s] = true;
  }
  ComplexBuilder builder;
  builder.add_points(points);

  std::map<std::pair<std::array<std::uint32_t, 3>, std::int32_t>, std::uint32_t> minus;  // sites and crack -> triangle
  const auto ids = [&](std::size_t t) {
    std::array<VertexId, 3> v;
    for (int k = 0; k < 3; ++k) v[k] = VertexId(surface.site[surface.triangles[t][k]]);
    if (v[0] == v[1] || v[1] == v[2] || v[2] == v[0])
      throw InputError("triangle " + std::to_string(t) + " has two vertices of one site");
    return v;
  };
  for (std::uint32_t t = 0; t < surface.triangles.size(); ++t)
    if (surface.patch[t] < 0 && !minus.try_emplace({sorted(ids(t)), -surface.patch[t]}, t).second)
      throw InputError("triangle " + std::to_string(t) + " is there twice");
  std::size_t paired = 0;
  std::map<std::array<std::uint32_t, 3>, std::uint32_t> seen;
  for (std::uint32_t t = 0; t < surface.triangles.size(); ++t) {
    const std::int32_t patch = surface.patch[t];
    if (patch < 0) continue;
    const auto v = ids(t);
    if (!seen.try_emplace(sorted(v), t).second) throw InputError("triangle " + std::to_string(t) + " is there twice");
    const FaceId f = builder.add_face(v, patch, t);
    for (int k = 0; k < 3; ++k) builder.set_corner({f, 0}, k, surface.triangles[t][k]);
    if (patch == 0) continue;
    const auto twin = minus.find({sorted(v), patch});
    if (twin == minus.end())
      throw InputError("triangle " + std::to_string(t) + " of crack " + std::to_string(patch) +
                       " has no twin on the other side");
    const auto w = ids(twin->second);
    if (even(v) == even(w))
      throw InputError("triangles " + std::to_string(t) + " and " + std::to_string(twin->second) +
                       " are twins with the same orientation");
    for (int k = 0; k < 3; ++k)
      for (int j = 0; j < 3; ++j)
        if (w[j] == v[k]) builder.set_corner({f, 1}, k, surface.triangles[twin->second][j]);
    ++paired;
  }
  if (paired != minus.size()) throw InputError("a crack triangle on a negative side has no twin on the positive side");
  if (builder.k.face_count() == 0) throw InputError("the surface has no skin");
  builder.link();
  builder.finish();
  builder.order_edges(surface);
  builder.adopt_rows(surface);
  builder.make_room();
  return std::move(builder.k);
}

void Complex::trace_sources(const std::vector<std::uint32_t>& rows) {
  for (const Face& f : faces_)
    if (f.source != ~0u && f.source >= rows.size())
      throw InputError("the surface does not name a source for each triangle");
  for (Face& f : faces_)
    if (f.source != ~0u) f.source = rows[f.source];
}

ComplexEdit Complex::difference(const Complex& other) const {
  if (other.vertex_count() < vertex_count()) {
    for (std::uint32_t v = other.vertex_count(); v < vertex_count(); ++v)
      if (!faces_at(VertexId(v)).empty())
        throw InputError("the surface has not grown from the body's: it has fewer vertices");
  }
  const std::uint32_t common = std::min(vertex_count(), other.vertex_count());
  for (std::uint32_t v = 0; v < common; ++v)
    if (!faces_at(VertexId(v)).empty() && !other.faces_at(VertexId(v)).empty() && points_[v] != other.points_[v])
      throw InputError("the surface has not grown from the body's: vertex " + std::to_string(v) + " is elsewhere");

  ComplexEdit edit;
  for (std::uint32_t v = vertex_count(); v < other.vertex_count(); ++v) edit.new_vertices.push_back(other.points_[v]);
  std::map<std::array<std::uint32_t, 3>, FaceId> mine;
  for (std::uint32_t f = 0; f < face_count(); ++f)
    if (faces_[f].alive) mine[sorted(faces_[f].v)] = FaceId(f);
  std::unordered_map<FaceId, FaceId> translated;  // other's ids to ours
  std::vector<FaceId> fresh;
  std::vector<bool> kept(face_count(), false);
  for (std::uint32_t f = 0; f < other.face_count(); ++f) {
    if (!other.faces_[f].alive) continue;
    const auto it = mine.find(sorted(other.faces_[f].v));
    if (it != mine.end() && face(it->second).crack == other.faces_[f].crack &&
        even(face(it->second).v) == even(other.faces_[f].v)) {
      translated[FaceId(f)] = it->second;
      kept[it->second.index()] = true;
    } else {
      translated[FaceId(f)] = FaceId(face_count() + static_cast<std::uint32_t>(fresh.size()));
      fresh.push_back(FaceId(f));
    }
  }
  TriangleIndex gone;
  for (std::uint32_t f = 0; f < face_count(); ++f)
    if (faces_[f].alive && !kept[f]) {
      edit.removed_faces.push_back(FaceId(f));
      gone.insert(f, box(FaceId(f)));
    }
  // Corners of a divided face are off it by rounding, which far off the origin is coarse.
  const double rounding = 0x1p-50 * extent_.hi.cwiseAbs().cwiseMax(extent_.lo.cwiseAbs()).maxCoeff();
  const double beside = 1e-9 * extent_.diagonal() + rounding, off = 1e-7 * extent_.diagonal() + rounding;
  std::vector<std::uint32_t> candidates;
  std::map<std::uint64_t, std::pair<VertexId, VertexId>> touched;
  for (const FaceId f : fresh) {
    const auto& shape = other.face(f);
    const auto c = other.corners(f);
    const Vec3 middle = (c[0] + c[1] + c[2]) / 3;
    // The removed face of the same crack that the middle lies on.
    candidates.clear();
    gone.find(Box3{middle, middle}.grown(beside), candidates);
    FaceId parent;
    double best = off;
    for (const auto id : candidates) {
      if (faces_[id].crack != shape.crack) continue;
      const auto p = corners(FaceId(id));
      const double d = (closest_point_on_triangle(middle, p[0], p[1], p[2]) - middle).norm();
      if (d < best) best = d, parent = FaceId(id);
    }
    if (shape.crack == 0 && !parent.valid())
      throw InputError("the surface has not grown from the body's: it has skin where the body has none");
    edit.new_faces.push_back({shape.v, shape.crack, parent});
    for (int k = 0; k < 3; ++k) touched[key(shape.v[k], shape.v[(k + 1) % 3])] = {shape.v[k], shape.v[(k + 1) % 3]};
  }
  // What was a crack must still be one there: a body's nodes are on its sides.
  TriangleIndex made;
  for (const FaceId f : fresh) made.insert(f.value, other.box(f));
  for (const FaceId f : edit.removed_faces) {
    const auto c = corners(f);
    const Vec3 middle = (c[0] + c[1] + c[2]) / 3;
    candidates.clear();
    made.find(Box3{middle, middle}.grown(off), candidates);
    const bool found = std::any_of(candidates.begin(), candidates.end(), [&](std::uint32_t id) {
      const auto p = other.corners(FaceId(id));
      return other.face(FaceId(id)).crack == face(f).crack &&
             (closest_point_on_triangle(middle, p[0], p[1], p[2]) - middle).norm() < off;
    });
    if (!found)
      throw InputError(face(f).crack > 0 ? "crack " + std::to_string(face(f).crack) +
                                               " of the body was moved since; build the body anew from the new surface"
                                         : "the surface has not grown from the body's: skin is gone");
  }
  for (const FaceId f : edit.removed_faces)
    for (int k = 0; k < 3; ++k)
      touched[key(face(f).v[k], face(f).v[(k + 1) % 3])] = {face(f).v[k], face(f).v[(k + 1) % 3]};
  for (const auto& [edge, ends] : touched) {
    const auto ring = other.around(ends.first, ends.second);
    if (ring.size() < 3) continue;
    ComplexEdit::Ring given{std::min(ends.first, ends.second), std::max(ends.first, ends.second), {}};
    for (const FaceId f : ring) given.faces.push_back(translated.at(f));
    edit.rings.push_back(std::move(given));
  }
  return edit;
}

}  // namespace geo
