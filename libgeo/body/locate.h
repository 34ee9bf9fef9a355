// Where a point is with respect to the complex: what is in its way, before which side it stands, in
// which piece it is.
#pragma once

#include <functional>

#include "kerf/body.h"

namespace geo {

/// Appends the triangles of K whose boxes meet a box.
void triangles_near(const Complex& complex, const Box3& box, std::vector<std::array<Vec3, 3>>& out);
/// The same as a function of the box. Refers to the complex, which must outlive it.
std::function<void(const Box3&, std::vector<std::array<Vec3, 3>>&)> triangles_near(const Complex& complex);

/// True when the face touches the closed segment pq: exact.
bool touches(const Complex& complex, FaceId f, const Vec3& p, const Vec3& q);

/// True when a face, other than `except`, touches the closed segment pq: exact, through the
/// complex's index.
bool is_blocked(const Complex& complex, const Vec3& p, const Vec3& q, FaceId except = {});

/// The same for many segments within a box: its faces are read once. For few segments, or near each
/// other.
class SightIn {
 public:
  SightIn(const Complex& complex, const Box3& box);
  bool blocked(const Vec3& p, const Vec3& q) const;

 private:
  std::vector<std::array<Vec3, 3>> triangles_;
  std::vector<Box3> boxes_;
};

/// True when p is on the given side of the face and nothing else touches the segment from there to
/// `base` on the face: then p is in the material before that side. The face itself is left out
/// because its own point is rounded.
bool stands_before(const Complex& complex, Side s, const Vec3& base, const Vec3& p);

/// The piece that p is in, −1: none. `piece` numbers the sides with material. Decided by topology:
/// p is where a piece's whole boundary winds around it, counted along a line from p out of the
/// complex by exact predicates, with ties broken symbolically. So a crumb whose sheets rounding has
/// exchanged holds no point, and hides from none which piece it is in.
std::int32_t piece_around(const Complex& complex, const Vec3& p, const std::function<std::int32_t(Side)>& piece);

/// True when p is strictly inside the material.
bool is_inside(const Complex& complex, const Vec3& p);

}  // namespace geo
