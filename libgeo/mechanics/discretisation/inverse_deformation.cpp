// Broyden's method (1965) for y = x + u(x), u by Eq. 1, while the residual falls. It begins with
// the inverse of F, which blends the nodes' gradients and leaves out derivatives of the weights.
#include "mechanics/discretisation/inverse_deformation.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "body/incremental_cache.h"
#include "geometry/distance.h"
#include "mechanics/discretisation/deformation.h"
#include "mechanics/discretisation/kernel.h"
#include "mechanics/discretisation/point_supports.h"

namespace geo {
namespace {

// Material crushed to less than a twentieth of its volume, or inverted, is treated as undeformed.
// Crushed along one axis, it has an inverse of norm 20 there: a residual of a tenth of a support
// radius would become a step of two radii, beyond all nodes that carry the place.
Mat3 safe_inverse(const Mat3& f) { return f.determinant() > 0.05 ? Mat3(f.inverse()) : Mat3::Identity(); }

// A place in the material continues another within this distance, in spacings. Both are carried by
// a common node then: a support radius is about two spacings (SampleOptions::support).
constexpr double continuing_distance = 4;

// Triangles lower than this share of their longest side have no say: barycentric coordinates are
// off by 2⁻⁵² over its square, 1e-6. Their neighbours across that side know as much.
constexpr double lowest_triangle = 0x1p-16;

bool is_sliver(const Vec3 (&t)[3]) {
  const Vec3 a = t[1] - t[0], b = t[2] - t[1], c = t[0] - t[2];
  const double longest = std::max({a.squaredNorm(), b.squaredNorm(), c.squaredNorm()});
  return a.cross(b).norm() <= lowest_triangle * longest;
}

// Smoothstep t² (3 − 2 t), from 1 at a to 0 at b.
double fade(double x, double a, double b) {
  const double t = std::clamp((b - x) / (b - a), 0.0, 1.0);
  return t * t * (3 - 2 * t);
}

}  // namespace

InverseDeformation::InverseDeformation(const Body& body, const std::vector<Vec3>& u, const LazyNodalGradients& gradient,
                                       const Box3& about, std::vector<std::uint8_t> included)
    : body_(body),
      u_(u),
      gradient_(gradient),
      included_(std::move(included)),
      largest_support_(*std::max_element(body.nodes.radius.begin(), body.nodes.radius.end())),
      grid_(body.cache->grid.cell()) {
  const Box3 box = about.grown(2 * largest_support_);
  world_.reserve(body.nodes.size());
  for (std::size_t i = 0; i < body.nodes.size(); ++i) world_.push_back(body.nodes.position[i] + u[i]);
  for (std::size_t i = 0; i < body.nodes.size(); ++i)
    if (is_included(i) && box.meets({world_[i], world_[i]})) grid_.insert(world_, static_cast<std::uint32_t>(i));
}

bool InverseDeformation::is_included(FaceId f) const {
  if (included_.empty()) return true;
  std::vector<std::pair<NodeId, double>> nodes;
  carrier_nodes(body_, body_.surface.surface_vertex({f, 0}, 0), nodes);
  return !nodes.empty() && included_[nodes[0].first.index()];
}

void InverseDeformation::update(Neighborhood& near, const Vec3& x) const {
  // The nodes that are gathered below carry each place within half a support radius. A larger box
  // is gathered less often and has more nodes in each evaluation.
  if ((near.material - x).norm() < 0.5 * largest_support_) return;
  near.material = x;
  near.node.clear();
  near.fading.clear();
  // The margin is far beyond rounding.
  const Box3 about = Box3{x, x}.grown((0.5 + 1e-9) * largest_support_);
  // A node that carries x is within one radius of it in the material, so within the radius times
  // the stretch in the world. Nodes count fully up to a stretch of 1.5. From 3 on they belong to
  // another part of the material that passes by.
  for (const auto i : supporting_nodes(body_, about, 1, largest_support_))
    if (const double fading = fade((near.world - world_[i]).norm() / body_.nodes.radius[i], 1.5, 3);
        fading > 0 && is_included(i)) {
      near.node.push_back(i);
      near.fading.push_back(fading);
    }
}

bool InverseDeformation::deform(Neighborhood& near, const Vec3& x, Vec3& to, Mat3& f) const {
  update(near, x);
  double total = 0;
  to.setZero();
  f.setZero();
  for (std::size_t k = 0; k < near.node.size(); ++k) {
    const auto i = near.node[k];
    const double w = kernel((x - body_.nodes.position[i]).norm() / body_.nodes.radius[i], 1.0) * near.fading[k];
    if (!(w > 0)) continue;
    total += w;
    f += w * gradient_[i];
    to += w * (u_[i] + gradient_[i] * (x - body_.nodes.position[i]));
  }
  if (!(total > 0)) return false;
  to = x + to / total;
  f = Mat3::Identity() + f / total;
  return true;
}

// Where the residual does not fall, the inverse that the steps have changed may be at fault: it is
// set to that of F at the best place.
Vec3 InverseDeformation::solve(Neighborhood& near, Vec3 x, double tolerance) const {
  constexpr double least_alignment = 0.1;  // of a step's square; below it, an update of the inverse is left out
  constexpr double infinite = std::numeric_limits<double>::infinity();
  Vec3 best = x, to, residual = Vec3::Zero(), step = Vec3::Zero();
  Mat3 f, f_best = Mat3::Identity(), inverse = Mat3::Identity();
  double smallest = infinite;
  bool is_changed = false;  // the inverse is not that of F at a place
  for (int i = 0; i < 24; ++i) {
    const Vec3 now = deform(near, x, to, f) ? Vec3(near.world - to) : Vec3(Vec3::Constant(infinite));
    if (now.norm() < smallest) {
      if (smallest == infinite)
        inverse = safe_inverse(f);
      else if (const Vec3 expected = inverse * (residual - now);
               std::abs(step.dot(expected)) > least_alignment * step.squaredNorm()) {
        inverse += (step - expected) * (step.transpose() * inverse) / step.dot(expected);
        is_changed = true;
      }
      smallest = now.norm();
      best = x;
      residual = now;
      f_best = f;
      if (smallest <= tolerance) break;
    } else if (is_changed) {
      inverse = safe_inverse(f_best);
      is_changed = false;
    } else {
      break;
    }
    step = inverse * residual;
    x = best + step;
  }
  return best;
}

Vec3 InverseDeformation::deformed_vertex(SurfaceVertexId v, VertexCache& cache) const {
  const auto [it, is_new] = cache.try_emplace(v.value);
  if (is_new) {
    std::vector<std::pair<NodeId, double>> nodes;
    carrier_nodes(body_, v, nodes);
    const Vec3 x = body_.surface.point(body_.surface.site(v));
    it->second = x + (nodes.empty() ? Vec3(Vec3::Zero()) : displacement_at(x, nodes, body_.nodes, u_, gradient_));
  }
  return it->second;
}

// The difference between the map that is linear on deformed triangles of the skin near y and the
// inverse of Eq. 1. A triangle at distance d < range has the weight (range / d − 1)², which grows
// without bound: one that holds y decides alone. The whole fades by (1 − d_min / range)².
Vec3 InverseDeformation::skin_correction(Neighborhood& near, const Vec3& x, double range, VertexCache& cache) const {
  const Vec3& y = near.world;
  Vec3 to;
  Mat3 f;
  if (!deform(near, x, to, f)) return Vec3::Zero();
  const Mat3 f_inverse = safe_inverse(f);
  // A step dy in the world is F⁻¹ dy in the material, whose k-th component is at most the norm of
  // the k-th row of F⁻¹ times |dy|. With the factor 1.5, F⁻¹ may differ by half within `range`.
  // Twice the range bounds the box: beyond, another part of the material may be near y.
  const Vec3 reach = range * (1.5 * f_inverse.rowwise().norm()).cwiseMin(2);
  std::vector<FaceId> faces;
  body_.surface.faces_near({x - reach, x + reach}, faces);
  Vec3 sum = Vec3::Zero();
  double total = 0, nearest = range;
  for (const FaceId face : faces) {
    if (body_.surface.face(face).crack != 0 || !is_included(face)) continue;
    Vec3 t[3];
    for (int k = 0; k < 3; ++k) t[k] = deformed_vertex(body_.surface.surface_vertex({face, 0}, k), cache);
    if (is_sliver(t)) continue;
    const Vec3 on = closest_point_on_triangle(y, t[0], t[1], t[2]), b = barycentric(on, t[0], t[1], t[2]);
    const double d = (on - y).norm();
    if (d >= range) continue;
    const auto corner = body_.surface.corners(face);
    const double root = (range - d) / std::max(d, 1e-12 * range), w = root * root;
    sum += w * (b[0] * corner[0] + b[1] * corner[1] + b[2] * corner[2] - (x + f_inverse * (on - y)));
    total += w;
    nearest = std::min(nearest, d);
  }
  const double share = 1 - nearest / range;
  return total > 0 ? Vec3(share * share * sum / total) : Vec3(Vec3::Zero());
}

// The node nearest in the world; among those near `before` in the material, if one of them holds y.
NodeId InverseDeformation::nearest_node(const Vec3& y, const Vec3* before) const {
  const auto nearest = grid_.nearest(world_, y, 1, ~0u, [](std::uint32_t) { return true; });
  if (nearest.empty()) return {};
  const auto& nodes = body_.nodes;
  const auto continues = [&](std::uint32_t i) {
    return (nodes.position[i] - *before).norm() < continuing_distance * nodes.spacing[i];
  };
  if (!before || continues(nearest[0])) return NodeId(nearest[0]);
  std::vector<std::uint32_t> holding;
  grid_.within(world_, y, largest_support_, holding);
  std::erase_if(holding, [&](auto i) { return !((y - world_[i]).norm() < nodes.radius[i]) || !continues(i); });
  const auto less = [&](auto i, auto j) { return (y - world_[i]).squaredNorm() < (y - world_[j]).squaredNorm(); };
  return NodeId(holding.empty() ? nearest[0] : *std::min_element(holding.begin(), holding.end(), less));
}

Vec3 InverseDeformation::to_material_of(NodeId node, const Vec3& world) const {
  const std::size_t i = node.index();
  return body_.nodes.position[i] + safe_inverse(Mat3::Identity() + gradient_[i]) * (world - world_[i]);
}

InverseDeformation::Location InverseDeformation::to_material(const Vec3& y, VertexCache& cache,
                                                             const Vec3* before) const {
  const NodeId nearest = nearest_node(y, before);
  if (!nearest.valid()) return {y, NodeId(), false};
  const std::size_t a = nearest.index();
  const auto& nodes = body_.nodes;
  if (!((y - world_[a]).norm() < nodes.radius[a])) return {y - u_[a], NodeId(a), false};
  // Each node's own inverse affine map counts as far as it agrees with the nearest node's. It
  // counts fully up to half a support radius apart. From one radius on it does not count, because
  // the nearest node does not carry the place that it gives. The result depends little on this: it
  // is only where the iteration begins.
  std::vector<std::uint32_t> candidates;
  grid_.within(world_, y, nodes.radius[a], candidates);
  const Vec3 guess = to_material_of(nearest, y);
  Vec3 sum = Vec3::Zero();
  double total = 0;
  for (const auto i : candidates) {
    const double w = kernel((y - world_[i]).norm() / nodes.radius[i], 1.0);
    if (!(w > 0)) continue;
    const Vec3 x = to_material_of(NodeId(i), y);
    const double agreeing = w * fade((x - guess).norm() / nodes.radius[a], 0.5, 1);
    sum += agreeing * x;
    total += agreeing;
  }
  Neighborhood near;
  near.world = y;
  // The tolerance is close to rounding, so the result depends little on the initial guess.
  const Vec3 x = solve(near, total > 0 ? Vec3(sum / total) : guess, 1e-12 * nodes.spacing[a]);
  return {x + skin_correction(near, x, 0.5 * nodes.spacing[a], cache), NodeId(a), true};
}

}  // namespace geo
