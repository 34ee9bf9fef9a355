// Momentum of what is touched: the translation that a Newton direction lacks.
//
// Conjugate gradients stop at an accuracy of displacements. In a time step Δt an error e of the
// whole body's displacement is an error e / Δt² of its acceleration, which may be as large as
// friction. Internal forces move no centre of mass, so the few equations of the centres can be
// solved exactly.
#pragma once

#include <vector>

#include "mechanics/solver/incremental_potential.h"

namespace geo {

/// Adds to a Newton direction from u on the translation of each free-floating island that contact
/// touches and nothing clamps, so that forces, inertia and contact balance on it to first order:
/// Σ_g (M_f/Δt² δ_fg + Σ_k W_kf W_kg H_k) t_g = R_f, with M_f its mass, R_f the residual of its
/// nodes' sum without internal forces, H_k the Hessians of contact and W_kf the sum of the weights
/// of stencil k in island f. `active`: islands that the direction moves.
void balance_momentum(const IncrementalPotential& potential, const ActiveIslands& active, const std::vector<Vec3>& u,
                      std::vector<Vec3>& direction);

}  // namespace geo
