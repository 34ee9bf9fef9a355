// A flank is the middle plane r = α along + β back, α, β ∈ [0, 1]. Faces of the wedge lean by
// thickness / (2 |back|) against it; depth = distance of the surface − n · (x − start of
// the segment).
#include "contact/response/blade_penalty.h"

#include <cmath>

#include "geometry/distance.h"

namespace geo {
namespace {

// Slip below this share of the blade's way is regularised, so that what goes with it sticks.
constexpr double relative_slip = 1e-2;
// The least slip regularisation, in support radii: for blades that rest.
constexpr double least_slip = 1e-6;

// The middle plane of a wedge behind one segment of its edge.
struct Flank {
  Vec3 start, along, normal;                      // of the segment; of the plane, unit
  double along_squared, along_back, determinant;  // of the normal equations for the coordinates
};

std::vector<Flank> flanks_of(const BladeWedge& wedge) {
  const std::size_t n = wedge.edge.size(), segments = wedge.closed ? n : n - 1;
  const double back_squared = wedge.back.norm() * wedge.back.norm();
  std::vector<Flank> flanks;
  for (std::size_t s = 0; s < segments; ++s) {
    const Vec3 a = wedge.edge[s], along = wedge.edge[(s + 1) % n] - a;
    const double aa = along.squaredNorm(), ab = along.dot(wedge.back);
    flanks.push_back({.start = a,
                      .along = along,
                      .normal = along.cross(wedge.back).normalized(),
                      .along_squared = aa,
                      .along_back = ab,
                      .determinant = aa * back_squared - ab * ab});
  }
  return flanks;
}

// Whether the point r from the start of a flank is behind its segment, but not behind the blade:
// r = α along + β back + d normal with α and β in [0, 1].
bool is_beside(const Flank& f, const Vec3& r, const Vec3& back, double back_squared) {
  const double ra = r.dot(f.along), rb = r.dot(back);
  const double alpha = (ra * back_squared - rb * f.along_back) / f.determinant,
               beta = (rb * f.along_squared - ra * f.along_back) / f.determinant;
  return alpha >= 0 && alpha <= 1 && beta >= 0 && beta <= 1;
}

}  // namespace

double surface_distance(const Body& body, NodeId node) {
  const SurfaceVertexId v = body.binding.closest[node.index()];
  if (!v.valid() || !body.surface.alive(v)) return 0;
  const Vec3& x = body.nodes.position[node.index()];
  double distance = (body.surface.point(body.surface.site(v)) - x).norm();
  std::vector<FaceId> faces;
  body.surface.faces_near(Box3{x, x}.grown(distance), faces);
  for (const FaceId f : faces) {
    const auto c = body.surface.corners(f);
    distance = std::min(distance, (closest_point_on_triangle(x, c[0], c[1], c[2]) - x).norm());
  }
  return distance;
}

void BladePenalty::add(std::size_t blade, const BladeWedge& wedge, const BladeNodes& nodes) {
  const Vec3& back = wedge.back;
  const double width = back.norm(), slope = 0.5 * wedge.thickness / width, back_squared = width * width;
  Box3 box;
  for (const Vec3& p : wedge.edge) {
    box.add(p);
    box.add(p + back);
  }
  const std::vector<Flank> flanks = flanks_of(wedge);
  for (std::size_t i = 0; i < nodes.position.size(); ++i) {
    const Vec3 world = nodes.position[i] + nodes.displacement[i];
    if (!box.grown(wedge.thickness + nodes.radius[i]).meets({world, world})) continue;
    const double surface = nodes.surface(i);
    // The nearest flank that the node is beside.
    Contact found{.node = {static_cast<std::uint32_t>(i), 1},
                  .blade = blade,
                  .normal = Vec3::Zero(),
                  .stiffness = nodes.mass(i) * wedge.stiffness,
                  .offset = 0};
    double least = 0.5 * wedge.thickness + surface;
    for (const Flank& f : flanks) {
      const Vec3 r = world - f.start;
      const double d = r.dot(f.normal);
      if (!(std::abs(d) < least) || !is_beside(f, r, back, back_squared)) continue;
      least = std::abs(d);
      found.normal = ((d < 0 ? -1.0 : 1.0) * f.normal - slope * back / width).normalized();
      found.offset = surface - found.normal.dot(r - nodes.displacement[i]);
    }
    if (found.normal == Vec3::Zero()) continue;
    found.coefficient = wedge.friction;
    found.way = wedge.way(world);
    found.regularisation = std::max(relative_slip * found.way.norm(), least_slip * nodes.radius[i]);
    contacts_.push_back(found);
  }
}

void BladePenalty::begin_substep(const std::vector<Vec3>& u, double from, double to) {
  for (Contact& c : contacts_) {
    const Vec3& start = u[c.node.node];
    const double normal = c.stiffness * c.depth(start);
    c.stuck = start + (to - from) * c.way;
    c.memory.begin_substep(normal, normal > 0 ? NormalForce::balanced : NormalForce::estimated);
  }
}

double BladePenalty::begin_iterate(std::size_t k, const Vec3& d) {
  Contact& c = contacts_[k];
  const Vec3 along = c.slip(d);
  const double change = c.memory.begin_iterate(along, c.stiffness * c.depth(d));
  return c.coefficient * change * c.friction().energy_over_bound(along.norm());
}

double BladePenalty::energy(std::size_t k, const Vec3& d) const {
  const Contact& c = contacts_[k];
  const double depth = c.depth(d), penalty = penalty_energy(c.stiffness, depth * depth);
  const LaggedFriction f = c.friction();
  return f.acts() ? penalty + f.energy(c.slip(d).norm()) : penalty;
}

Potential::Derivatives BladePenalty::derivatives(std::size_t k, const Vec3& d) const {
  const Contact& c = contacts_[k];
  const double depth = c.depth(d);
  Derivatives result{penalty_force(c.stiffness, depth, c.normal),
                     depth > 0 ? plane_penalty_hessian(c.stiffness, c.normal) : Mat3(Mat3::Zero())};
  if (const LaggedFriction f = c.friction(); f.acts())
    f.add(c.slip(d), c.normal * c.normal.transpose(), c.memory.last_slip, result.force, result.hessian);
  return result;
}

std::vector<Vec3> BladePenalty::reaction(const std::vector<Vec3>& u, std::size_t blades) const {
  std::vector<Vec3> sum(blades, Vec3::Zero());
  for (std::size_t k = 0; k < contacts_.size(); ++k)
    sum[contacts_[k].blade] -= derivatives(k, u[contacts_[k].node.node]).force;
  return sum;
}

double BladePenalty::work(const std::vector<Vec3>& u) const {
  double work = 0;
  for (std::size_t k = 0; k < contacts_.size(); ++k)
    work += derivatives(k, u[contacts_[k].node.node]).force.dot(contacts_[k].way);
  return work;
}

}  // namespace geo
