// Plasticity (O'Brien, Bargteil and Hodgins 2002; Müller et al. 2004, § 3.7): the strain that a point does not spring
// back from.
#pragma once

#include "kerf/material.h"

namespace geo {

/// (1 + 2 ε)^(−1/2), which takes the shape that a point of plastic strain ε (Green) has come to rest in back to where
/// it was: elasticity sees F times it. Symmetric. Strains are limited, so that no direction shrinks below a tenth.
Mat3 relaxation(const Mat3& plastic);

/// The plastic strain after a time at deformation gradient F: where the elastic part of the strain, ½ (FᵀF − 1) − ε, is
/// larger than the yield (Frobenius norm), its share creep · dt flows (all of it at most), until the most plastic
/// strain.
Mat3 flow(const Material& material, const Mat3& plastic, const Mat3& f, double dt);

}  // namespace geo
