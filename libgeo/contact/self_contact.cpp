#include "contact/self_contact.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "base/stopwatch.h"
#include "contact/crossing.h"
#include "contact/touching.h"
#include "geometry/distance.h"

namespace geo {
namespace {

// An orthonormal frame on a triangle.
Mat3 frame_of(const std::array<Vec3, 3>& t) {
  Mat3 frame;
  frame.col(0) = (t[1] - t[0]).normalized();
  frame.col(2) = (t[1] - t[0]).cross(t[2] - t[0]).normalized();
  frame.col(1) = frame.col(2).cross(frame.col(0));
  return frame;
}

// Where a triangle that moved from `rest` to `now` carries x, which is on it but for last places: these make the difference
// between slivers that cross and such that do not, so they turn with it.
Vec3 carried(const Vec3& x, const std::array<Vec3, 3>& rest, const std::array<Vec3, 3>& now) {
  const Vec3 w = barycentric(x, rest[0], rest[1], rest[2]);
  const Vec3 off = x - (w[0] * rest[0] + w[1] * rest[1] + w[2] * rest[2]);
  const Vec3 moved = w[0] * (now[0] - rest[0]) + w[1] * (now[1] - rest[1]) + w[2] * (now[2] - rest[2]);
  const Vec3 turned = frame_of(now) * (frame_of(rest).transpose() * off) - off;
  return x + moved + (turned.allFinite() ? turned : Vec3(Vec3::Zero()));
}

}  // namespace

ContactWork& ContactWork::operator+=(const ContactWork& o) {
  watched += o.watched, touching += o.touching, in_zones += o.in_zones, opened += o.opened, held += o.held;
  crossings = o.crossings, lag = std::max(lag, o.lag), seconds += o.seconds;
  return *this;
}

SelfContact::SelfContact(const Body& body, const Solid& solid, const ContactOptions& options, std::vector<Vec3> positions)
    : options_(options), surface_(contact_surface(body.surface)), positions_(std::move(positions)) {
  weights_.update(body, solid);
  if (positions_.size() != surface_.site.size())
    positions_ = targets(body, std::vector<Vec3>(solid.size(), Vec3::Zero()));
  else
    crossing_ = find_crossings(surface_.triangles, positions_, vertices_together(surface_.site, positions_), true);
}

std::vector<Vec3> SelfContact::targets(const Body& body, const std::vector<Vec3>& u) const {
  std::vector<Vec3> result(weights_.size(), Vec3::Zero());
  parallel_for(result.size(), 256, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v)
      if (const SurfaceVertexId id(v); body.surface.alive(id)) result[v] = body.surface.point(body.surface.site(id)) + weights_.at(v, u);
  });
  return result;
}

// Copies whose targets come apart, or slide along each other, are moved apart by half a gap each into their own material;
// where a triangle would cross another for it they stay together.
std::size_t SelfContact::open(const std::vector<Vec3>& to, const std::vector<std::vector<std::uint32_t>>& copies) {
  const double gap = options_.gap * surface_.edge;
  const std::vector<Vec3> normals = vertex_normals(surface_, positions_);
  std::vector<std::uint32_t> opening;
  for (std::uint32_t v = 0; v < copies.size(); ++v)
    for (std::size_t i = 0; i < copies[v].size(); ++i)
      for (std::size_t j = i + 1; j < copies[v].size(); ++j) {
        const auto a = copies[v][i], b = copies[v][j];
        const Vec3 n = (normals[b].normalized() - normals[a].normalized()).normalized(), apart = to[a] - to[b];
        const double along = n.dot(apart);
        if ((along > gap || (apart - along * n).norm() > 10 * gap) && (opening.empty() || opening.back() != v)) opening.push_back(v);
      }
  const std::size_t wanted = opening.size();
  const std::vector<Vec3> closed = positions_;
  // Smaller steps for those that would cross; what is left stays together.
  for (double step = 0.5 * gap; !opening.empty() && step > 1e-3 * gap; step *= 0.25) {
    std::vector<std::uint32_t> refused;
    std::vector<std::uint8_t> moved(positions_.size(), 0), marked(surface_.triangles.size(), 0), bad(positions_.size(), 0);
    for (const auto v : opening)
      for (const auto c : copies[v]) positions_[c] -= step * normals[c].normalized(), moved[c] = 1;
    for (;;) {
      for (std::size_t t = 0; t < marked.size(); ++t) marked[t] = std::any_of(surface_.triangles[t].begin(), surface_.triangles[t].end(), [&](auto v) { return moved[v]; });
      const auto crossings = find_crossings(surface_.triangles, positions_, vertices_together(surface_.site, positions_), true, &marked);
      if (crossings.empty()) break;
      for (const auto& [s, t] : crossings)
        for (const auto& triangle : {surface_.triangles[s], surface_.triangles[t]})
          for (const auto v : triangle) bad[v] = 1;
      bool undone = false;
      for (const auto v : opening)
        if (std::any_of(copies[v].begin(), copies[v].end(), [&](auto c) { return bad[c] && moved[c]; })) {
          for (const auto c : copies[v]) positions_[c] = closed[v], moved[c] = 0;
          refused.push_back(v), undone = true;
        }
      if (!undone) break;
    }
    opening.swap(refused);
  }
  return wanted - opening.size();
}

void SelfContact::resolve(const Body& body, const Solid& solid, const std::vector<Vec3>& before, double dt, const std::vector<std::uint8_t>& fixed,
                          State& state, ContactWork* told) {
  Stopwatch clock;
  ContactWork work;
  const std::size_t n = solid.size();
  const double gap = options_.gap * surface_.edge, reach = 20 * gap;
  std::vector<double> inverse_mass(n);
  std::vector<Vec3> velocity(n), u(n);
  for (std::size_t i = 0; i < n; ++i) {
    inverse_mass[i] = fixed.empty() || !fixed[i] ? 1 / solid.mass(NodeId(i)) : 0;
    velocity[i] = (state.displacement[i] - before[i]) / dt;
  }
  const std::vector<Vec3> free = velocity;
  auto together = vertices_together(surface_.site, positions_);
  auto copies = copies_together(together);
  auto to = targets(body, state.displacement);
  const auto average = [&] {
    std::vector<Vec3> result = to;
    for (std::size_t v = 0; v < copies.size(); ++v)
      if (copies[v].size() > 1) {
        Vec3 sum = Vec3::Zero();
        for (const auto c : copies[v]) sum += to[c];
        result[v] = sum / double(copies[v].size());
      }
    for (std::size_t v = 0; v < copies.size(); ++v) result[v] = result[together[v]];
    return result;
  };
  const std::vector<Vec3> normals = vertex_normals(surface_, positions_);
  std::vector<std::vector<std::uint32_t>> alone(copies.size());
  for (std::uint32_t v = 0; v < alone.size(); ++v) alone[v] = {v};
  // What touches in the motion to the targets, and the change of velocities that keeps it from approaching.
  std::vector<Watched> watched;
  const auto respond = [&](const Constraint& constraint, const ImpulseOptions& how, std::vector<Vec3>& change) {
    const std::vector<Vec3> goal = average();
    const SurfaceMotion motion{surface_.triangles, together, positions_, goal, gap, reach, crossing_};
    if (watched.empty()) watched = watch(motion);
    else turn_to_end(watched, motion);
    const auto touching = touching_places(watched, motion, constraint);
    std::vector<TouchingPlaces> sides;
    touching_copies(copies, to, normals, 0.01 * gap, constraint, sides);
    const std::size_t count = apply_impulses(weights_, touching, copies, inverse_mass, how, change).touching;
    return count + apply_impulses(weights_, sides, alone, inverse_mass, how, change).touching;
  };
  ImpulseOptions how;
  how.friction = options_.friction;
  for (int round = 0; round < options_.rounds; ++round) {
    const std::size_t count = respond({dt}, how, velocity);
    work.touching += count;
    if (count == 0) break;
    for (std::size_t i = 0; i < n; ++i) u[i] = state.displacement[i] + dt * (velocity[i] - free[i]);
    to = targets(body, u);
  }
  if (work.touching > 0) {
    // Where nodes have let their surfaces pass through each other all the same, they are brought back without velocity.
    std::vector<Vec3> back(n, Vec3::Zero());
    how.friction = 0;
    respond({dt, options_.recovery}, how, back);
    for (std::size_t i = 0; i < n; ++i) {
      state.displacement[i] += dt * (velocity[i] - free[i] + back[i]);
      state.velocity[i] += velocity[i] - free[i];
    }
    to = targets(body, state.displacement);
  }
  if (work.opened = open(to, copies); work.opened > 0) together = vertices_together(surface_.site, positions_), copies = copies_together(together);
  const std::vector<Vec3> goal = average();
  BoundedMotion bounded;
  positions_ = move_without_crossing({surface_.triangles, together, positions_, goal, gap, reach, crossing_}, true, &bounded);
  if (!crossing_.empty()) crossing_ = find_crossings(surface_.triangles, positions_, vertices_together(surface_.site, positions_), true);
  work.crossings = crossing_.size();
  work.watched = bounded.watched, work.in_zones = bounded.in_zones, work.held = bounded.held;
  for (const auto& t : surface_.triangles)
    for (const auto v : t) work.lag = std::max(work.lag, (positions_[v] - to[v]).norm());
  work.seconds = clock.lap();
  if (told) *told += work;
}

void SelfContact::follow(const Body& body, const Solid& solid, const BodyDelta& delta, const State& state, ContactWork* told) {
  Stopwatch clock;
  const Complex& k = body.surface;
  // Where the corners of the sides were that are no more.
  std::vector<Triangle> old_side(2 * k.face_count(), Triangle{~0u, ~0u, ~0u});  // by face and side
  for (std::size_t t = 0; t < surface_.triangles.size(); ++t) {
    const auto& [a, b, c] = surface_.triangles[t];
    old_side[surface_.side[t]] = surface_.side[t] % 2 == 0 ? Triangle{a, b, c} : Triangle{a, c, b};
  }
  surface_ = contact_surface(k);
  weights_.update(body, solid);
  positions_.resize(surface_.site.size(), Vec3::Zero());
  const std::vector<Vec3> to = targets(body, state.displacement);
  const std::vector<Vec3> old = positions_;
  std::vector<std::uint8_t> is_new(positions_.size(), 0), placed(positions_.size(), 0);
  const auto& crack = delta.crack;
  for (const auto v : crack.new_surface_vertices) is_new[v.index()] = 1;
  // A side that is still there has its corners where they were.
  for (std::size_t t = 0; t < surface_.triangles.size(); ++t) {
    const Side side{FaceId(surface_.side[t] / 2), static_cast<int>(surface_.side[t] % 2)};
    if (surface_.side[t] >= old_side.size()) continue;
    const Triangle& at = old_side[surface_.side[t]];
    if (at[0] == ~0u) continue;
    for (int c = 0; c < 3; ++c)
      if (const auto v = k.surface_vertex(side, c); is_new[v.index()] && !placed[v.index()]) positions_[v.index()] = old[at[static_cast<std::size_t>(c)]], placed[v.index()] = 1;
  }
  // On old faces: each part of one gives its new corners their place in it, the lowest face that has one first.
  std::vector<FaceId> parents = crack.removed_faces, parts;
  std::sort(parents.begin(), parents.end());
  std::set_difference(crack.new_faces.begin(), crack.new_faces.end(), crack.new_crack_faces.begin(), crack.new_crack_faces.end(), std::back_inserter(parts));
  for (const FaceId g : parents) {
    const auto corners = k.corners(g);
    const Box3 box = box_of(corners[0], corners[1], corners[2]).grown(1e-12 * k.extent().diagonal());
    for (const FaceId f : parts) {
      if (k.face(f).crack != k.face(g).crack || !box.meets(k.box(f))) continue;
      const auto part = k.corners(f);
      const Vec3 middle = (part[0] + part[1] + part[2]) / 3;
      if ((closest_point_on_triangle(middle, corners[0], corners[1], corners[2]) - middle).norm() > 1e-10 * k.extent().diagonal()) continue;
      for (int which = 0; which < 2; ++which) {
        if (!k.has({f, which}) || old_side[2 * g.index() + static_cast<std::size_t>(which)][0] == ~0u) continue;
        const Triangle& at = old_side[2 * g.index() + static_cast<std::size_t>(which)];
        for (int c = 0; c < 3; ++c) {
          const auto v = k.surface_vertex({f, which}, c);
          if (!is_new[v.index()] || placed[v.index()]) continue;
          const auto& own = k.face(g).v;
          const auto same = static_cast<std::size_t>(std::find(own.begin(), own.end(), k.face(f).v[static_cast<std::size_t>(c)]) - own.begin());
          positions_[v.index()] = same < 3 ? old[at[same]] : carried(part[static_cast<std::size_t>(c)], corners, {old[at[0]], old[at[1]], old[at[2]]});
          placed[v.index()] = 1;
        }
      }
    }
  }
  // Inside: together, on average where Eq. 1 has the copies.
  std::vector<std::pair<std::uint32_t, std::uint32_t>> inside;
  for (const auto v : crack.new_surface_vertices)
    if (k.alive(v) && !placed[v.index()]) inside.push_back({surface_.site[v.index()], v.value});
  std::sort(inside.begin(), inside.end());
  for (std::size_t i = 0, j = 0; i < inside.size(); i = j) {
    Vec3 sum = Vec3::Zero();
    for (j = i; j < inside.size() && inside[j].first == inside[i].first; ++j) sum += to[inside[j].second];
    for (std::size_t c = i; c < j; ++c) positions_[inside[c].second] = sum / double(j - i);
  }
  crossing_ = find_crossings(surface_.triangles, positions_, vertices_together(surface_.site, positions_), true);
  if (told) told->crossings = crossing_.size(), told->seconds += clock.lap();
}

}  // namespace geo
