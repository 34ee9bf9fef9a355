// The stress field around a point of a crack front, fitted to the displacements of nearby nodes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "kerf/body.h"
#include "kerf/material.h"

namespace geo {

/// A right-handed frame at a point of a front, in material coordinates: `ahead` in the crack plane,
/// `normal` to it, and ahead × normal along the front.
struct TipFrame {
  Vec3 at, ahead, normal;
  /// Direction along the front.
  Vec3 along() const { return ahead.cross(normal); }
};

/// Stress around a crack tip: a uniform part, and the three singular modes of a sharp crack
/// (Williams 1957). Cauchy stress, without the material's rotation, in the tip's frame. A flaw that
/// the nodes do not resolve thus has the stress of its surroundings, and a long crack has its
/// stress intensities, whatever the sampling. Symbols: K_I, K_II, K_III stress intensities of
/// opening, in-plane shear and out-of-plane shear; r, angle polar coordinates about the tip from
/// `ahead`.
struct TipField {
  Mat3 uniform = Mat3::Zero();  ///< Pa
  Vec3 k = Vec3::Zero();        ///< K_I, K_II, K_III; Pa √m
  double support = 0;           ///< support radius h of the nodes here, model units
  std::size_t nodes = 0;        ///< number of nodes fitted; the stress is zero below four, K below eight
  std::uint32_t node = 0;       ///< the lowest of their indices: a node of the tip's body

  /// Hoop stress, Pa, across the half-plane at `angle` (radians, towards +normal from straight
  /// ahead), at r = h/4: there K / √(2πr) is its own mean over 0 < r < h.
  double hoop(double angle) const;
  /// The direction in which a crack grows, and the stress that decides whether it does.
  struct Strongest {
    double angle, stress;  ///< radians; Pa
  };
  /// The largest hoop stress within 85° of straight ahead (Erdogan and Sih 1963; with the uniform
  /// part Smith, Ayatollahi and Pavier 2001).
  Strongest strongest() const;
};

/// Finds K_I, K_II, K_III from the rotation of the material at the tip; empty where it cannot.
using Intensities = std::function<std::optional<Vec3>(const Mat3& rotation)>;

/// Fits the displacements of a uniform gradient and of unit stress intensities to those of the
/// nodes within two support radii that a point just ahead of the tip sees, by weighted least
/// squares (moving least squares enriched with the modes: Fleming, Chu, Moran and Belytschko 1997).
/// Exact where the nodes move as linear elasticity predicts. The crack faces carry no traction: by
/// the share of crack straight behind the tip, the uniform stress loses its traction on them
/// (Williams' second term remains). `u`: displacement per node. `intensities`, where given, finds
/// the stress intensities from the rotation of the material at the tip, where there is crack from
/// one support radius to three straight behind it; there is no uniform part then. Where it is
/// empty, all is fitted. A fit takes the gradient of stress in bending for a part of the modes: it
/// is up to a third too high where twenty spacings or less lie across a body.
TipField tip_field(const Body& body, const std::vector<Vec3>& u, const Materials& materials, const TipFrame& tip,
                   const Intensities& intensities = {});

/// Displacements at (r, angle) of unit stress intensities, plane strain, in the tip's frame: one
/// column for each mode.
Mat3 mode_displacement(const Material& material, double r, double angle);

/// The derivatives of mode_displacement() in the direction ahead, dimensionless over Pa √m.
Mat3 mode_slope(const Material& material, double r, double angle);

/// Stress at (r, angle) of a unit stress intensity of mode 0, 1 or 2, in the tip's frame.
Mat3 mode_stress(double poisson, int mode, double r, double angle);

}  // namespace geo
