// Finds where deforming bodies of one scene touch each other (§ 3.3, contact between deforming
// bodies).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "contact/response/body_contact_penalty.h"
#include "contact/surface/surface_weights.h"

namespace geo {

/// The bodies when a step begins, as components of one Body. Refers to everything.
struct BodyContactInput {
  const Body& body;
  const Solid& solid;
  const SurfaceWeights& weights;
  const std::vector<std::uint32_t>& body_index;  ///< per node
  const std::vector<Vec3>& displacement;         ///< per node
};

/// Strength and search distance.
struct BodyContactOptions {
  double pressure = 1e6;  ///< pressure over depth, Pa/m
  double friction = 0.3;  ///< Coulomb's coefficient
  /// Largest distance from, or depth in, another body at which vertices are considered, model
  /// units: at least the approach of bodies in a step plus a node spacing.
  double reach = 0;
  double slip_regularisation = 0;  ///< model units (contact_law.h)
  /// Per node, factor of the pressure on the surface that it carries; the larger one of the two
  /// sides acts. Empty: 1.
  std::span<const double> pressure_factor = {};
};

/// Contacts of all surface vertices that are inside another body. A vertex is mapped back to that
/// body's material (inverse_deformation.h), where the nearest point of its undeformed surface is
/// looked for. So the distance field follows cuts, needs no update, and is exact at corners and in
/// thin parts. Sheets of a crack count where they are open wider than the vertex is deep. Vertices
/// of both bodies are treated so, each with half the pressure.
BodyContactPenalty find_body_contacts(const BodyContactInput& input, const BodyContactOptions& options);

}  // namespace geo
