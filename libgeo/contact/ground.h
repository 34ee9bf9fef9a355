// A plane under the body: a penalty on each vertex of the surface that is below it, with Coulomb friction (§ 3.3, between objects).
#pragma once

#include "contact/surface_weights.h"
#include "mechanics/potential.h"

namespace geo {

struct GroundOptions {
  Vec3 point = Vec3::Zero(), normal = Vec3::UnitZ();  ///< the normal, of any length, points to where the body may be
  double pressure = 1e6;  ///< Pa for a metre of depth: a body that presses with p stands p / pressure deep, in model units
  double friction = 0.5;  ///< Coulomb's coefficient
};

/// ½ pressure area depth² at each surface vertex, area being a third of its triangles' at rest. Friction acts on the way since
/// the step began, with the normal force of that moment: that is the derivative of a convex potential (Li et al. 2020, § 5).
class Ground : public Potential {
 public:
  explicit Ground(const GroundOptions& options);

  /// For a step that begins at displacements u: which vertices may reach the ground (those nearer than `reach`), their weights
  /// and areas, and how hard each presses now. `slow`: a way along the ground, model units, below which friction is smooth.
  void begin(const Body& body, const SurfaceWeights& weights, const std::vector<Vec3>& u, double reach, double slow);

  double energy(const std::vector<Vec3>& u) const override;
  void force(const std::vector<Vec3>& u, std::vector<Vec3>& out) override;
  void blocks(std::vector<Mat3>& out) const override;
  void multiply(const std::vector<Vec3>& p, std::vector<Vec3>& out) const override;

  /// Deepest vertex below the plane, at displacements u; 0: none.
  double depth(const std::vector<Vec3>& u) const;

 private:
  struct Row {
    std::span<const SurfaceWeights::Entry> weights;
    double height;     // of the undeformed vertex over the plane
    double stiffness;  // N/m
    double pressed;    // N, when the step began
    Vec3 start;        // its displacement then
    Mat3 curvature;    // of the last force()
  };
  static Vec3 at(const Row& row, const std::vector<Vec3>& values) {
    Vec3 sum = Vec3::Zero();
    for (const auto& e : row.weights) sum += e.weight * values[e.node];
    return sum;
  }

  GroundOptions options_;
  double slow_ = 0;
  std::vector<Row> rows_;
};

}  // namespace geo
