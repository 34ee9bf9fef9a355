// Winding numbers along an axis-parallel line from the point out of the complex: Σ ±1 over the
// faces that it meets. The line is displaced by ε and ε² symbolically (Edelsbrunner and Mücke
// 1990), so that it meets no edge.
#include "body/locate.h"

#include <algorithm>
#include <limits>

#include "geometry/predicates.h"

namespace geo {

void triangles_near(const Complex& complex, const Box3& box, std::vector<std::array<Vec3, 3>>& out) {
  std::vector<FaceId> faces;
  complex.faces_near(box, faces);
  for (const FaceId f : faces) out.push_back(complex.corners(f));
}

std::function<void(const Box3&, std::vector<std::array<Vec3, 3>>&)> triangles_near(const Complex& complex) {
  return [&complex](const Box3& box, std::vector<std::array<Vec3, 3>>& out) { triangles_near(complex, box, out); };
}

bool touches(const Complex& complex, FaceId f, const Vec3& p, const Vec3& q) {
  const auto t = complex.corners(f);
  return segment_meets_triangle(p, q, t[0], t[1], t[2]);
}

bool is_blocked(const Complex& complex, const Vec3& p, const Vec3& q, FaceId except) {
  Box3 box{p, p};
  box.add(q);
  std::vector<FaceId> faces;
  complex.faces_near(box, faces);
  return std::any_of(faces.begin(), faces.end(), [&](FaceId f) { return f != except && touches(complex, f, p, q); });
}

namespace {

// The faces whose boxes meet `box`, without those in `except` (ascending).
std::vector<FaceId> faces_in(const Complex& complex, const Box3& box, std::span<const FaceId> except) {
  std::vector<FaceId> faces;
  complex.faces_near(box, faces);
  std::erase_if(faces, [&](FaceId f) { return std::binary_search(except.begin(), except.end(), f); });
  return faces;
}

}  // namespace

BoxVisibility::BoxVisibility(const Complex& complex, const Box3& box, std::span<const FaceId> except)
    : BoxVisibility(complex, faces_in(complex, box, except)) {}

BoxVisibility::BoxVisibility(const Complex& complex, std::span<const FaceId> faces) {
  for (const FaceId f : faces) {
    triangles_.push_back(complex.corners(f));
    boxes_.push_back(complex.box(f));
  }
}

bool BoxVisibility::blocked(const Vec3& p, const Vec3& q) const {
  Box3 segment{p, p};
  segment.add(q);
  for (std::size_t k = 0; k < triangles_.size(); ++k)
    if (boxes_[k].meets(segment) && segment_meets_triangle(p, q, triangles_[k][0], triangles_[k][1], triangles_[k][2]))
      return true;
  return false;
}

bool is_in_front(const Complex& k, Side s, const Vec3& base, const Vec3& p) {
  const auto own = k.corners(s.face);
  return k.has(s) && orient3d(own[0], own[1], own[2], p) == (s.which ? 1 : -1) && !is_blocked(k, base, p, s.face);
}

std::int32_t piece_containing(const Complex& complex, const Vec3& p, const std::function<std::int32_t(Side)>& piece) {
  // Along the axis on which the way out is shortest.
  const Box3& extent = complex.extent();
  int axis = 0;
  double shortest = std::numeric_limits<double>::infinity();
  bool up = true;
  for (int i = 0; i < 3; ++i)
    for (const bool above : {true, false})
      if (const double d = above ? extent.hi[i] - p[i] : p[i] - extent.lo[i]; d < shortest) {
        shortest = d;
        axis = i;
        up = above;
      }
  Box3 line{p, p};
  const double beyond = std::max(shortest, 0.0) + extent.diagonal();
  (up ? line.hi : line.lo)[axis] += up ? beyond : -beyond;
  std::vector<FaceId> faces;
  complex.faces_near(line, faces);
  const int u = axis == 2 ? 0 : axis + 1, v = axis == 0 ? 2 : axis - 1;
  // The turn from edge ab to the line, which stands an infinitesimal ε off along u and ε² along v.
  const auto turn = [&](const Vec3& a, const Vec3& b) {
    if (const int sign = orient2d(a, b, p, axis); sign != 0) return sign;
    if (a[v] != b[v]) return a[v] > b[v] ? 1 : -1;
    return a[u] != b[u] ? (b[u] > a[u] ? 1 : -1) : 0;
  };
  std::vector<std::pair<std::int32_t, int>> windings;
  const auto count = [&](Side s, int by) {
    const auto of = complex.has(s) ? piece(s) : -1;
    if (of < 0) return;
    const auto at = std::find_if(windings.begin(), windings.end(), [&](const auto& w) { return w.first == of; });
    if (at == windings.end())
      windings.push_back({of, by});
    else
      at->second += by;
  };
  for (const FaceId f : faces) {
    const auto t = complex.corners(f);
    const int facing = turn(t[0], t[1]);
    if (facing == 0 || turn(t[1], t[2]) != facing || turn(t[2], t[0]) != facing) continue;
    const int before = up ? -facing : facing;  // where p is when the line meets the face
    if (orient3d(t[0], t[1], t[2], p) != before) continue;
    count({f, before > 0 ? 1 : 0}, 1);
    count({f, before > 0 ? 0 : 1}, -1);
  }
  // Rounding may have exchanged two sheets: several pieces then contain p, and a crumb that is
  // inside out counts −1. The piece with the largest winding number is taken if the sum is
  // positive.
  int sum = 0;
  std::pair<std::int32_t, int> most{-1, 0};
  for (const auto& w : windings) {
    sum += w.second;
    if (w.second > most.second || (w.second == most.second && w.first < most.first)) most = w;
  }
  return sum > 0 ? most.first : -1;
}

bool is_inside(const Complex& complex, const Vec3& p) {
  return piece_containing(complex, p, [](Side) { return 0; }) == 0 && !is_blocked(complex, p, p);
}

}  // namespace geo
