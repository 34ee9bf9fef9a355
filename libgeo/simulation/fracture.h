// When and where a body breaks by its own stress (Pauly et al. 2005; O'Brien and Hodgins 1999): what a scene says of it.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "mechanics/elasticity.h"

namespace geo {

/// What it takes to break a body.
struct Strength {
  double strength = 1e4;   ///< Pa: largest principal stress, averaged over the support radius, at which a crack begins
  double toughness = 0;    ///< Pa √m: K_Ic at which a crack goes on; 0: strength · √(π h/2), h the support radius at the tip
  double variation = 0.2;  ///< of strength and toughness: they are multiplied by 1 + variation · noise in about [−1, 1]
  double grain = 0;        ///< size of the noise, model units; 0: a tenth of the diagonal of all bodies
  friend bool operator==(const Strength&, const Strength&) = default;
};

struct Fracture : Strength {
  bool on = false;
  std::vector<Strength> own;  ///< per body of the scene; empty: all have the same
  double speed = 0.55;     ///< the fastest a crack gets, as a share of the Rayleigh wave's speed
  double branching = 0;    ///< a front divides where the stress ahead is this many times what it needs; 0: never
  double apart = 4;        ///< no crack begins nearer to another than this many node spacings
  int cracks = 24;         ///< how many may begin in all, branches included
  int cracks_per_step = 1;
  double start = 0;        ///< seconds: nothing breaks before
  std::vector<std::array<Vec3, 2>> off;  ///< boxes, material coordinates, where no crack begins or goes on
  std::uint64_t seed = 1;
  /// Of a node. `part`: per node, its body.
  const Strength& of(const std::vector<std::uint32_t>& part, std::size_t node) const { return own.empty() ? *this : own[part[node]]; }
};

/// By how much strength and toughness at material point x differ from what the scene says; ≥ 0.05. `diagonal`: of all bodies.
double strength_factor(const Strength& strength, std::uint64_t seed, double diagonal, const Vec3& x);

/// False where the scene says that nothing breaks.
bool may_break(const Fracture& fracture, const Vec3& x);

/// Speed of the Rayleigh wave at rest, model units per second: c_s (0.862 + 1.14 ν) / (1 + ν) (Freund 1990, § 2.1).
double rayleigh_speed(const Material& material);

/// The stress, averaged over a length h ahead of a tip, at which K reaches `toughness`: K √(2 / (π h)), the mean of
/// K / √(2 π r) over 0 < r < h (Taylor 2007, the line method).
double stress_of_toughness(double toughness, double h);

}  // namespace geo
