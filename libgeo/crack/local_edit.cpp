#include "crack/local_edit.h"

#include <algorithm>

#include "geometry/predicates.h"
#include "kerf/error.h"
#include "surface/radial_edge.h"

namespace geo::crack {
namespace {

// The faces around uv, counter-clockwise about u→v.
std::vector<FaceId> directed(const Complex& k, VertexId u, VertexId v) {
  const auto ring = k.faces_around(u, v);
  std::vector<FaceId> order(ring.begin(), ring.end());
  if (u > v) std::reverse(order.begin(), order.end());
  return order;
}

// Collects an edit in which faces have heirs.
class Maker {
 public:
  explicit Maker(const Complex& k) : k_(k) {}
  LocalEdit local;

  void remove(FaceId f) { local.edit.removed_faces.push_back(f); }
  /// Adds a face in the place of `parent`.
  FaceId add(const std::array<VertexId, 3>& v, FaceId parent) {
    const FaceId id(k_.face_count() + static_cast<std::uint32_t>(local.edit.new_faces.size()));
    const auto row = static_cast<std::uint32_t>(local.edit.new_faces.size());
    local.edit.new_faces.push_back({v, k_.face(parent).crack, parent});
    local.families.push_back({k_.corners(parent), row, row + 1, {}, false});
    return id;
  }
  FaceId replace(FaceId f, VertexId old, VertexId now) {
    auto v = k_.face(f).v;
    std::replace(v.begin(), v.end(), old, now);
    heirs_.push_back({f, add(v, f)});
    return heirs_.back().second;
  }
  FaceId heir(FaceId f) const {
    for (const auto& [old, now] : heirs_)
      if (old == f) return now;
    return f;
  }
  std::vector<FaceId> inherited(std::vector<FaceId> ring) const {
    for (FaceId& f : ring) f = heir(f);
    return ring;
  }
  void order(VertexId u, VertexId v, std::vector<FaceId> ring) {
    if (ring.size() >= 3) local.edit.radial_orders.push_back({u, v, std::move(ring)});
  }

 private:
  const Complex& k_;
  std::vector<std::pair<FaceId, FaceId>> heirs_;
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

// From just after f all the way round, without f.
std::vector<FaceId> rest_after(const std::vector<FaceId>& ring, FaceId f) {
  const auto at = std::find(ring.begin(), ring.end(), f);
  std::vector<FaceId> rest(at + 1, ring.end());
  rest.insert(rest.end(), ring.begin(), at);
  return rest;
}

}  // namespace

std::optional<LocalEdit> collapse(const Complex& k, VertexId b, VertexId a) {
  Maker maker(k);
  std::vector<std::pair<VertexId, FaceId>> vanishing;  // by the third vertex
  for (const FaceId f : k.faces_at(b)) {
    maker.remove(f);
    const auto& v = k.face(f).v;
    const int at = corner_at(k.face(f), b);
    const VertexId x = v[(at + 1) % 3], y = v[(at + 2) % 3];
    if (x == a || y == a) {
      vanishing.push_back({x == a ? y : x, f});
      continue;
    }
    for (const FaceId other : k.faces_around(x, y))
      if (corner_at(k.face(other), a) >= 0) return {};
    maker.replace(f, b, a);
    maker.local.swept.push_back({k.point(b), k.point(a), k.point(x), k.point(y)});
  }
  for (const VertexId x : neighbors_of(k, b)) {
    if (x == a) continue;
    const auto gone = std::find_if(vanishing.begin(), vanishing.end(), [&](const auto& p) { return p.first == x; });
    const auto mine = directed(k, a, x), its = directed(k, b, x);
    if (gone == vanishing.end()) {
      if (!mine.empty()) return {};
      maker.order(a, x, maker.inherited(its));
      continue;
    }
    // Seen along the edges, the face between a and b shrinks to nothing: what follows it at a, then
    // what follows at b.
    auto merged = maker.inherited(rest_after(mine, gone->second));
    const auto more = maker.inherited(rest_after(its, gone->second));
    merged.insert(merged.end(), more.begin(), more.end());
    maker.order(a, x, std::move(merged));
  }
  return std::move(maker.local);
}

std::optional<LocalEdit> flip(const Complex& k, FaceId f, int e) {
  const auto& face = k.face(f);
  const VertexId a = face.v[e], b = face.v[(e + 1) % 3], c = face.v[(e + 2) % 3];
  const auto ring = k.faces_around(a, b);
  if (ring.size() != 2) return {};
  const FaceId g = ring[0] == f ? ring[1] : ring[0];
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
  Maker maker(k);
  maker.remove(f);
  maker.remove(g);
  const FaceId left = maker.add({a, d, c}, f), right = maker.add({d, b, c}, g);
  const auto exchange = [&](VertexId u, VertexId v, FaceId old, FaceId now) {
    auto order = directed(k, u, v);
    std::replace(order.begin(), order.end(), old, now);
    maker.order(u, v, std::move(order));
  };
  exchange(c, a, f, left), exchange(a, d, g, left), exchange(b, c, f, right), exchange(d, b, g, right);
  maker.local.swept.push_back({k.point(a), k.point(b), k.point(c), k.point(d)});
  return std::move(maker.local);
}

LocalEdit divide(const Complex& k, VertexId a, VertexId b, const Vec3& p) {
  Maker maker(k);
  const VertexId middle(k.vertex_count());
  maker.local.edit.new_vertices.push_back(p);
  std::vector<FaceId> first, second;
  for (const FaceId f : directed(k, a, b)) {
    maker.remove(f);
    first.push_back(maker.replace(f, b, middle));
    second.push_back(maker.replace(f, a, middle));
  }
  maker.order(a, middle, std::move(first));
  maker.order(middle, b, std::move(second));
  return std::move(maker.local);
}

LocalEdit relocate(const Complex& k, VertexId v, const Vec3& p) {
  Maker maker(k);
  const VertexId now(k.vertex_count());
  maker.local.edit.new_vertices.push_back(p);
  for (const FaceId f : k.faces_at(v)) {
    maker.remove(f);
    maker.replace(f, v, now);
    const int at = corner_at(k.face(f), v);
    maker.local.swept.push_back(
        {k.point(v), p, k.point(k.face(f).v[(at + 1) % 3]), k.point(k.face(f).v[(at + 2) % 3])});
  }
  for (const VertexId x : neighbors_of(k, v)) maker.order(now, x, maker.inherited(directed(k, v, x)));
  return std::move(maker.local);
}

namespace {

// True when a vertex that is not one of the tetrahedron's own is in it.
bool holds_something(const Complex& k, const std::array<Vec3, 4>& t, std::span<const FaceId> near) {
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
  const bool faulty = static_cast<bool>(find_fault(k, local.edit, local.families, {}));
  for (Family& family : local.families) family.near = {};
  return !faulty && std::none_of(local.swept.begin(), local.swept.end(),
                                 [&](const auto& t) { return holds_something(k, t, near); });
}

std::optional<CrackDelta> carry_out(Complex& k, LocalEdit& local, DeltaSum& sum) {
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
