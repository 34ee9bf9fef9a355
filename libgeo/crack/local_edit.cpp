// Each edit removes the faces at a vertex or edge and adds replacements. Radial cycles are copied
// with ids exchanged; collapsing b into a joins the cycles around ax and bx. Tetrahedra swept by
// faces must contain no vertex of other faces, or a face might pass over it.
#include "crack/local_edit.h"

#include <algorithm>

#include "geometry/predicates.h"
#include "kerf/error.h"
#include "surface/radial_edge.h"

namespace geo::crack {
namespace {

// The faces around uv, counter-clockwise about u→v.
std::vector<FaceId> directed(const Complex& k, VertexId u, VertexId v) {
  const auto cycle = k.faces_around(u, v);
  std::vector<FaceId> order(cycle.begin(), cycle.end());
  if (u > v) std::reverse(order.begin(), order.end());
  return order;
}

// Collects an edit in which new faces replace old ones.
class EditBuilder {
 public:
  explicit EditBuilder(const Complex& k) : k_(k) {}
  LocalEdit local;

  void remove(FaceId f) { local.edit.removed_faces.push_back(f); }
  /// Adds a face as a child of `parent`.
  FaceId add(const std::array<VertexId, 3>& v, FaceId parent) {
    const FaceId id(k_.face_count() + static_cast<std::uint32_t>(local.edit.new_faces.size()));
    const auto index = static_cast<std::uint32_t>(local.edit.new_faces.size());
    local.edit.new_faces.push_back({v, k_.face(parent).crack, parent});
    local.families.push_back({.plane = k_.corners(parent),
                              .first = index,
                              .end = index + 1,
                              .near = {},
                              .near_known = false,
                              .whole = false});
    return id;
  }
  /// Adds f with vertex `now` for `old`.
  FaceId replace(FaceId f, VertexId old, VertexId now) {
    auto v = k_.face(f).v;
    std::replace(v.begin(), v.end(), old, now);
    replacements_.push_back({f, add(v, f)});
    return replacements_.back().second;
  }
  FaceId replacement(FaceId f) const {
    for (const auto& [old, now] : replacements_)
      if (old == f) return now;
    return f;
  }
  std::vector<FaceId> replaced(std::vector<FaceId> cycle) const {
    for (FaceId& f : cycle) f = replacement(f);
    return cycle;
  }
  void order(VertexId u, VertexId v, std::vector<FaceId> cycle) {
    if (cycle.size() >= 3) local.edit.radial_orders.push_back({u, v, std::move(cycle)});
  }

 private:
  const Complex& k_;
  std::vector<std::pair<FaceId, FaceId>> replacements_;  // old, new
};

std::vector<VertexId> neighbors_of(const Complex& k, VertexId v) {
  std::vector<VertexId> link;
  for (const FaceId f : k.faces_at(v))
    for (const VertexId w : k.face(f).v)
      if (w != v) link.push_back(w);
  std::sort(link.begin(), link.end());
  link.erase(std::unique(link.begin(), link.end()), link.end());
  return link;
}

// The faces of the radial cycle after f, in order, without f.
std::vector<FaceId> rest_after(const std::vector<FaceId>& cycle, FaceId f) {
  const auto at = std::find(cycle.begin(), cycle.end(), f);
  std::vector<FaceId> rest(at + 1, cycle.end());
  rest.insert(rest.end(), cycle.begin(), at);
  return rest;
}

}  // namespace

std::optional<LocalEdit> collapse(const Complex& k, VertexId b, VertexId a) {
  EditBuilder builder(k);
  std::vector<std::pair<VertexId, FaceId>> vanishing;  // by the third vertex
  for (const FaceId f : k.faces_at(b)) {
    builder.remove(f);
    const auto& v = k.face(f).v;
    const int at = corner_at(k.face(f), b);
    const VertexId x = v[(at + 1) % 3], y = v[(at + 2) % 3];
    if (x == a || y == a) {
      vanishing.push_back({x == a ? y : x, f});
      continue;
    }
    for (const FaceId other : k.faces_around(x, y))
      if (corner_at(k.face(other), a) >= 0) return {};
    builder.replace(f, b, a);
    builder.local.swept.push_back({k.point(b), k.point(a), k.point(x), k.point(y)});
  }
  for (const VertexId x : neighbors_of(k, b)) {
    if (x == a) continue;
    const auto vanished = std::find_if(vanishing.begin(), vanishing.end(), [&](const auto& p) { return p.first == x; });
    const auto at_a = directed(k, a, x), at_b = directed(k, b, x);
    if (vanished == vanishing.end()) {
      if (!at_a.empty()) return {};
      builder.order(a, x, builder.replaced(at_b));
      continue;
    }
    // The face abx shrinks to an edge: what follows it around ax comes before what follows it
    // around bx.
    auto merged = builder.replaced(rest_after(at_a, vanished->second));
    const auto more = builder.replaced(rest_after(at_b, vanished->second));
    merged.insert(merged.end(), more.begin(), more.end());
    builder.order(a, x, std::move(merged));
  }
  return std::move(builder.local);
}

std::optional<LocalEdit> flip(const Complex& k, FaceId f, int e) {
  const auto& face = k.face(f);
  const VertexId a = face.v[e], b = face.v[(e + 1) % 3], c = face.v[(e + 2) % 3];
  const auto cycle = k.faces_around(a, b);
  if (cycle.size() != 2) return {};
  const FaceId g = cycle[0] == f ? cycle[1] : cycle[0];
  const auto& other = k.face(g);
  const int at = corner_at(other, b);
  if (other.crack != face.crack || (face.crack == 0 && other.source != face.source) || other.v[(at + 1) % 3] != a)
    return {};
  const VertexId d = other.v[(at + 2) % 3];
  if (c == d || !k.faces_around(c, d).empty()) return {};
  for (const FaceId old : {f, g}) {  // the new ones are oriented like both
    const auto t = k.corners(old);
    const auto [axis, turn] = projection_axis(t[0], t[1], t[2]);
    if (orient2d(k.point(a), k.point(d), k.point(c), axis) != turn ||
        orient2d(k.point(d), k.point(b), k.point(c), axis) != turn)
      return {};
  }
  EditBuilder builder(k);
  builder.remove(f);
  builder.remove(g);
  const FaceId left = builder.add({a, d, c}, f), right = builder.add({d, b, c}, g);
  const auto exchange = [&](VertexId u, VertexId v, FaceId old, FaceId now) {
    auto order = directed(k, u, v);
    std::replace(order.begin(), order.end(), old, now);
    builder.order(u, v, std::move(order));
  };
  exchange(c, a, f, left);
  exchange(a, d, g, left);
  exchange(b, c, f, right);
  exchange(d, b, g, right);
  builder.local.swept.push_back({k.point(a), k.point(b), k.point(c), k.point(d)});
  return std::move(builder.local);
}

LocalEdit divide(const Complex& k, VertexId a, VertexId b, const Vec3& p) {
  EditBuilder builder(k);
  const VertexId middle(k.vertex_count());
  builder.local.edit.new_vertices.push_back(p);
  std::vector<FaceId> first, second;
  for (const FaceId f : directed(k, a, b)) {
    builder.remove(f);
    first.push_back(builder.replace(f, b, middle));
    second.push_back(builder.replace(f, a, middle));
  }
  builder.order(a, middle, std::move(first));
  builder.order(middle, b, std::move(second));
  return std::move(builder.local);
}

LocalEdit relocate(const Complex& k, VertexId v, const Vec3& p) {
  EditBuilder builder(k);
  const VertexId now(k.vertex_count());
  builder.local.edit.new_vertices.push_back(p);
  for (const FaceId f : k.faces_at(v)) {
    builder.remove(f);
    builder.replace(f, v, now);
    const int at = corner_at(k.face(f), v);
    builder.local.swept.push_back(
        {k.point(v), p, k.point(k.face(f).v[(at + 1) % 3]), k.point(k.face(f).v[(at + 2) % 3])});
  }
  for (const VertexId x : neighbors_of(k, v)) builder.order(now, x, builder.replaced(directed(k, v, x)));
  return std::move(builder.local);
}

namespace {

// True when a vertex other than the tetrahedron's own lies in it.
bool contains_vertex(const Complex& k, const std::array<Vec3, 4>& t, std::span<const FaceId> near) {
  const int side = orient3d(t[0], t[1], t[2], t[3]);
  if (side == 0) return false;
  Box3 box = box_of(t[0], t[1], t[2]);
  box.add(t[3]);
  for (const FaceId f : near) {
    if (!k.box(f).meets(box)) continue;
    for (const Vec3& p : k.corners(f)) {
      if (p == t[0] || p == t[1] || p == t[2] || p == t[3]) continue;
      if (!Box3{p, p}.meets(box)) continue;
      if (orient3d(t[0], t[1], t[2], p) != -side && orient3d(t[0], t[3], t[1], p) != -side &&
          orient3d(t[1], t[3], t[2], p) != -side && orient3d(t[2], t[3], t[0], p) != -side)
        return true;
    }
  }
  return false;
}

}  // namespace

bool is_sound(const Complex& k, LocalEdit& local) {
  const auto& removed = local.edit.removed_faces;
  Box3 box;
  for (const FaceId f : removed) box.add(k.box(f));
  for (const auto& t : local.swept)
    for (const Vec3& p : t) box.add(p);
  for (const Vec3& p : local.edit.new_vertices) box.add(p);
  std::vector<FaceId> near;
  k.faces_near(box, near);
  std::erase_if(near, [&](FaceId f) { return std::find(removed.begin(), removed.end(), f) != removed.end(); });
  for (Family& family : local.families) family.near = near;
  const bool faulty = static_cast<bool>(find_fault(k, local.edit, {.families = local.families}));
  for (Family& family : local.families) family.near = {};
  return !faulty && std::none_of(local.swept.begin(), local.swept.end(),
                                 [&](const auto& t) { return contains_vertex(k, t, near); });
}

std::optional<CrackDelta> try_commit(Complex& k, LocalEdit& local, DeltaSum& sum) {
  if (!is_sound(k, local)) return {};
  try {
    CrackDelta delta = k.apply(local.edit);
    sum.add(delta);
    return delta;
  } catch (const GeometryError&) {
    return {};
  }
}

}  // namespace geo::crack
