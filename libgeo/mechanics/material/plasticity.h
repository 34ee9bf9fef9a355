// Plasticity with an additive split of the Green strain (O'Brien, Bargteil and Hodgins 2002; Müller
// et al. 2004, § 3.7).
#pragma once

#include "kerf/material.h"

namespace geo {

/// (1 + 2 ε)^(−1/2), ε the plastic Green strain: the symmetric inverse of the plastic stretch.
/// Elasticity sees F times it. Eigenvalues of 1 + 2 ε are bounded from below by 0.01, so that no
/// plastic stretch is smaller than a tenth.
Mat3 inverse_plastic_stretch(const Mat3& plastic);

/// The plastic strain after dt seconds at deformation gradient F. If the elastic strain ½ (FᵀF − 1)
/// − ε exceeds the yield (Frobenius norm), its fraction min(1, creep · dt) becomes plastic; the
/// result's norm is at most max_plastic.
Mat3 plastic_flow(const Material& material, const Mat3& plastic, const Mat3& f, double dt);

}  // namespace geo
