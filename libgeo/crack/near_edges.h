// Edges of K beside which a strip passes: divided there, so that the strip can go through them.
#pragma once

#include "crack/sweep.h"

namespace geo::crack {

/// The edit that divides edges of K where edges or free points of the strip are nearer than `reach`
/// (model units), at the points closest to them. Places that are as near to a vertex of K or to a
/// fixed point of the strip stay: snap_to_vertices() sees to these. So do edges on the line of the
/// old front. Empty where there are none, where the strip lies in a sheet, and where rounding would
/// make faces of K cross.
///
/// A sheet that runs along an edge, but not in it, leaves slivers between the two: lower than
/// weights of nodes resolve, they fold as soon as the material deforms. Precondition: `strip.near`.
ComplexEdit divide_near_edges(const Complex& complex, const Strip& strip, double reach);

}  // namespace geo::crack
