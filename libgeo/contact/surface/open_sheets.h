// Opens closed sheets: separates coincident vertices whose targets come apart.
#pragma once

#include "contact/surface/moving_surface.h"

namespace geo {

/// A vertex opens if the targets `to` of two of its coincident copies are more than `opening` apart
/// along the normals across the sheet, or more than 3 · `opening` across these. Each copy then
/// moves by at most half a gap: against the normal across the sheet, against the normal of all its
/// triangles, or to its target. Copies whose triangles would cross others stay coincident. `fans`:
/// of the surface; `coincidence`: at `positions`. Lengths in model units. Changes `positions` and
/// returns the number of representatives that were opened.
std::size_t open_sheets(const ContactSurface& surface, const VertexFans& fans, const Coincidence& coincidence,
                        const std::vector<Vec3>& to, double gap, double opening, std::vector<Vec3>& positions);

}  // namespace geo
