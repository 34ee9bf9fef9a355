#include "contact/response/obstacle_penalty.h"

#include <algorithm>
#include <cmath>

#include "kerf/parallel.h"
#include "mechanics/terms/contact_law.h"
#include "mechanics/terms/weighted_sums.h"

namespace geo {

ObstaclePenalty::ObstaclePenalty(std::shared_ptr<const RigidShape> shape, const ObstaclePenaltyOptions& options,
                                 const Eigen::Isometry3d& from, const Eigen::Isometry3d& to)
    : shape_(std::move(shape)), options_(options), from_(from), to_(to), now_(to) {}

template <class Take>
void ObstaclePenalty::each_way(const std::vector<Vec3>& u, const Take& take) const {
  for_each_weighted_sum(
      rows_.size(), u, [&](std::size_t r) { return rows_[r].weights; }, take);
}

Eigen::Isometry3d ObstaclePenalty::pose(double share) const {
  if (share <= 0) return from_;
  if (share >= 1) return to_;
  Eigen::Isometry3d p = Eigen::Isometry3d::Identity();
  p.linear() = Eigen::Quaterniond(from_.linear()).slerp(share, Eigen::Quaterniond(to_.linear())).toRotationMatrix();
  p.translation() = (1 - share) * from_.translation() + share * to_.translation();
  return p;
}

void ObstaclePenalty::watch(const Body& body, const SurfaceWeights& weights, const Watched& watched, double reach,
                            double slow, std::span<const double> firmness) {
  const Complex& k = body.surface;
  slow_ = slow, sum_ = {}, begun_ = ended_ = 0;
  const auto rest = [&](std::uint32_t v) -> const Vec3& { return k.point(k.site(SurfaceVertexId(v))); };
  std::vector<std::uint8_t> reached(k.surface_vertex_count(), 0);
  std::vector<Vec3> at(watched.at.empty() ? reached.size() : 0);
  const auto place = [&](std::uint32_t v) -> const Vec3& { return at.empty() ? watched.at[v] : at[v]; };
  const Eigen::Isometry3d back = from_.inverse();
  parallel_for(reached.size(), 256, [&](std::size_t begin, std::size_t end) {
    for (auto v = static_cast<std::uint32_t>(begin); v < end; ++v) {
      const auto row = weights.row(v);
      if (!k.alive(SurfaceVertexId(v)) || row.empty()) continue;
      if (!at.empty()) {
        if (std::none_of(row.begin(), row.end(), [&](const NodeWeight& w) { return watched.near[w.node] != 0; }))
          continue;
        at[v] = rest(v) + weights.at(v, watched.u);
      }
      reached[v] = shape_->near(back * place(v), reach);
    }
  });
  std::vector<std::uint32_t> vertices;
  for (std::uint32_t v = 0; v < reached.size(); ++v)
    if (reached[v]) vertices.push_back(v);
  rows_.resize(vertices.size());
  parallel_for(rows_.size(), 256, [&](std::size_t begin, std::size_t end) {
    for (std::size_t r = begin; r < end; ++r) {
      const auto v = vertices[r];
      Row& row = rows_[r];
      row = {};
      row.weights = weights.row(v), row.spread = weights.spread(v), row.rest = rest(v), row.way = place(v) - row.rest;
      row.stiffness = options_.pressure * (firmness.empty() ? 1 : firmness[weights.heaviest()[v]]) * weights.area(v);
    }
  });
}

void ObstaclePenalty::begin_substep(const std::vector<Vec3>& u, double from, double to) {
  if (from <= 0)
    sum_ = {}, impulses_ = false;
  else if (from == ended_ && !impulses_)
    add_reaction(u, sum_);
  const Eigen::Isometry3d start = pose(from), back = start.inverse();
  begun_ = from, ended_ = to, now_ = pose(to);
  const auto stand = [&](std::size_t r, const Vec3& way) {
    Row& row = rows_[r];
    row.start = row.rest + way;
    const Vec3 local = back * row.start;
    const RigidShape::Field field = shape_->at(local);
    row.outside = field.distance;
    row.pressed = row.stiffness * std::max(0.0, -field.distance);
    row.normal = start.linear() * field.normal;
    row.stuck = now_ * local;
    row.reach = std::max(0.0, row.outside - (row.start - row.stuck).norm()) / row.spread;
  };
  if (from > 0) return each_way(u, stand);
  parallel_for(rows_.size(), 64, [&](std::size_t begin, std::size_t end) {
    for (std::size_t r = begin; r < end; ++r) stand(r, rows_[r].way);
  });
}

RigidShape::Field ObstaclePenalty::inside(const Row& row, const Vec3& y) const {
  // No nearer than it was, less the ways that the vertex and what it would stick to have gone.
  if (row.outside > 0 && (y - row.stuck).norm() < row.outside) return {};
  RigidShape::Field field = shape_->at(now_.inverse() * y);
  if (!(field.distance < 0)) return {};
  const Mat3 turn = now_.linear();
  return {field.distance, turn * field.normal, turn * field.square * turn.transpose()};
}

Vec3 ObstaclePenalty::slide(const Row& row, const Vec3& y) {
  const Vec3 way = y - row.stuck;
  return way - row.normal.dot(way) * row.normal;
}

double ObstaclePenalty::drag(const Row& row, const Vec3& slide) const {
  return friction_drag(options_.friction * row.pressed, slide.norm(), slow_);
}

double ObstaclePenalty::energy(std::size_t r, const Vec3& way) const {
  const Row& row = rows_[r];
  const Vec3 y = row.rest + way;
  const double normal = 0.5 * row.stiffness * std::pow(inside(row, y).distance, 2);
  return row.pressed > 0 ? normal + friction_energy(options_.friction * row.pressed, slide(row, y).norm(), slow_)
                         : normal;
}

Potential::Derivatives ObstaclePenalty::pushed(const Row& row, const Vec3& way) const {
  const Vec3 y = row.rest + way;
  const RigidShape::Field field = inside(row, y);
  Derivatives result{-row.stiffness * field.distance * field.normal, row.stiffness * field.square};
  if (row.pressed > 0) {
    const Vec3 slid = slide(row, y);
    const double rub = drag(row, slid);
    result.force -= rub * slid, result.hessian += rub * (Mat3::Identity() - row.normal * row.normal.transpose());
  }
  return result;
}

void ObstaclePenalty::apply_impulse(const std::vector<Vec3>& u, double h, const std::vector<double>& inverse_mass,
                                    std::vector<Vec3>& velocity) {
  const Eigen::Isometry3d start = pose(begun_);
  std::vector<RigidShape::Field> fields(rows_.size());
  const double share = ended_ - begun_;
  impulses_ = true;
  each_way(u, [&](std::size_t r, const Vec3& way) { fields[r] = inside(rows_[r], rows_[r].rest + way); });
  for (std::size_t r = 0; r < rows_.size(); ++r) {
    const Row& row = rows_[r];
    if (!(fields[r].distance < 0)) continue;
    const Vec3 push = -h * row.stiffness * fields[r].distance * fields[r].normal;
    double lightness = 0;
    for (const auto& e : row.weights) lightness += e.weight * e.weight * inverse_mass[e.node];
    if (!(lightness > 0)) continue;
    const Vec3 y = row.rest + at(row, u), along = (now_ * (start.inverse() * y) - y) / h;  // what it touches moves so
    Vec3 slide = at(row, velocity) - along;
    slide -= fields[r].normal.dot(slide) * fields[r].normal;
    const double speed = slide.norm(), most = options_.friction * push.norm();
    const Vec3 total = push - (speed * (1 / lightness) > most ? most / speed : 1 / lightness) * slide;
    for (const auto& e : row.weights) velocity[e.node] += inverse_mass[e.node] * e.weight * total;
    sum_.force -= share / h * total;
    sum_.torque -= share / h * (y - now_.translation()).cross(total);
  }
}

void ObstaclePenalty::add_reaction(const std::vector<Vec3>& u, Reaction& to) const {
  const double share = ended_ - begun_;
  std::vector<Reaction> of(rows_.size());
  each_way(u, [&](std::size_t r, const Vec3& way) {
    const Vec3 f = share * pushed(rows_[r], way).force;
    of[r] = {f, (rows_[r].rest + way - now_.translation()).cross(f)};
  });
  for (const Reaction& r : of) to.force -= r.force, to.torque -= r.torque;
}

ObstaclePenalty::Reaction ObstaclePenalty::reaction(const std::vector<Vec3>& u) const {
  Reaction all = sum_;
  if (!impulses_) add_reaction(u, all);
  return all;
}

double ObstaclePenalty::depth(const std::vector<Vec3>& u) const {
  double most = 0;
  for (const Row& row : rows_) most = std::max(most, -inside(row, row.rest + at(row, u)).distance);
  return most;
}

}  // namespace geo
