// Measures of a local edit: quality of its triangles, deviation of its surface.
#pragma once

#include <array>
#include <utility>

#include "crack/features.h"
#include "crack/local_edit.h"

namespace geo::crack {

/// The cotangent of a triangle's smallest angle: smaller is better.
double smallest_angle_cotangent(const std::array<Vec3, 3>& t);

/// The largest smallest_angle_cotangent() of the faces at v, before and after moving v to p. Faces
/// that also have `into` are left out after the move: they vanish.
std::pair<double, double> worst_if_moved(const Complex& complex, VertexId v, const Vec3& p, VertexId into = {});
/// The largest smallest_angle_cotangent() of the faces that an edit removes.
double worst_removed(const Complex& complex, const LocalEdit& local);
/// The largest smallest_angle_cotangent() of the faces that an edit makes.
double worst_new(const Complex& complex, const LocalEdit& local);

/// Distance of p, a point of the old surface, from the new faces of an edit: max over the surfaces
/// (cracks, skin) of min over their new faces of |p − face|. Preserved skin does not count: it
/// stays in its planes.
double deviation_at(const Complex& complex, const LocalEdit& local, const Vec3& p, const FeatureRules& rules);

}  // namespace geo::crack
