// Tractions are linear along a wall, as in a beam: mean and bending follow from one weighted fit,
// whose weights depend on the undeformed material alone.
#include "simulation/bond_loads.h"

#include <Eigen/Dense>
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
Eigen::Matrix<double, 3, 2> plane_of(const Vec3& normal) {
  Eigen::Matrix<double, 3, 2> axes;
  axes.col(0) = normal.unitOrthogonal();
  axes.col(1) = normal.cross(axes.col(0));
  return axes;
}

struct NearPoint {
  std::uint32_t point;
  double weight;
  Vec2 at;  // along the wall, about its centroid
};

}  // namespace

double BondLoad::effective(double friction) const {
  const double tension = normal + bending;
  if (tension > 0) return std::hypot(tension, shear);
  return std::max(0.0, shear + friction * tension);
}

BondLoads::BondLoads(const Body& body, const Solid& solid, const GluedBonds& glued) : walls_(glued.bonds.size()) {
  const MaterialPoints& all = solid.discretisation().points;
  std::vector<Vec3> position;
  std::vector<Point> place;
  for (std::uint32_t b = 0; b < all.blocks.size(); ++b)
    for (std::uint32_t i = 0; i < all.blocks[b].points.size(); ++i) {
      if (all.blocks[b].points[i].quality == MomentQuality::singular) continue;
      position.push_back(all.blocks[b].points[i].position);
      place.push_back({b, i});
    }
  if (position.empty()) return;
  const NodeGrid grid(body.finest_spacing, position);
  std::vector<std::vector<NearPoint>> near(walls_.size());
  parallel_for(walls_.size(), 1, [&](std::size_t begin, std::size_t end) {
    std::vector<std::uint32_t> found;
    for (std::size_t w = begin; w < end; ++w) {
      const GluedBond& bond = glued.bonds[w];
      if (bond.broken) continue;
      const auto axes = plane_of(bond.normal);
      const auto node = body.cache->grid.nearest(body.nodes.position, bond.centroid, 1, ~0u, [](auto) { return true; });
      const double reach = body.nodes.spacing[node.at(0)];
      Box3 box;
      double radius = 0;
      for (const Triangle& face : bond.faces)
        for (const auto v : face) {
          const Vec3 arm = glued.points[v] - bond.centroid;
          box.add(glued.points[v]);
          radius = std::max(radius, arm.norm());
          walls_[w].corners.push_back(axes.transpose() * arm);
        }
      found.clear();
      grid.within(position, bond.centroid, radius + reach, found);
      for (const auto p : found) {
        if (!box.grown(reach).meets({position[p], position[p]})) continue;
        double nearest = reach;
        Vec3 seen_from;
        for (const Triangle& face : bond.faces) {
          const Vec3 &a = glued.points[face[0]], &b = glued.points[face[1]], &c = glued.points[face[2]];
          const Vec3 foot = closest_point_on_triangle(position[p], a, b, c);
          const double d = (foot - position[p]).norm();
          if (d >= nearest) continue;
          nearest = d;
          // Off the face's edges, where other walls meet it.
          seen_from = foot + 0.01 * ((a + b + c) / 3 - foot);
        }
        if (nearest >= reach || is_blocked(body.surface, position[p], seen_from)) continue;
        const double share = nearest / reach;
        const double volume = all.blocks[place[p].block].points[place[p].index].volume;
        near[w].push_back({p, volume * (1 - share * share), axes.transpose() * (position[p] - bond.centroid)});
      }
    }
  });
  std::vector<std::uint32_t> index(position.size(), ~0u);
  for (const auto& list : near)
    for (const NearPoint& n : list) index[n.point] = 0;
  for (std::size_t p = 0; p < index.size(); ++p)
    if (index[p] == 0) {
      index[p] = static_cast<std::uint32_t>(points_.size());
      points_.push_back(place[p]);
    }
  for (std::size_t w = 0; w < walls_.size(); ++w) {
    // Weighted least squares for t = t₀ + G ξ; the pseudo-inverse leaves out slopes that the points
    // do not determine.
    Eigen::Matrix3d moment = Eigen::Matrix3d::Zero();
    double length = 0, weight = 0;
    for (const NearPoint& n : near[w]) {
      length += n.weight * n.at.squaredNorm();
      weight += n.weight;
    }
    if (!(weight > 0)) continue;
    length = std::sqrt(length / weight);
    if (!(length > 0)) length = 1;
    const auto row = [&](const NearPoint& n) { return Vec3(1, n.at.x() / length, n.at.y() / length); };
    for (const NearPoint& n : near[w]) moment += n.weight / weight * row(n) * row(n).transpose();
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(moment);
    Eigen::Matrix3d inverse = Eigen::Matrix3d::Zero();
    for (int k = 0; k < 3; ++k)
      if (eigen.eigenvalues()[k] > 0.05 * eigen.eigenvalues()[2])
        inverse += eigen.eigenvectors().col(k) * eigen.eigenvectors().col(k).transpose() / eigen.eigenvalues()[k];
    for (const NearPoint& n : near[w]) {
      const Vec3 fit = n.weight / weight * inverse * row(n);
      walls_[w].samples.push_back({index[n.point], fit.x(), fit.tail<2>() / length});
    }
  }
}

std::vector<BondLoad> BondLoads::at(const Solid& solid, const State& state, const GluedBonds& glued) const {
  const MaterialPoints& all = solid.discretisation().points;
  std::vector<Mat3> nominal(points_.size()), area(points_.size());
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
        nominal[p] = stress(material, f);
      } else {
        const Mat3 relaxed = inverse_plastic_stretch(state.plastic[all.first_point(block) + points_[p].index]);
        nominal[p] = stress(material, f * relaxed) * relaxed;
      }
      area[p].col(0) = f.col(1).cross(f.col(2));
      area[p].col(1) = f.col(2).cross(f.col(0));
      area[p].col(2) = f.col(0).cross(f.col(1));
    }
  });
  std::vector<BondLoad> loads(walls_.size());
  parallel_for(walls_.size(), 16, [&](std::size_t begin, std::size_t end) {
    for (std::size_t w = begin; w < end; ++w) {
      const GluedBond& bond = glued.bonds[w];
      if (bond.broken || walls_[w].samples.empty()) continue;
      Vec3 traction = Vec3::Zero(), normal = Vec3::Zero();
      Eigen::Matrix<double, 3, 2> slope = Eigen::Matrix<double, 3, 2>::Zero();
      for (const Sample& s : walls_[w].samples) {
        const Vec3 t = nominal[s.point] * bond.normal;
        traction += s.mean * t;
        slope += t * s.slope.transpose();
        normal += s.mean * (area[s.point] * bond.normal);
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
