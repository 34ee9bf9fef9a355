// The ends of an edge in the air go straight. An edge on the surface goes forward, and turns little
// by little.
#include "live/moving_edge.h"

#include <algorithm>
#include <span>

namespace live {
namespace {

constexpr double most_bend = 0.125;  // of a path in a frame, in node spacings: two of these on a circle of four

// The part of v across a unit direction.
geo::Vec3 across(const geo::Vec3& v, const geo::Vec3& direction) { return v - v.dot(direction) * direction; }

// The larger motion of an edge's two ends.
double way_between(const EdgePose& a, const EdgePose& b, double length) {
  const geo::Vec3 way = b.origin - a.origin;
  return std::max(way.norm(), (way + length * (b.direction - a.direction)).norm());
}

// A motion of an edge towards a pose of its path.
struct Advance {
  EdgePose pose;
  double way = 0;  // of its ends
  bool arrives = false;
};

// Both ends go straight.
Advance approach(const EdgePose& from, const EdgePose& to, double length, double most) {
  const double way = way_between(from, to, length);
  if (way <= most) return {to, way, true};
  EdgePose pose = from;
  pose.origin += most / way * (to.origin - from.origin);
  const geo::Vec3 direction = from.direction + most / way * (to.direction - from.direction);
  if (direction.norm() > 0.1) pose.direction = direction.normalized();
  return {pose, most, false};
}

// Moves an edge on the surface, no point of it farther than `most`. Normals of triangles jump. An
// edge that turned with them would sweep a sheet that crosses itself and cuts off crumbs. So the
// turn moves a point by at most `most_turn` of the way across the edge, and every point goes
// forward. The edge has arrived when it is at the point, however it is turned.
Advance follow(const EdgePose& from, const EdgePose& to, double length, double above, double most) {
  constexpr double most_turn = 0.5;
  const double reach = std::max(above, length - above);
  const geo::Vec3 begin = from.origin + above * from.direction;
  const geo::Vec3 all = to.origin + above * to.direction - begin;
  const double share = std::min(1.0, most / std::max((1 + most_turn) * all.norm(), 1e-300));
  const geo::Vec3 way = share * all, turn = share * (to.direction - from.direction);
  const double wanted = reach * turn.norm(), bound = most_turn * across(way, from.direction).norm();
  EdgePose pose;
  pose.direction = (from.direction + (wanted > bound ? bound / wanted : 1) * turn).normalized();
  pose.origin = begin + way - above * pose.direction;
  return {pose, (1 + most_turn) * way.norm(), share == 1};
}

double distance_to_segment(const geo::Vec3& p, const geo::Vec3& a, const geo::Vec3& b) {
  const geo::Vec3 way = b - a;
  const double size = way.squaredNorm(), at = size > 0 ? std::clamp((p - a).dot(way) / size, 0.0, 1.0) : 0;
  return (p - a - at * way).norm();
}

// Whether the ends of an edge that goes straight from a pose to another one come within `most` of
// where they are in the poses between.
bool is_straight(const EdgePose& from, std::span<const EdgePose> between, const EdgePose& to, double length,
                 double most) {
  const auto far_end = [&](const EdgePose& pose) { return geo::Vec3(pose.origin + length * pose.direction); };
  return std::all_of(between.begin(), between.end(), [&](const EdgePose& pose) {
    return distance_to_segment(pose.origin, from.origin, to.origin) <= most &&
           distance_to_segment(far_end(pose), far_end(from), far_end(to)) <= most;
  });
}

// The pose of an edge along local z, whose back is along local x.
geo::Pose pose_of(const geo::Vec3& origin, const geo::Vec3& direction, const geo::Vec3& back) {
  geo::Mat3 axes;
  axes << back, direction.cross(back), direction;
  return {origin, Eigen::Quaterniond(axes).normalized()};
}

}  // namespace

void MovingEdge::add_path(const Stroke& stroke) {
  for (const EdgePose& pose : stroke.way) add_pose(path_, pose);
  add_pose(path_, {stroke.origin, stroke.direction});
}

void MovingEdge::advance(double most, double spacing) {
  const EdgePose before = now_;
  chase(most, spacing);
  turn(before, spacing);
}

void MovingEdge::chase(double most, double spacing) {
  const EdgePose begin = now_;
  std::size_t passed = 0;
  double gone = 0;
  while (passed < path_.size() && gone < most) {
    const Advance step = above_ ? follow(now_, path_[passed], length_, *above_, most - gone)
                                : approach(now_, path_[passed], length_, most - gone);
    const std::span before(path_.data(), passed);
    if (!is_straight(begin, before, step.pose, length_, most_bend * spacing)) break;
    now_ = step.pose;
    gone += step.way;
    if (!step.arrives) break;
    path_[passed++] = step.pose;
  }
  path_.erase(path_.begin(), path_.begin() + static_cast<std::ptrdiff_t>(passed));
}

// Turns the back of a blade against its motion, little by little: material is beside it.
void MovingEdge::turn(const EdgePose& before, double spacing) {
  constexpr double least_motion = 0.02, share = 0.3;  // in node spacings; of the turn, in a frame
  const geo::Vec3 motion =
      across(now_.origin - before.origin + 0.5 * length_ * (now_.direction - before.direction), now_.direction);
  if (motion.norm() > least_motion * spacing) {
    const geo::Vec3 wanted = -motion.normalized();
    if (back_ == geo::Vec3::Zero())
      back_ = wanted;
    else if (wanted.dot(back_) > -0.5)  // else the pointer goes back on its way
      back_ += share * (wanted - back_);
  }
  if (back_ != geo::Vec3::Zero()) back_ = across(back_, now_.direction).normalized();
}

geo::Pose MovingEdge::pose_at(const EdgePose& edge) const {
  return pose_of(edge.origin, edge.direction, across(back_, edge.direction).normalized());
}

geo::Pose MovingEdge::pose() const { return pose_of(now_.origin, now_.direction, back_); }

}  // namespace live
