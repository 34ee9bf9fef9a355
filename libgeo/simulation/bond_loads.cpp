// Mean and slope of a traction are weighted sums over points, whose weights depend on the
// undeformed material alone: they are found once, and again where a cut has changed the points.
#include "simulation/bond_loads.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <functional>
#include <string_view>
#include <tuple>

#include "body/incremental_cache.h"
#include "body/locate.h"
#include "geometry/distance.h"
#include "kerf/parallel.h"
#include "mechanics/solver/relaxation.h"
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

template <class NearPoint>
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

// The crack faces of a complex with ids from `first` on.
class NewCracks {
 public:
  NewCracks(const Complex& complex, std::uint32_t first) {
    for (std::uint32_t f = first; f < complex.face_count(); ++f)
      if (complex.alive(FaceId(f)) && complex.face(FaceId(f)).crack > 0) {
        faces_.push_back(FaceId(f));
        boxes_.push_back(complex.box(FaceId(f)));
      }
  }
  std::vector<FaceId> in(const Box3& box) const {
    std::vector<FaceId> found;
    for (std::size_t k = 0; k < faces_.size(); ++k)
      if (boxes_[k].meets(box)) found.push_back(faces_[k]);
    return found;
  }

 private:
  std::vector<FaceId> faces_;
  std::vector<Box3> boxes_;
};

// The box that holds a wall, the points near it, and all that may be between.
Box3 surroundings_of(const GluedBond& bond, const std::vector<Vec3>& corners, double reach) {
  Box3 box;
  for (const Triangle& face : bond.faces)
    for (const auto v : face) box.add(corners[v]);
  return box.grown(reach);
}

}  // namespace

// A point near a wall.
struct BondLoads::NearPoint {
  std::uint32_t point;  // the how manieth of those around the wall
  double weight;
  Vec2 at;  // along the wall, about its centroid
};

double BondLoad::effective(double friction) const {
  const double tension = normal + bending;
  if (tension > 0) return std::sqrt(tension * tension + shear * shear);
  return std::max(0.0, shear + friction * tension);
}

// The material points of a solid, ordered by position and with the volumes of their cells: a cut
// changes their blocks, and the scale of all volumes, also far from the crack.
class BondLoads::Surroundings {
 public:
  static bool is_before(const Vec3& a, const Vec3& b) {
    return std::tie(a.x(), a.y(), a.z()) < std::tie(b.x(), b.y(), b.z());
  }

  Surroundings(const Body& body, const MaterialPoints& points) : body_(body) {
    for (std::uint32_t b = 0; b < points.blocks.size(); ++b)
      for (std::uint32_t i = 0; i < points.blocks[b].points.size(); ++i)
        if (points.blocks[b].points[i].quality != MomentQuality::singular) place_.push_back({.block = b, .index = i});
    const auto at = [&](const Point& p) -> const MaterialPoint& { return points.blocks[p.block].points[p.index]; };
    std::sort(place_.begin(), place_.end(),
              [&](const Point& p, const Point& q) { return is_before(at(p).position, at(q).position); });
    for (const Point& p : place_) {
      position_.push_back(at(p).position);
      volume_.push_back(at(p).unscaled_volume);
    }
    if (!position_.empty()) grid_ = NodeGrid(body.finest_spacing, position_);
  }

  const std::vector<Point>& places() const { return place_; }

  // How far from a bond's wall points count.
  double reach_of(const GluedBond& bond) const {
    const auto node =
        body_.cache->grid.nearest(body_.nodes.position, bond.centroid, 1, ~0u, [](std::uint32_t) { return true; });
    return averaging_reach * body_.nodes.spacing[node.at(0)];
  }

  // The points around a bond's wall, ascending: more than those that count.
  std::vector<std::uint32_t> around(const GluedBond& bond, const std::vector<Vec3>& corners, double reach) const {
    double radius = 0;
    for (const Triangle& face : bond.faces)
      for (const auto v : face) radius = std::max(radius, (corners[v] - bond.centroid).norm());
    std::vector<std::uint32_t> found;
    grid_.within(position_, bond.centroid, radius + reach, found);
    return found;
  }

  // A hash of all that near() reads of points.
  std::uint64_t hash_of(const std::vector<std::uint32_t>& points, double reach) const {
    std::vector<double> values{reach};
    for (const auto p : points)
      values.insert(values.end(), {position_[p].x(), position_[p].y(), position_[p].z(), volume_[p]});
    return std::hash<std::string_view>()(
        {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(double)});
  }

  // For each point `around`, how it sees a bond's wall. `before`: the same without `cracks`, for
  // points in the same order, with the same reach.
  std::vector<Sight> sights(const GluedBond& bond, const std::vector<Vec3>& corners,
                            const std::vector<std::uint32_t>& around, double reach, const std::vector<Sight>& before,
                            const BoxVisibility& cracks) const {
    const std::vector<Sphere> spheres = spheres_of(bond, corners);
    std::vector<Sight> result;
    auto known = before.begin();
    for (const auto p : around) {
      const Vec3& x = position_[p];
      while (known != before.end() && is_before(known->point, x)) ++known;
      const bool is_known = known != before.end() && known->point == x;
      Sight sight = is_known ? *known : foot_on(x, bond, corners, spheres, reach);
      const bool is_blocked_now = sight.distance < reach &&
                                  (is_known ? cracks.blocked(x, sight.from) : is_blocked(body_.surface, x, sight.from));
      if (is_blocked_now) sight.distance = reach;
      result.push_back(sight);
    }
    return result;
  }

  // Those of the points `around` that count: near a bond's wall, which they see.
  std::vector<NearPoint> near(const GluedBond& bond, const std::vector<std::uint32_t>& around, double reach,
                              const std::vector<Sight>& sights) const {
    const Plane plane = plane_of(bond.normal);
    std::vector<NearPoint> result;
    for (std::uint32_t k = 0; k < around.size(); ++k) {
      if (sights[k].distance >= reach) continue;
      const double share = sights[k].distance / reach;
      result.push_back({.point = k,
                        .weight = volume_[around[k]] * (1 - share * share),
                        .at = plane.transpose() * (sights[k].point - bond.centroid)});
    }
    return result;
  }

 private:
  struct Sphere {
    Vec3 center;
    double radius;
  };
  static std::vector<Sphere> spheres_of(const GluedBond& bond, const std::vector<Vec3>& corners) {
    std::vector<Sphere> spheres;
    for (const auto& [a, b, c] : bond.faces) {
      const Vec3 center = (corners[a] + corners[b] + corners[c]) / 3;
      double radius = 0;
      for (const auto v : {a, b, c}) radius = std::max(radius, (corners[v] - center).norm());
      spheres.push_back({center, radius});
    }
    return spheres;
  }

  // The nearest place of the faces to x; `reach` away where it is farther.
  static Sight foot_on(const Vec3& x, const GluedBond& bond, const std::vector<Vec3>& corners,
                       const std::vector<Sphere>& spheres, double reach) {
    Sight nearest{.point = x, .from = x, .distance = reach};
    for (std::size_t f = 0; f < bond.faces.size(); ++f) {
      const double bound = nearest.distance + spheres[f].radius;
      if ((x - spheres[f].center).squaredNorm() > bound * bound) continue;
      const auto& [i, j, k] = bond.faces[f];
      const Vec3 &a = corners[i], &b = corners[j], &c = corners[k];
      const Vec3 foot = closest_point_on_triangle(x, a, b, c);
      const double distance = (foot - x).norm();
      if (distance >= nearest.distance) continue;
      nearest.distance = distance;
      nearest.from = foot + 0.01 * ((a + b + c) / 3 - foot);  // off the face's edges, where cracks meet it
    }
    return nearest;
  }

  const Body& body_;
  std::vector<Vec3> position_;
  std::vector<double> volume_;
  std::vector<Point> place_;
  NodeGrid grid_;
};

void BondLoads::update(const Body& body, const Solid& solid, const GluedBonds& glued) {
  const Surroundings surroundings(body, SolidDiscretisation::of(solid).points);
  const NewCracks cracks(body.surface, faces_);
  faces_ = body.surface.face_count();
  walls_.resize(glued.bonds.size());
  std::vector<std::vector<std::uint32_t>> around(walls_.size());
  if (surroundings.places().empty()) return;
  parallel_for(walls_.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t w = begin; w < end; ++w) {
      const GluedBond& bond = glued.bonds[w];
      if (bond.broken) {
        walls_[w] = {};
        continue;
      }
      const double reach = surroundings.reach_of(bond);
      around[w] = surroundings.around(bond, glued.points, reach);
      const std::uint64_t hash = surroundings.hash_of(around[w], reach);
      Wall& wall = walls_[w];
      const std::vector<FaceId> new_faces = cracks.in(surroundings_of(bond, glued.points, reach));
      if (wall.around == hash && new_faces.empty()) continue;
      if (wall.reach != reach) wall.sights.clear();
      std::vector<Sight> sights = surroundings.sights(bond, glued.points, around[w], reach, wall.sights,
                                                      BoxVisibility(body.surface, new_faces));
      wall = wall_of(surroundings.near(bond, around[w], reach, sights), bond, glued.points);
      wall.around = hash;
      wall.reach = reach;
      wall.sights = std::move(sights);
    }
  });
  const std::vector<Point>& places = surroundings.places();
  std::vector<char> is_used(places.size(), 0);
  for (std::size_t w = 0; w < walls_.size(); ++w)
    for (const Share& s : walls_[w].shares) is_used[around[w][s.near]] = 1;
  std::vector<std::uint32_t> used;
  for (std::uint32_t p = 0; p < places.size(); ++p)
    if (is_used[p]) used.push_back(p);
  std::sort(used.begin(), used.end(), [&](std::uint32_t p, std::uint32_t q) {
    return std::tie(places[p].block, places[p].index) < std::tie(places[q].block, places[q].index);
  });
  std::vector<std::uint32_t> index(places.size());
  points_.clear();
  for (const auto p : used) {
    index[p] = static_cast<std::uint32_t>(points_.size());
    points_.push_back(places[p]);
  }
  for (std::size_t w = 0; w < walls_.size(); ++w)
    for (Share& s : walls_[w].shares) s.point = index[around[w][s.near]];
}

BondLoads::Wall BondLoads::wall_of(const std::vector<NearPoint>& near, const GluedBond& bond,
                                   const std::vector<Vec3>& corners) {
  Wall wall;
  if (near.empty()) return wall;
  const std::vector<FitWeights> weights = fit(near);
  for (std::size_t i = 0; i < weights.size(); ++i)
    wall.shares.push_back({.near = near[i].point, .point = 0, .mean = weights[i].mean, .slope = weights[i].slope});
  const Plane plane = plane_of(bond.normal);
  for (const Triangle& face : bond.faces)
    for (const auto v : face) wall.corners.push_back(plane.transpose() * (corners[v] - bond.centroid));
  return wall;
}

std::vector<BondLoads::PointStress> BondLoads::stresses(const Solid& solid, const State& state) const {
  const MaterialPoints& all = SolidDiscretisation::of(solid).points;
  std::vector<PointStress> result(points_.size());
  parallel_for(points_.size(), 64, [&](std::size_t begin, std::size_t end) {
    std::uint32_t block = ~0u;
    std::vector<Mat3> gradient;
    PointRelaxation relaxation;
    for (std::size_t p = begin; p < end; ++p) {
      if (points_[p].block != block) {
        block = points_[p].block;
        gradient = all.gradients(block, state.displacement);
        relaxation = relaxation_of(all, block, state);
      }
      const Mat3 f = Mat3::Identity() + gradient[points_[p].index];
      const Material& material = solid.materials()[all.blocks[block].points[points_[p].index].material];
      if (relaxation.empty()) {
        result[p].nominal = stress(material, f);
      } else {
        const Mat3 relaxed = relaxation.at(points_[p].index);
        result[p].nominal = relaxation.share_at(points_[p].index) * stress(material, f * relaxed) * relaxed;
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
