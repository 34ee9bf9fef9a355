#include "mechanics/discretisation/point_map.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "geometry/distance.h"
#include "mechanics/discretisation/deformation.h"
#include "mechanics/discretisation/kernel.h"

namespace geo {
namespace {

Mat3 inverse_of(const Mat3& f) {
  return f.determinant() > 0.05 ? Mat3(f.inverse())
                                : Mat3::Identity();  // crushed or turned inside out: as if it were rigid
}

// 1 up to a, 0 from b on.
double fade(double x, double a, double b) {
  const double t = std::clamp((b - x) / (b - a), 0.0, 1.0);
  return t * t * (3 - 2 * t);
}

}  // namespace

PointMap::PointMap(const Body& body, const std::vector<Vec3>& u, const LazyNodalGradients& gradient, const Box3& about,
                   std::vector<std::uint8_t> counted)
    : body_(body),
      u_(u),
      gradient_(gradient),
      counted_(std::move(counted)),
      reach_(*std::max_element(body.nodes.radius.begin(), body.nodes.radius.end())),
      grid_(body.grid.cell()) {
  const Box3 box = about.grown(2 * reach_);
  world_.reserve(body.nodes.size());
  for (std::size_t i = 0; i < body.nodes.size(); ++i) world_.push_back(body.nodes.position[i] + u[i]);
  for (std::size_t i = 0; i < body.nodes.size(); ++i)
    if (counts(i) && box.meets({world_[i], world_[i]})) grid_.insert(world_, static_cast<std::uint32_t>(i));
}

bool PointMap::counts(FaceId f) const {
  if (counted_.empty()) return true;
  std::vector<std::pair<NodeId, double>> nodes;
  bound_nodes(body_, body_.surface.surface_vertex({f, 0}, 0), nodes);
  return !nodes.empty() && counted_[nodes[0].first.index()];
}

void PointMap::look(Round& round, const Vec3& x) const {
  if ((round.material - x).norm() < 0.5 * reach_) return;
  round.material = x, round.node.clear(), round.share.clear();
  std::vector<std::uint32_t> near;
  body_.grid.within(body_.nodes.position, x, 1.5 * reach_, near);
  for (const auto i : near)
    if (const double share = fade((round.world - world_[i]).norm() / body_.nodes.radius[i], 1.5, 3);
        share > 0 && counts(i))
      round.node.push_back(i), round.share.push_back(share);
}

bool PointMap::forward(Round& round, const Vec3& x, Vec3& to, Mat3& slope) const {
  look(round, x);
  double total = 0;
  to.setZero(), slope.setZero();
  for (std::size_t k = 0; k < round.node.size(); ++k) {
    const auto i = round.node[k];
    const double w = kernel((x - body_.nodes.position[i]).norm() / body_.nodes.radius[i], 1.0) * round.share[k];
    if (!(w > 0)) continue;
    total += w, slope += w * gradient_[i];
    to += w * (u_[i] + gradient_[i] * (x - body_.nodes.position[i]));
  }
  if (!(total > 0)) return false;
  to = x + to / total, slope = Mat3::Identity() + slope / total;
  return true;
}

Vec3 PointMap::solve(Round& round, Vec3 x, double enough) const {
  Vec3 best = x, to;
  Mat3 slope;
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 24 && forward(round, x, to, slope); ++i) {
    const Vec3 rest = round.world - to;
    if (!(rest.norm() < least)) break;
    least = rest.norm(), best = x;
    if (least <= enough) break;
    x += inverse_of(slope) * rest;
  }
  return best;
}

Vec3 PointMap::deformed(SurfaceVertexId v, Memory& memory) const {
  const auto [it, fresh] = memory.try_emplace(v.value);
  if (fresh) {
    std::vector<std::pair<NodeId, double>> nodes;
    bound_nodes(body_, v, nodes);
    const Vec3 x = body_.surface.point(body_.surface.site(v));
    it->second = x + (nodes.empty() ? Vec3(Vec3::Zero()) : displacement_at(x, nodes, body_.nodes, u_, gradient_));
  }
  return it->second;
}

// What Eq. 1 and the deformed triangles of the skin near y differ by: the nearest ones say most,
// and one that holds y all.
Vec3 PointMap::on_skin(Round& round, const Vec3& x, double reach, Memory& memory) const {
  const Vec3& y = round.world;
  Vec3 to;
  Mat3 slope;
  std::vector<FaceId> faces;
  body_.surface.faces_near(Box3{x, x}.grown(2 * reach), faces);
  if (faces.empty() || !forward(round, x, to, slope)) return Vec3::Zero();
  const Mat3 back = inverse_of(slope);
  Vec3 sum = Vec3::Zero();
  double total = 0, least = reach;
  for (const FaceId f : faces) {
    if (body_.surface.face(f).crack != 0 || !counts(f)) continue;
    Vec3 t[3];
    for (int k = 0; k < 3; ++k) t[k] = deformed(body_.surface.surface_vertex({f, 0}, k), memory);
    const Vec3 on = closest_point_on_triangle(y, t[0], t[1], t[2]), b = barycentric(on, t[0], t[1], t[2]);
    const double d = (on - y).norm();
    if (d >= reach) continue;
    const auto corner = body_.surface.corners(f);
    const double w = std::pow((reach - d) / std::max(d, 1e-12 * reach), 2);
    sum += w * (b[0] * corner[0] + b[1] * corner[1] + b[2] * corner[2] - (x + back * (on - y)));
    total += w, least = std::min(least, d);
  }
  return total > 0 ? Vec3(std::pow(1 - least / reach, 2) * sum / total) : Vec3(Vec3::Zero());
}

PointMap::Place PointMap::material(const Vec3& y, Memory& memory) const {
  const auto nearest = grid_.nearest(world_, y, 1, ~0u, [](std::uint32_t) { return true; });
  if (nearest.empty()) return {y, NodeId(), false};
  const std::size_t a = nearest[0];
  const auto& nodes = body_.nodes;
  if (!((y - world_[a]).norm() < nodes.radius[a])) return {y - u_[a], NodeId(a), false};
  // Each node's own map, as far as it agrees with the nearest one's.
  const auto back = [&](std::size_t i) {
    return Vec3(nodes.position[i] + inverse_of(Mat3::Identity() + gradient_[i]) * (y - world_[i]));
  };
  std::vector<std::uint32_t> near;
  grid_.within(world_, y, nodes.radius[a], near);
  const Vec3 guess = back(a);
  Vec3 sum = Vec3::Zero();
  double total = 0;
  for (const auto i : near) {
    const double w = kernel((y - world_[i]).norm() / nodes.radius[i], 1.0);
    if (!(w > 0)) continue;
    const Vec3 x = back(i);
    const double agreed = w * fade((x - guess).norm() / nodes.radius[a], 0.5, 1);
    sum += agreed * x, total += agreed;
  }
  Round round;
  round.world = y;
  const Vec3 x = solve(round, total > 0 ? Vec3(sum / total) : guess, 1e-12 * nodes.spacing[a]);
  return {x + on_skin(round, x, 0.5 * nodes.spacing[a], memory), NodeId(a), true};
}

}  // namespace geo
