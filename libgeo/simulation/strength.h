// Resistance to fracture: variation of the strength, boxes without fracture, Rayleigh speed, stress
// of a toughness. Used by fracture_step.cpp and fracture_start.cpp.
#pragma once

#include <cstdint>

#include "kerf/material.h"
#include "kerf/scene.h"
#include "kerf/vec.h"

namespace geo {

/// Factor on strength and toughness at x, material coordinates: max(0.05, 1 + variation · noise).
/// `diagonal`: of the box of all bodies before any cut, model units; a tenth of it is the default
/// length scale of the noise.
double strength_factor(const Strength& strength, std::uint64_t seed, double diagonal, const Vec3& x);

/// False where x, material coordinates, is in or on a box of fracture.off.
bool may_break(const FractureOptions& fracture, const Vec3& x);

/// Speed of the Rayleigh wave at rest, model units per second: c_s (0.862 + 1.14 ν) / (1 + ν), with
/// c_s the speed of shear waves (Freund 1990, § 2.1).
double rayleigh_speed(const Material& material);

/// Speed of pressure waves at rest, model units per second.
double pressure_wave_speed(const Material& material);

/// Mean stress over a length h ahead of a crack tip at which the stress intensity K reaches
/// `toughness`: the mean of K / √(2 π r) over 0 < r < h, K √(2 / (π h)) (Taylor 2007, line method).
double stress_of_toughness(double toughness, double h);

}  // namespace geo
