// Blades that go back in their own cut: the material moves after them, or they are pulled out.
#pragma once

#include <span>
#include <vector>

#include "kerf/complex.h"
#include "kerf/simulation.h"

namespace geo {

/// Holds the points of a front that would go back along the sheet behind it: where `to` is nearer
/// to the sheet than half its distance from the front, and nearer than a quarter of the spacing.
/// They keep their places in the front, since no blade makes a cut undone, and a sheet that folds
/// back on itself cuts off crumbs. A point between two that are held is held, too. Points in air go
/// with the nearest point in the material. `spacing`: of the nodes at each point, model units.
/// Returns the number of points held.
std::size_t hold_retreating(const Complex& surface, const FrontState& front, std::span<const double> spacing,
                            std::vector<Vec3>& to);

/// Holds the points that would stay on the line of their front, nearer to it than a sheet snaps
/// (snap_spacings): where an edge slides along itself, or a point is inserted between two that
/// rest. The strip has no area but that of rounding, and would leave material between its sides.
/// `spacing`: of the nodes at each point, model units.
void hold_sliding(const FrontState& front, std::span<const double> spacing, std::vector<Vec3>& to);

/// Whether the way from a point of a front to `to` leads back along the sheet of its crack.
/// `spacing`: of the nodes there.
bool leads_back(const Complex& surface, const FrontState& front, const Vec3& from, const Vec3& to, double spacing);

}  // namespace geo
