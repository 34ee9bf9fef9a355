// Complex::from_skin() and from_two_sided() of kerf/complex.h. A skin gives pairs of faces by edge.
// In a two-sided surface, triangles of equal sites and patches ±c are the two sides of one crack
// face; edges of S_A give the wedges, and exact angles order the chains of faces that wedges join.
#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "geometry/predicates.h"
#include "kerf/complex.h"
#include "kerf/error.h"
#include "surface/complex_impl.h"
#include "surface/face_key.h"
#include "surface/radial_edge.h"

namespace geo {
namespace {

// Numbers of new cracks follow the largest one in use: this leaves as many again below 2^31.
constexpr std::int64_t largest_crack = 1000000000;

void require_valid_indices(const TriangleMesh& mesh) {
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

}  // namespace

/// Fills a complex step by step; from_skin() and from_two_sided() share the steps.
class Complex::Builder {
 public:
  Complex k;

  void add_points(const std::vector<Vec3>& points) {
    k.points_ = points;
    k.first_corner_.assign(points.size(), no_corner);
    k.impl_->marks.assign(points.size(), 0);
  }

  FaceId add_face(std::array<VertexId, 3> v, std::int32_t crack, std::uint32_t source) {
    const FaceId f(k.faces_.size());
    k.faces_.push_back({.v = v, .crack = crack, .alive = true, .source = source});
    k.corner_vertex_.resize(k.corner_vertex_.size() + 6);
    k.crack_count_ = std::max(k.crack_count_, crack);
    ++k.live_faces_;
    return f;
  }

  /// Links corners by vertex and faces by edge, once all faces are there. Radial cycles are in
  /// ascending order as yet.
  void link() {
    k.radial_.resize(3 * k.faces_.size());
    k.next_corner_.assign(3 * k.faces_.size(), no_corner);
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
        k.link_radial_cycle(VertexId(v), w, ring.data(), ring.size());
      }
    }
  }

  /// Computes the extent and fills the spatial index. Throws InputError without skin or extent.
  void finish() {
    for (const auto& f : k.faces_)
      for (const VertexId v : f.v)
        if (f.crack == 0) k.extent_.add(k.point(v));
    if (k.extent_.empty()) throw InputError("the surface has cracks but no skin");
    if (!(k.extent_.diagonal() * largest_coordinate > 1))
      throw InputError("the surface has no extent: its points are at one place or nearly so; scale it up");
    for (std::uint32_t f = 0; f < k.faces_.size(); ++f) {
      const auto c = k.corners(FaceId(f));
      k.impl_->index.insert(f, box_of(c[0], c[1], c[2]));
    }
  }

  /// Reserves memory for the first cracks, so that they do not move all arrays: a quarter more
  /// than there is, and 4096 entries. Larger: later growth, more memory.
  void reserve_for_cracks() {
    const auto more = [](auto& v, std::size_t each) { v.reserve(v.size() + v.size() / 4 + 4096 * each); };
    more(k.points_, 1);
    more(k.impl_->marks, 1);
    more(k.first_corner_, 1);
    more(k.site_, 1);
    more(k.fan_side_, 1);
    more(k.fan_corner_, 1);
    more(k.faces_, 1);
    more(k.radial_, 3);
    more(k.next_corner_, 3);
    more(k.corner_vertex_, 6);
    k.impl_->index.reserve(k.faces_.capacity());
  }

  /// Builds the fans at all vertices.
  void build_fans() {
    std::vector<SurfaceVertexId> none;
    FanBuilder fans(k);
    for (std::uint32_t v = 0; v < k.points_.size(); ++v) {
      none.clear();
      if (!k.faces_at(VertexId(v)).empty()) fans.rebuild(VertexId(v), none, nullptr);
    }
  }

  /// The surface vertex at a corner, as a file gives it.
  void set_corner(Side s, int corner, std::uint32_t vertex) {
    k.corner_vertex_[s.face.index() * 6 + s.which * 3 + corner] = SurfaceVertexId(vertex);
  }

  /// Adds a face for each triangle of skin and each pair of twins of a crack.
  void add_twins(const TriangleMesh& surface);
  /// Sorts the radial cycles of three and more faces.
  void order_edges();
  /// Numbers the fans by the indices of the mesh's vertices.
  void adopt_vertex_indices(const TriangleMesh& mesh);

 private:
  using Chains = std::map<FaceId, FaceId>;  // from each face to the next one across a wedge of material
  void link_wedges(VertexId lo, VertexId hi, const std::vector<FaceId>& cycle, Chains& next, Chains& previous) const;
  void order_cycle(VertexId lo, VertexId hi, std::vector<FaceId>& cycle) const;
  VertexId apex(FaceId f, VertexId lo, VertexId hi) const {
    for (const VertexId v : k.face(f).v)
      if (v != lo && v != hi) return v;
    return {};
  }
};

Complex Complex::from_skin(const TriangleMesh& skin) {
  require_valid_indices(skin);
  Builder builder;
  builder.add_points(skin.vertices);
  for (std::uint32_t row = 0; row < skin.triangles.size(); ++row) {
    const auto& t = skin.triangles[row];
    builder.add_face({VertexId(t[0]), VertexId(t[1]), VertexId(t[2])}, 0, row);
  }
  builder.link();
  // In order of triangles, so that the first problem named is the same every time.
  for (std::uint32_t f = 0; f < builder.k.face_count(); ++f)
    for (int k = 0; k < 3; ++k) {
      const VertexId a = builder.k.face(FaceId(f)).v[k], b = builder.k.face(FaceId(f)).v[(k + 1) % 3];
      const auto cycle = builder.k.faces_around(a, b);
      if (cycle.size() == 1)
        throw InputError("the surface is open: edge " + edge_name(a, b) +
                         " has one triangle only; close the holes first");
      if (cycle.size() > 2)
        throw InputError("the surface is not manifold: edge " + edge_name(a, b) + " has " +
                         std::to_string(cycle.size()) + " triangles; separate the parts that touch there");
      if (runs_upwards(builder.k.face(cycle[0]), a, b) == runs_upwards(builder.k.face(cycle[1]), a, b))
        throw InputError("triangles " + std::to_string(cycle[0].value) + " and " + std::to_string(cycle[1].value) +
                         " have opposite orientations; orient the surface consistently");
    }
  if (signed_volume(skin) <= 0)
    throw InputError("the surface is inside out (volume " + std::to_string(signed_volume(skin)) +
                     "); reverse its triangles");
  builder.finish();
  builder.build_fans();
  builder.reserve_for_cracks();
  return std::move(builder.k);
}

// Two sides at one derived edge bound one wedge. Where more than two do (both ends of the edge lie
// on one front), the choice is left to geometry.
void Complex::Builder::link_wedges(VertexId lo, VertexId hi, const std::vector<FaceId>& cycle, Chains& next,
                                   Chains& previous) const {
  std::map<std::array<SurfaceVertexId, 2>, std::vector<std::pair<FaceId, bool>>> derived;  // face, looks ccw
  for (const FaceId f : cycle)
    for (int which = 0; which < side_count(k.face(f)); ++which) {
      const auto a = k.surface_vertex({f, which}, corner_at(k.face(f), lo)),
                 b = k.surface_vertex({f, which}, corner_at(k.face(f), hi));
      derived[{a, b}].push_back({f, faces_counterclockwise(k.face(f), which, lo, hi)});
    }
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
}

// Chains of faces that wedges join, one after the other; their first faces are ordered by angle,
// exactly.
void Complex::Builder::order_cycle(VertexId lo, VertexId hi, std::vector<FaceId>& cycle) const {
  Chains next, previous;
  link_wedges(lo, hi, cycle, next, previous);
  const VertexId zero = apex(cycle[0], lo, hi);
  const auto by_angle = [&](FaceId a, FaceId b) {
    const VertexId pa = apex(a, lo, hi), pb = apex(b, lo, hi);
    if (pa == zero || pb == zero) return pa == zero && pb != zero;
    const int c = compare_angle(k.point(lo), k.point(hi), k.point(zero), k.point(pa), k.point(pb));
    return c != 0 ? c < 0 : a < b;
  };
  std::vector<FaceId> starts, order;
  for (const FaceId f : cycle)
    if (!previous.count(f)) starts.push_back(f);
  if (starts.empty()) starts.push_back(cycle[0]);
  std::sort(starts.begin(), starts.end(), by_angle);
  for (const FaceId start : starts) {
    FaceId f = start;
    do {
      order.push_back(f);
      const auto it = next.find(f);
      f = it == next.end() ? FaceId() : it->second;
    } while (f.valid() && f != start && order.size() <= cycle.size());
  }
  if (order.size() != cycle.size())
    throw InputError("the triangles around the edge between sites " + edge_name(lo, hi) + " do not form one ring");
  cycle = std::move(order);
}

void Complex::Builder::order_edges() {
  for (std::uint32_t f = 0; f < k.face_count(); ++f)
    for (int c = 0; c < 3; ++c) {
      const VertexId a = k.face(FaceId(f)).v[c], b = k.face(FaceId(f)).v[(c + 1) % 3];
      const RadialCycle here = k.faces_around(a, b);
      std::vector<FaceId> cycle(here.begin(), here.end());
      if (*std::min_element(cycle.begin(), cycle.end()) != FaceId(f)) continue;  // done at its lowest face
      const VertexId lo = std::min(a, b), hi = std::max(a, b);
      if (cycle.size() >= 3) {
        order_cycle(lo, hi, cycle);
        k.link_radial_cycle(lo, hi, cycle.data(), cycle.size());
      }
      try {
        check_wedges(cycle, lo, hi, [&](FaceId g) { return k.face(g); });
      } catch (const GeometryError& e) {
        throw InputError(std::string(e.what()) + "; the surface is open or inconsistently oriented there");
      }
    }
}

void Complex::Builder::adopt_vertex_indices(const TriangleMesh& mesh) {
  // The indices that the file gives its corners must be one to one with the fans that the radial
  // cycles make.
  std::vector<SurfaceVertexId> given = k.corner_vertex_;
  std::fill(k.corner_vertex_.begin(), k.corner_vertex_.end(), SurfaceVertexId());
  build_fans();
  std::vector<std::uint32_t> index_of_fan(k.site_.size(), ~0u), fan_of_index(mesh.vertices.size(), ~0u);
  for (std::size_t i = 0; i < given.size(); ++i) {
    if (!given[i].valid()) continue;
    const auto fan = k.corner_vertex_[i].value, index = given[i].value;
    if ((index_of_fan[fan] != ~0u && index_of_fan[fan] != index) ||
        (fan_of_index[index] != ~0u && fan_of_index[index] != fan))
      throw InputError("vertex " + std::to_string(index) + " does not stand for one fan of triangles around site " +
                       std::to_string(mesh.site[index]) + "; the file was changed after it was cut");
    index_of_fan[fan] = index;
    fan_of_index[index] = fan;
  }
  const auto sides = k.fan_side_;
  const auto corners = k.fan_corner_;
  k.corner_vertex_ = std::move(given);
  k.site_.assign(mesh.vertices.size(), VertexId());
  k.fan_side_.assign(mesh.vertices.size(), Side{});
  k.fan_corner_.assign(mesh.vertices.size(), 0);
  for (std::size_t fan = 0; fan < index_of_fan.size(); ++fan) {
    const auto index = index_of_fan[fan];
    k.site_[index] = VertexId(mesh.site[index]);
    k.fan_side_[index] = sides[fan];
    k.fan_corner_[index] = corners[fan];
  }
}

namespace {

void require_sites_and_patches(const TriangleMesh& surface) {
  if (surface.site.size() != surface.vertices.size() || surface.patch.size() != surface.triangles.size())
    throw InputError("the surface gives sites or patches for some rows only");
  for (std::size_t t = 0; t < surface.patch.size(); ++t)
    if (std::abs(std::int64_t(surface.patch[t])) > largest_crack)
      throw InputError("triangle " + std::to_string(t) + " is of crack " + std::to_string(surface.patch[t]) +
                       ", which is out of range");
}

// The position of each site; its vertices must agree.
std::vector<Vec3> site_points(const TriangleMesh& surface) {
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
  return points;
}

// The sites of a triangle's vertices.
std::array<VertexId, 3> sites_of(const TriangleMesh& surface, std::size_t t) {
  std::array<VertexId, 3> v;
  for (int k = 0; k < 3; ++k) v[k] = VertexId(surface.site[surface.triangles[t][k]]);
  if (v[0] == v[1] || v[1] == v[2] || v[2] == v[0])
    throw InputError("triangle " + std::to_string(t) + " has two vertices of one site");
  return v;
}

}  // namespace

void Complex::Builder::add_twins(const TriangleMesh& surface) {
  std::map<std::pair<std::array<std::uint32_t, 3>, std::int32_t>, std::uint32_t> minus;  // sites and crack → triangle
  for (std::uint32_t t = 0; t < surface.triangles.size(); ++t)
    if (surface.patch[t] < 0 && !minus.try_emplace({face_key(sites_of(surface, t)), -surface.patch[t]}, t).second)
      throw InputError("triangle " + std::to_string(t) + " is there twice");
  std::size_t paired = 0;
  std::map<std::array<std::uint32_t, 3>, std::uint32_t> seen;
  for (std::uint32_t t = 0; t < surface.triangles.size(); ++t) {
    const std::int32_t patch = surface.patch[t];
    if (patch < 0) continue;
    const auto v = sites_of(surface, t);
    if (!seen.try_emplace(face_key(v), t).second) throw InputError("triangle " + std::to_string(t) + " is there twice");
    const FaceId f = add_face(v, patch, t);
    for (int i = 0; i < 3; ++i) set_corner({f, 0}, i, surface.triangles[t][i]);
    if (patch == 0) continue;
    const auto twin = minus.find({face_key(v), patch});
    if (twin == minus.end())
      throw InputError("triangle " + std::to_string(t) + " of crack " + std::to_string(patch) +
                       " has no twin on the other side");
    const auto w = sites_of(surface, twin->second);
    if (is_even(v) == is_even(w))
      throw InputError("triangles " + std::to_string(t) + " and " + std::to_string(twin->second) +
                       " are twins with the same orientation");
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j)
        if (w[j] == v[i]) set_corner({f, 1}, i, surface.triangles[twin->second][j]);
    ++paired;
  }
  if (paired != minus.size()) throw InputError("a crack triangle on a negative side has no twin on the positive side");
  if (k.face_count() == 0) throw InputError("the surface has no skin");
}

Complex Complex::from_two_sided(const TriangleMesh& surface) {
  if (!surface.two_sided()) return from_skin(surface);
  require_valid_indices(surface);
  require_sites_and_patches(surface);
  Builder builder;
  builder.add_points(site_points(surface));
  builder.add_twins(surface);
  builder.link();
  builder.finish();
  builder.order_edges();
  builder.adopt_vertex_indices(surface);
  builder.reserve_for_cracks();
  return std::move(builder.k);
}

void Complex::map_sources(const std::vector<std::uint32_t>& sources) {
  for (const Face& f : faces_)
    if (f.source != ~0u && f.source >= sources.size())
      throw InputError("the surface does not name a source for each triangle");
  for (Face& f : faces_)
    if (f.source != ~0u) f.source = sources[f.source];
}

}  // namespace geo
