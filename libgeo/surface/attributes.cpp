// transfer_attributes() of kerf/mesh.h.
//
// A corner gets barycentric weights in its source triangle: 1 at a corner, linear on an edge within
// 8 ulps of it, else height over the longest edge first, then position along it. Edges are directed
// by position, so that both triangles of an edge compute equal values.
#include "kerf/mesh.h"

#include <algorithm>
#include <limits>

#include "geometry/coordinate_order.h"
#include "kerf/error.h"

namespace geo {
namespace {

// Barycentric location of a point in a triangle: at a corner, on an edge, or inside.
struct Location {
  int count = 1;
  std::array<int, 3> corner{};
  std::array<double, 3> weight{1, 0, 0};
};

Location locate(const std::array<Vec3, 3>& t, const Vec3& p) {
  for (int k = 0; k < 3; ++k)
    if (t[k] == p) return {1, {k}, {1}};
  // Points that a cut puts on an edge are off it by a few ulps. Both triangles of the edge must get
  // equal weights there, so the edge is directed independently of the triangle.
  double largest = p.cwiseAbs().maxCoeff();
  for (const Vec3& c : t) largest = std::max(largest, c.cwiseAbs().maxCoeff());
  double best = 8 * std::numeric_limits<double>::epsilon() * largest;  // a few roundings of coordinates
  int longest = 0;
  Location on_edge{0, {}, {}};
  for (int k = 0; k < 3; ++k) {
    int a = k, b = (k + 1) % 3;
    if (is_before(t[b], t[a])) std::swap(a, b);
    const Vec3 e = t[b] - t[a];
    if (e.squaredNorm() > (t[(longest + 1) % 3] - t[longest]).squaredNorm()) longest = k;
    const double s = std::clamp(e.dot(p - t[a]) / e.squaredNorm(), 0.0, 1.0);
    const double distance = (p - t[a] - s * e).norm();
    if (distance <= best) {
      best = distance;
      on_edge = {2, {a, b}, {1 - s, s}};
    }
  }
  if (on_edge.count == 2) return on_edge;
  // Height over the longest edge first, then the position along the edge: the error is a few ulps
  // of a length, however thin the triangle.
  const int a = longest, b = (a + 1) % 3, c = (a + 2) % 3;
  const Vec3 e = t[b] - t[a], q = t[c] - t[a], d = p - t[a];
  const Vec3 up = q - e * (q.dot(e) / e.squaredNorm());
  const double wc = up.squaredNorm() > 0 ? std::clamp(d.dot(up) / up.squaredNorm(), 0.0, 1.0) : 0.0;
  const double wb = std::clamp((d - wc * q).dot(e) / e.squaredNorm(), 0.0, 1 - wc);
  return {3, {a, b, c}, {std::max(0.0, 1 - wb - wc), wb, wc}};
}

template <class V>
bool constant(const std::array<V, 3>& at, const Location& location) {
  for (int i = 1; i < location.count; ++i)
    if (at[location.corner[i]] != at[location.corner[0]]) return false;
  return true;
}

template <class V>
V interpolated(const std::array<V, 3>& at, const Location& location) {
  if (constant(at, location)) return at[location.corner[0]];
  V sum = location.weight[0] * at[location.corner[0]];
  for (int i = 1; i < location.count; ++i) sum += location.weight[i] * at[location.corner[i]];
  return sum;
}

std::array<Vec3, 3> corners_of(const TriangleMesh& mesh, std::size_t t) {
  const auto& [a, b, c] = mesh.triangles[t];
  return {mesh.vertices[a], mesh.vertices[b], mesh.vertices[c]};
}

// The triangle on the other side of a crack: the next one, as Kerf writes surfaces. Without one,
// the triangle itself.
std::uint32_t other_side(const TriangleMesh& mesh, std::uint32_t t) {
  if (mesh.patch.empty() || t + 1 >= mesh.triangles.size() || mesh.patch[t] <= 0 || mesh.patch[t + 1] != -mesh.patch[t])
    return t;
  const auto sites_of = [&](std::uint32_t triangle) {
    std::array<std::uint32_t, 3> sites;
    for (int k = 0; k < 3; ++k) sites[k] = mesh.site[mesh.triangles[triangle][k]];
    std::sort(sites.begin(), sites.end());
    return sites;
  };
  return sites_of(t) == sites_of(t + 1) ? t + 1 : t;
}

// The source of triangle t of `original`; t itself in a surface that was not cut.
std::uint32_t source_of(const TriangleMesh& original, std::uint32_t t) {
  if (!original.source.empty()) return original.source[t];
  return !original.patch.empty() && original.patch[t] != 0 ? ~0u : t;
}

}  // namespace

std::vector<std::string> Attributes::names() const {
  std::vector<std::string> result;
  if (!uv.empty()) result.push_back("uv");
  if (!uv2.empty()) result.push_back("uv2");
  if (!normal.empty()) result.push_back("normal");
  if (!color.empty()) result.push_back("color");
  if (!group.empty()) result.push_back("group");
  return result;
}

Vec3 face_normal(const Vec3& a, const Vec3& b, const Vec3& c) {
  return (b - a).stableNormalized().cross((c - a).stableNormalized()).stableNormalized();
}

void transfer_attributes(const TriangleMesh& original, TriangleMesh& derived) {
  const Attributes& from = original.attributes;
  const std::size_t count = derived.triangles.size();
  if (derived.source.size() != count)
    throw InputError("the cut surface does not name the triangles that it is made of");
  for (const auto row : derived.source)
    if (row != ~0u && row >= original.triangles.size())
      throw InputError("the cut surface names triangle " + std::to_string(row) + ", but the model has " +
                       std::to_string(original.triangles.size()) + "; give the model that was cut");
  Attributes to;
  to.group_names = from.group_names;
  to.materials = from.materials;
  to.library = from.library;
  derived.unit = original.unit;
  if (!from.uv.empty()) to.uv.resize(count);
  if (!from.uv2.empty()) to.uv2.resize(count);
  if (!from.normal.empty()) to.normal.resize(count);
  if (!from.color.empty()) to.color.resize(count);
  if (!from.group.empty()) to.group.resize(count);
  std::int32_t crack = -1;  // index of the group, once needed
  for (std::size_t t = 0; t < count && !from.empty(); ++t) {
    const auto corners = corners_of(derived, t);
    const std::uint32_t row = derived.source[t];
    if (row == ~0u) {
      if (!to.uv.empty()) to.uv[t].fill(Vec2::Zero());
      if (!to.uv2.empty()) to.uv2[t].fill(Vec2::Zero());
      if (!to.normal.empty()) to.normal[t].fill(face_normal(corners[0], corners[1], corners[2]));
      if (!to.color.empty()) to.color[t].fill(crack_color);
      if (to.group.empty()) continue;
      if (crack < 0) {
        const auto at = std::find(to.group_names.begin(), to.group_names.end(), crack_group);
        crack = static_cast<std::int32_t>(at - to.group_names.begin());
        if (at == to.group_names.end()) to.group_names.push_back(crack_group);
      }
      to.group[t] = crack;
      continue;
    }
    const bool behind = !derived.patch.empty() && derived.patch[t] < 0;
    const std::uint32_t s = behind ? other_side(original, row) : row;
    const auto source = corners_of(original, s);
    if (!to.group.empty()) to.group[t] = from.group[s];
    for (int k = 0; k < 3; ++k) {
      const Location at = locate(source, corners[k]);
      if (!to.uv.empty()) to.uv[t][k] = interpolated(from.uv[s], at);
      if (!to.uv2.empty()) to.uv2[t][k] = interpolated(from.uv2[s], at);
      if (!to.color.empty()) to.color[t][k] = interpolated(from.color[s], at);
      if (to.normal.empty()) continue;
      Vec3 n = interpolated(from.normal[s], at);
      if (!constant(from.normal[s], at))
        n = n.norm() > 0 ? n.normalized() : face_normal(source[0], source[1], source[2]);
      to.normal[t][k] = behind && s == row ? Vec3(-n) : n;
    }
  }
  for (auto& row : derived.source)
    if (row != ~0u) row = source_of(original, row);
  derived.attributes = std::move(to);
}

}  // namespace geo
