#include "contact/ground.h"

#include <cmath>

namespace geo {

Ground::Ground(const GroundOptions& options) : options_(options) { options_.normal.normalize(); }

void Ground::begin(const Body& body, const SurfaceWeights& weights, const std::vector<Vec3>& u, double reach, double slow) {
  const Complex& k = body.surface;
  const Vec3& n = options_.normal;
  slow_ = slow;
  rows_.clear();
  for (std::uint32_t v = 0; v < k.surface_vertex_count(); ++v) {
    const SurfaceVertexId id(v);
    if (!k.alive(id) || weights.row(v).empty()) continue;
    const Vec3& x = k.point(k.site(id));
    Row row{weights.row(v), n.dot(x - options_.point), 0, 0, weights.at(v, u), Mat3::Zero()};
    const double above = row.height + n.dot(row.start);
    if (above > reach) continue;
    for (const FaceId f : k.faces_at(k.site(id)))
      for (int which = 0; which < 2; ++which)
        for (int c = 0; c < 3; ++c)
          if (k.has({f, which}) && k.surface_vertex({f, which}, c) == id) {
            const auto corners = k.corners(f);
            row.stiffness += options_.pressure * (corners[1] - corners[0]).cross(corners[2] - corners[0]).norm() / 6;
          }
    row.pressed = row.stiffness * std::max(0.0, -above);
    rows_.push_back(row);
  }
}

double Ground::energy(const std::vector<Vec3>& u) const {
  double sum = 0;
  for (const Row& row : rows_) {
    const Vec3 d = at(row, u);
    const double depth = std::max(0.0, -(row.height + options_.normal.dot(d)));
    sum += 0.5 * row.stiffness * depth * depth;
    if (!(row.pressed > 0)) continue;
    const Vec3 way = d - row.start;
    const double slid = (way - options_.normal.dot(way) * options_.normal).norm();
    sum += options_.friction * row.pressed * (slid < slow_ ? 0.5 * slid * slid / slow_ : slid - 0.5 * slow_);
  }
  return sum;
}

void Ground::force(const std::vector<Vec3>& u, std::vector<Vec3>& out) {
  const Vec3& n = options_.normal;
  const Mat3 nn = n * n.transpose();
  for (Row& row : rows_) {
    const Vec3 d = at(row, u);
    const double depth = std::max(0.0, -(row.height + n.dot(d)));
    Vec3 f = row.stiffness * depth * n;
    row.curvature = depth > 0 ? Mat3(row.stiffness * nn) : Mat3(Mat3::Zero());
    if (row.pressed > 0) {
      const Vec3 way = d - row.start, slide = way - n.dot(way) * n;
      const double drag = options_.friction * row.pressed / std::max(slide.norm(), slow_);
      f -= drag * slide;
      row.curvature += drag * (Mat3::Identity() - nn);
    }
    for (const auto& e : row.weights) out[e.node] += e.weight * f;
  }
}

void Ground::blocks(std::vector<Mat3>& out) const {
  for (const Row& row : rows_)
    for (const auto& e : row.weights) out[e.node] += e.weight * e.weight * row.curvature;
}

void Ground::multiply(const std::vector<Vec3>& p, std::vector<Vec3>& out) const {
  for (const Row& row : rows_) {
    if (row.curvature.isZero(0)) continue;
    const Vec3 f = row.curvature * at(row, p);
    for (const auto& e : row.weights) out[e.node] += e.weight * f;
  }
}

double Ground::depth(const std::vector<Vec3>& u) const {
  double most = 0;
  for (const Row& row : rows_) most = std::max(most, -(row.height + options_.normal.dot(at(row, u))));
  return most;
}

}  // namespace geo
