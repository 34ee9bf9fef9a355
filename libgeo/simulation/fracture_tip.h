// The field of stress about a point of a crack's front, from how the nodes around it have moved.
#pragma once

#include "kerf/body.h"
#include "kerf/material.h"

namespace geo {

/// A right-handed frame at a point of a front, in material coordinates: ahead in the crack's plane, normal to that
/// plane, and along the front (ahead × normal).
struct TipFrame {
  Vec3 at, ahead, normal;
  Vec3 along() const { return ahead.cross(normal); }
};

/// What is around a tip: a uniform stress, and the three singular modes of a sharp crack (Williams 1957). Stresses are
/// Cauchy's, turned back by the material's rotation, in the tip's frame. So a flaw too small for the nodes to see has
/// the stress of its surroundings, and a long crack its stress intensities, whatever the sampling.
struct TipField {
  Mat3 uniform = Mat3::Zero();  ///< Pa
  Vec3 k = Vec3::Zero();        ///< K_I, K_II, K_III; Pa √m
  double support = 0;           ///< support radius h here, model units
  std::size_t nodes = 0;        ///< how many nodes tell it; fewer than four: the field is zero
  std::uint32_t node = 0;       ///< one of these: the tip is in its body

  /// Stress across the half-plane at `angle` from straight ahead, at the distance where K / √(2πr) is its own average
  /// over 0 < r < h, h/4: the uniform part's share, and the modes'. Pa.
  double hoop(double angle) const;
  struct Strongest {
    double angle, stress;  ///< radians, towards +normal; Pa
  };
  /// Where the hoop stress is largest (Erdogan and Sih 1963; with the uniform part Smith, Ayatollahi and Pavier 2001).
  Strongest strongest() const;
};

/// The displacements of a uniform gradient and of unit stress intensities are fitted to those of the nodes that a point
/// a little ahead of the tip sees, within two support radii, by weighted least squares (moving least squares with the
/// modes in its basis: Fleming, Chu, Moran and Belytschko 1997). `u`: per node. Where the nodes move as linear
/// elasticity says, the answer is exact. A crack that nodes see carries no traction: as far as there is crack straight
/// behind the tip, the uniform stress keeps only what does not pull at its faces (Williams' second term).
TipField tip_field(const Body& body, const std::vector<Vec3>& u, const Materials& materials, const TipFrame& tip);

/// Displacement that a stress intensity of 1 in each mode gives a point at (r, angle) from the tip, plane strain, in
/// the tip's frame: one column a mode.
Mat3 mode_displacement(const Material& material, double r, double angle);

/// The stress of mode 0, 1 or 2 there, in the tip's frame, for a stress intensity of 1.
Mat3 mode_stress(double poisson, int mode, double r, double angle);

}  // namespace geo
