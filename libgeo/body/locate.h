// Point location and visibility in the crack complex, by exact predicates.
#pragma once

#include <array>
#include <functional>
#include <span>
#include <vector>

#include "kerf/body.h"

namespace geo {

/// Appends the triangles of K whose boxes meet a box.
void triangles_near(const Complex& complex, const Box3& box, std::vector<std::array<Vec3, 3>>& out);
/// The same as a function of the box. Refers to the complex, which must outlive it.
std::function<void(const Box3&, std::vector<std::array<Vec3, 3>>&)> triangles_near(const Complex& complex);

/// True when the face touches the closed segment pq.
bool touches(const Complex& complex, FaceId f, const Vec3& p, const Vec3& q);

/// True when a face, other than `except`, touches the closed segment pq.
bool is_blocked(const Complex& complex, const Vec3& p, const Vec3& q, FaceId except = {});

/// Visibility along segments within a box, whose faces are read once. Each query tests all of them,
/// so it suits small boxes.
class BoxVisibility {
 public:
  /// Reads the faces in `box`, without those in `except` (ascending).
  BoxVisibility(const Complex& complex, const Box3& box, std::span<const FaceId> except = {});
  /// Reads `faces`, as if there were no others.
  BoxVisibility(const Complex& complex, std::span<const FaceId> faces);
  /// As is_blocked(). Precondition: the segment lies in the box, if there is one.
  bool blocked(const Vec3& p, const Vec3& q) const;

 private:
  std::vector<std::array<Vec3, 3>> triangles_;
  std::vector<Box3> boxes_;
};

/// True when p is in the material in front of side s: on that side of the face's plane, and no
/// other face touches the segment from p to `base` on the face. The face itself is left out because
/// `base` is rounded.
bool is_in_front(const Complex& complex, Side s, const Vec3& base, const Vec3& p);

/// The label of the piece that p is in, −1: none. `piece` gives labels of sides with material.
/// Decided by topology: p is in the piece whose whole boundary winds around it. The winding number
/// is counted along a line from p out of the complex, with ties broken symbolically. So a sliver
/// whose sheets rounding has exchanged contains no point, and does not change the answer for
/// others.
std::int32_t piece_containing(const Complex& complex, const Vec3& p, const std::function<std::int32_t(Side)>& piece);

/// True when p is strictly inside the material.
bool is_inside(const Complex& complex, const Vec3& p);

}  // namespace geo
