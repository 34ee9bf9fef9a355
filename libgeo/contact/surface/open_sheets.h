// Sheets that lie on each other come apart.
#pragma once

#include "contact/surface/contact_surface.h"

namespace geo {

/// Copies (those together) whose targets `to` come apart by more than `opens`, or slide along each other by three times
/// that, are moved apart by half a gap each into their own material: away from what they share, or along the sum of
/// their normals where that does not help. Where a triangle would cross another for it they stay together. `fans`: of
/// the surface; lengths in model units. Returns how many came apart.
std::size_t open_sheets(const ContactSurface& surface, const VertexFans& fans, const Copies& copies,
                        const std::vector<Vec3>& to, double gap, double opens, std::vector<Vec3>& positions);

}  // namespace geo
