// Mean and slope of a traction are weighted sums over points, whose weights depend on the
// undeformed material alone: they are found once, and again where a cut has changed the points.
#include "simulation/bond_loads.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "body/incremental_cache.h"
#include "body/locate.h"
#include "geometry/distance.h"
#include "kerf/parallel.h"
#include "mechanics/material/plasticity.h"
#include "mechanics/solver/solid_discretisation.h"
#include "sampling/node_grid.h"

namespace geo {
namespace {

// Two columns that span the plane of a wall.
using Plane = Eigen::Matrix<double, 3, 2>;

Plane plane_of(const Vec3& normal) {
  Plane axes;
  axes.col(0) = normal.unitOrthogonal();
  axes.col(1) = normal.cross(axes.col(0));
  return axes;
}

// A point near a wall.
struct NearPoint {
  std::uint32_t point;
  double weight;
  Vec2 at;  // along the wall, about its centroid
};

// How far from a wall points count, in node spacings: about the support of a node, over which the
// stress of points scatters. In a bar four nodes across, mean tractions are right to a hundredth,
// and scatter looks like a bending of 8 % (docs/decisions/098).
constexpr double averaging_reach = 1.5;

// A slope counts if the points lie apart in its direction by at least this share of the larger
// extent, squared: with fewer, noise of the stress makes slopes out of nothing.
constexpr double least_spread = 0.05;

// The weights of points in the mean and the slope of the linear field that fits values at them.
struct FitWeights {
  double mean;
  Vec2 slope;
};

std::vector<FitWeights> fit(const std::vector<NearPoint>& near) {
  double total = 0, spread = 0;
  for (const NearPoint& n : near) {
    total += n.weight;
    spread += n.weight * n.at.squaredNorm();
  }
  const double length = spread > 0 ? std::sqrt(spread / total) : 1;
  const auto row = [&](const NearPoint& n) { return Vec3(1, n.at.x() / length, n.at.y() / length); };
  Mat3 moment = Mat3::Zero();
  for (const NearPoint& n : near) moment += n.weight / total * row(n) * row(n).transpose();
  const Eigen::SelfAdjointEigenSolver<Mat3> eigen(moment);
  Mat3 inverse = Mat3::Zero();
  for (int k = 0; k < 3; ++k) {
    const Vec3 axis = eigen.eigenvectors().col(k);
    if (eigen.eigenvalues()[k] > least_spread * eigen.eigenvalues()[2])
      inverse += axis * axis.transpose() / eigen.eigenvalues()[k];
  }
  std::vector<FitWeights> weights;
  for (const NearPoint& n : near) {
    const Vec3 w = n.weight / total * inverse * row(n);
    weights.push_back({.mean = w.x(), .slope = w.tail<2>() / length});
  }
  return weights;
}

}  // namespace

double BondLoad::effective(double friction) const {
  const double tension = normal + bending;
  if (tension > 0) return std::hypot(tension, shear);
  return std::max(0.0, shear + friction * tension);
}

// The material points of a solid by position.
class BondLoads::Surroundings {
 public:
  Surroundings(const Body& body, const MaterialPoints& points) : body_(body), points_(points) {
    for (std::uint32_t b = 0; b < points.blocks.size(); ++b)
      for (std::uint32_t i = 0; i < points.blocks[b].points.size(); ++i) {
        const MaterialPoint& point = points.blocks[b].points[i];
        if (point.quality == MomentQuality::singular) continue;
        position_.push_back(point.position);
        place_.push_back({.block = b, .index = i});
      }
    if (!position_.empty()) grid_ = NodeGrid(body.finest_spacing, position_);
  }

  const std::vector<Point>& places() const { return place_; }

  // The points near a bond's wall that see it.
  std::vector<NearPoint> near(const GluedBond& bond, const std::vector<Vec3>& corners) const {
    const auto node =
        body_.cache->grid.nearest(body_.nodes.position, bond.centroid, 1, ~0u, [](std::uint32_t) { return true; });
    const double reach = averaging_reach * body_.nodes.spacing[node.at(0)];
    double radius = 0;
    for (const Triangle& face : bond.faces)
      for (const auto v : face) radius = std::max(radius, (corners[v] - bond.centroid).norm());
    std::vector<std::uint32_t> found;
    grid_.within(position_, bond.centroid, radius + reach, found);
    const Plane plane = plane_of(bond.normal);
    std::vector<NearPoint> result;
    for (const auto p : found) {
      const double distance = distance_seen(position_[p], bond, corners, reach);
      if (distance >= reach) continue;
      const double share = distance / reach;
      const double volume = points_.blocks[place_[p].block].points[place_[p].index].volume;
      result.push_back({.point = p,
                        .weight = volume * (1 - share * share),
                        .at = plane.transpose() * (position_[p] - bond.centroid)});
    }
    return result;
  }

 private:
  // The distance of x from the faces; `reach` where it is farther, or does not see them.
  double distance_seen(const Vec3& x, const GluedBond& bond, const std::vector<Vec3>& corners, double reach) const {
    double nearest = reach;
    Vec3 seen_from;
    for (const Triangle& face : bond.faces) {
      const Vec3 &a = corners[face[0]], &b = corners[face[1]], &c = corners[face[2]];
      const Vec3 foot = closest_point_on_triangle(x, a, b, c);
      const double distance = (foot - x).norm();
      if (distance >= nearest) continue;
      nearest = distance;
      seen_from = foot + 0.01 * ((a + b + c) / 3 - foot);  // off the face's edges, where cracks meet it
    }
    return nearest < reach && !is_blocked(body_.surface, x, seen_from) ? nearest : reach;
  }

  const Body& body_;
  const MaterialPoints& points_;
  std::vector<Vec3> position_;
  std::vector<Point> place_;
  NodeGrid grid_;
};

BondLoads::BondLoads(const Body& body, const Solid& solid, const GluedBonds& glued) : walls_(glued.bonds.size()) {
  const Surroundings surroundings(body, SolidDiscretisation::of(solid).points);
  std::vector<std::vector<NearPoint>> near(walls_.size());
  if (!surroundings.places().empty())
    parallel_for(walls_.size(), 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t w = begin; w < end; ++w)
        if (!glued.bonds[w].broken) near[w] = surroundings.near(glued.bonds[w], glued.points);
    });
  std::vector<std::uint32_t> index(surroundings.places().size(), ~0u);
  for (const auto& list : near)
    for (const NearPoint& n : list) index[n.point] = 0;
  for (std::size_t p = 0; p < index.size(); ++p) {
    if (index[p] != 0) continue;
    index[p] = static_cast<std::uint32_t>(points_.size());
    points_.push_back(surroundings.places()[p]);
  }
  for (std::size_t w = 0; w < walls_.size(); ++w) {
    if (near[w].empty()) continue;
    const std::vector<FitWeights> weights = fit(near[w]);
    for (std::size_t i = 0; i < weights.size(); ++i)
      walls_[w].shares.push_back(
          {.point = index[near[w][i].point], .mean = weights[i].mean, .slope = weights[i].slope});
    const Plane plane = plane_of(glued.bonds[w].normal);
    for (const Triangle& face : glued.bonds[w].faces)
      for (const auto v : face)
        walls_[w].corners.push_back(plane.transpose() * (glued.points[v] - glued.bonds[w].centroid));
  }
}

std::vector<BondLoads::PointStress> BondLoads::stresses(const Solid& solid, const State& state) const {
  const MaterialPoints& all = SolidDiscretisation::of(solid).points;
  std::vector<PointStress> result(points_.size());
  parallel_for(points_.size(), 64, [&](std::size_t begin, std::size_t end) {
    std::uint32_t block = ~0u;
    std::vector<Mat3> gradient;
    for (std::size_t p = begin; p < end; ++p) {
      if (points_[p].block != block) {
        block = points_[p].block;
        gradient = all.gradients(block, state.displacement);
      }
      const Mat3 f = Mat3::Identity() + gradient[points_[p].index];
      const Material& material = solid.materials()[all.blocks[block].points[points_[p].index].material];
      if (state.plastic.empty()) {
        result[p].nominal = stress(material, f);
      } else {
        const Mat3 relaxed = inverse_plastic_stretch(state.plastic[all.first_point(block) + points_[p].index]);
        result[p].nominal = stress(material, f * relaxed) * relaxed;
      }
      // The cofactors of F (Nanson's formula).
      for (int c = 0; c < 3; ++c) result[p].area.col(c) = f.col((c + 1) % 3).cross(f.col((c + 2) % 3));
    }
  });
  return result;
}

std::vector<BondLoad> BondLoads::at(const Solid& solid, const State& state, const GluedBonds& glued) const {
  const std::vector<PointStress> stress = stresses(solid, state);
  std::vector<BondLoad> loads(walls_.size());
  parallel_for(walls_.size(), 16, [&](std::size_t begin, std::size_t end) {
    for (std::size_t w = begin; w < end; ++w) {
      const GluedBond& bond = glued.bonds[w];
      if (bond.broken || walls_[w].shares.empty()) continue;
      Vec3 traction = Vec3::Zero(), normal = Vec3::Zero();
      Plane slope = Plane::Zero();
      for (const Share& s : walls_[w].shares) {
        const Vec3 t = stress[s.point].nominal * bond.normal;
        traction += s.mean * t;
        slope += t * s.slope.transpose();
        normal += s.mean * (stress[s.point].area * bond.normal);
      }
      normal.stableNormalize();
      BondLoad& load = loads[w];
      load.normal = traction.dot(normal);
      load.shear = (traction - load.normal * normal).norm();
      const Vec2 bend = slope.transpose() * normal;
      for (const Vec2& corner : walls_[w].corners) load.bending = std::max(load.bending, bend.dot(corner));
    }
  });
  return loads;
}

}  // namespace geo
