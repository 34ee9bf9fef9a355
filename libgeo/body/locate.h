// Where a point is with respect to the complex: which side of which face it looks at.
#pragma once

#include "body/body.h"

namespace geo {

/// The triangles of K whose boxes meet a box, as update_graph asks for them.
void triangles_near(const Complex& complex, const Box3& box, std::vector<std::array<Vec3, 3>>& out);

/// True when a face, other than `except`, touches the closed segment pq: exact, through the complex's index.
bool is_blocked(const Complex& complex, const Vec3& p, const Vec3& q, FaceId except = {});

/// True when p is on the given side of the face and nothing else touches the segment from there to `base` on the face:
/// then p is in the material before that side. The face itself is left out because its own point is rounded.
bool stands_before(const Complex& complex, Side s, const Vec3& base, const Vec3& p);

/// The side that one sees from p when looking at the middle of a near face: the point is in that side's piece, or, when
/// the side has no material, outside. `reach`: how far to look first; it is widened until a face is found.
Side side_seen_from(const Complex& complex, const Vec3& p, double reach);

/// True when p is strictly inside the material.
bool is_inside(const Complex& complex, const Vec3& p, double reach);

}  // namespace geo
