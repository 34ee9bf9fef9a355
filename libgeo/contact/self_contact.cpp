#include "contact/self_contact.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "contact/response/contact_constraints.h"
#include "contact/surface/open_sheets.h"
#include "kerf/crossing.h"
#include "kerf/parallel.h"
#include "kerf/progress.h"

namespace geo {
namespace {

constexpr std::size_t vertices_a_task = 1024;

// Copies that are together go to their average.
std::vector<Vec3> averaged(const std::vector<Vec3>& to, std::span<const std::uint32_t> together, const Copies& copies) {
  std::vector<Vec3> result(to.size());
  parallel_for(to.size(), vertices_a_task, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v) {
      const auto all = copies[together[v]];
      if (all.size() == 1) {
        result[v] = to[v];
        continue;
      }
      Vec3 sum = Vec3::Zero();
      for (const auto c : all) sum += to[c];
      result[v] = sum / double(all.size());
    }
  });
  return result;
}

constexpr std::size_t most_between =
    4;  // couples of places between two nodes' surroundings: three keep planes from meeting

}  // namespace

ContactStats& ContactStats::operator+=(const ContactStats& o) {
  planes += o.planes, touching += o.touching, in_zones += o.in_zones, opened += o.opened, held += o.held;
  tracking_error = std::max(tracking_error, o.tracking_error), seconds += o.seconds;
  return *this;
}

SelfContact::SelfContact(const Body& body, const Solid& solid, const ContactOptions& options,
                         std::vector<Vec3> positions)
    : options_(options), surface_(contact_surface(body.surface)), positions_(std::move(positions)) {
  weights_.update(body, solid);
  if (positions_.size() != surface_.site.size())
    positions_ = targets(body, std::vector<Vec3>(solid.size(), Vec3::Zero()));
}

const VertexFans& SelfContact::fans() {
  if (fans_.size() != positions_.size()) fans_ = VertexFans(surface_.triangles, positions_.size());
  return fans_;
}

const SelfContact::Standing& SelfContact::standing() {
  if (!standing_) {
    std::vector<std::uint32_t> together = vertices_together(surface_.site, positions_);
    Copies copies(together);
    standing_.emplace(std::move(together), std::move(copies));
  }
  return *standing_;
}

std::vector<Vec3> SelfContact::targets(const Body& body, const std::vector<Vec3>& u) const {
  std::vector<std::uint32_t> all(weights_.size());
  std::iota(all.begin(), all.end(), 0u);
  std::vector<Vec3> result = weights_.at_each(all, u);
  parallel_for(result.size(), vertices_a_task, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v)
      if (const SurfaceVertexId id(v); body.surface.alive(id))
        result[v] = body.surface.point(body.surface.site(id)) + result[v];
  });
  return result;
}

// The same. Where nodes are where they were at the last call, only what has other weights since is
// worked out.
const std::vector<Vec3>& SelfContact::targets_at(const Body& body, const std::vector<Vec3>& u) {
  if (last_.of.size() <= u.size() && !last_.of.empty() && std::equal(last_.of.begin(), last_.of.end(), u.begin())) {
    last_.targets.resize(weights_.size(), Vec3::Zero());
    const auto moved = weights_.at_each(last_.stale, u);
    for (std::size_t i = 0; i < moved.size(); ++i) {
      const SurfaceVertexId v(last_.stale[i]);
      last_.targets[v.index()] =
          body.surface.alive(v) ? Vec3(body.surface.point(body.surface.site(v)) + moved[i]) : Vec3(Vec3::Zero());
    }
  } else {
    last_.targets = targets(body, u);
  }
  last_.of = u, last_.stale.clear();
  return last_.targets;
}

Potential* SelfContact::begin(const Body& body, const Solid& solid, const State& state, double dt, const Vec3& gravity,
                              const std::vector<std::uint8_t>& fixed) {
  constexpr double clear = 0.02,
                   watched_from =
                       0.05;         // of a mean edge: what places are kept apart, and from where on they are looked at
  constexpr double recovered = 0.5;  // share of what they lack that a step is to make good
  constexpr double firmness = 4;     // of a couple, beside that of the material about it
  const std::size_t n = solid.size();
  const double gap = options_.gap * surface_.edge, reach = watched_from * surface_.edge;
  std::vector<double> inverse_mass(n);
  std::vector<Vec3> u = state.displacement;
  double spacing = 0;
  for (std::size_t i = 0; i < n; ++i) {
    inverse_mass[i] = 1 / solid.mass(NodeId(i)), spacing += body.nodes.spacing[i] / double(n);
    if (fixed.empty() || !fixed[i]) u[i] += dt * state.velocity[i] + dt * dt * gravity;
  }
  const auto& [together, copies] = standing();
  const std::vector<Vec3>& now = targets_at(body, state.displacement);
  const std::vector<Vec3> free = targets(body, u);
  const std::vector<Vec3> here = averaged(now, together, copies), goal = averaged(free, together, copies);
  held_off_.resize(here.size());
  parallel_for(held_off_.size(), vertices_a_task, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v) held_off_[v] = positions_[v] - here[v];
  });
  const SurfaceMotion motion{surface_.triangles, together, positions_, goal, gap, reach};
  touch_.restart({options_.friction, 1e-2 * dt * dt * gravity.norm() + 1e-9 * surface_.edge});
  std::vector<double> stiffness;  // per material, 1/s²
  for (const Material& m : solid.materials().all())
    stiffness.push_back(firmness * m.young / (m.density * spacing * spacing) + 1 / (dt * dt));
  const auto stiffness_at = [&](const SurfacePoint& p) {
    const auto node = weights_.heaviest()[p.vertex[0]];
    return stiffness[node == ~0u ? 0 : solid.materials().number(node)];
  };
  // Of two places: as of springs one behind the other.
  const auto firm = [&](const ContactConstraint& t, const RelativeStencil& row) {
    const double a = stiffness_at(t.a), b = stiffness_at(t.b);
    return a == b ? a / (row.of_a + row.of_b) : 1 / (row.of_a / a + row.of_b / b);
  };
  // How far along their normal places were made apart: what is less than they should keep stays so.
  const auto made_apart = [&](const ContactConstraint& t) {
    const auto at_rest = [&](const SurfacePoint& p) {
      Vec3 sum = Vec3::Zero();
      for (int k = 0; k < p.size; ++k) sum += p.weight[k] * body.surface.point(VertexId(surface_.site[p.vertex[k]]));
      return sum;
    };
    return (at_rest(t.a) - at_rest(t.b)).norm() *
           t.normal.dot((place(t.a, positions_) - place(t.b, positions_)).normalized());
  };
  const auto add = [&](const std::vector<ContactConstraint>& touching, const Copies& stands_for,
                       const std::vector<Vec3>& at, double distance) {
    const std::vector<RelativeStencil> rows = relative_stencils(weights_, touching, stands_for, inverse_mass);
    std::vector<double> depth(rows.size());
    std::vector<Vec3> start(rows.size());
    parallel_for(rows.size(), 64, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        const double limit = distance > 0 ? std::min(distance, made_apart(touching[i])) : 0;
        const double lack = limit - touching[i].normal.dot(place(touching[i].a, at) - place(touching[i].b, at));
        depth[i] = lack > 0 ? recovered * lack : lack, start[i] = weighted_sum(rows[i].entries, state.displacement);
      }
    });
    touch_.reserve(rows);
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const double alone =
          rows[i].of_a +
          rows[i].of_b;  // as if they had no nodes in common: else near a front couples would be too firm
      if (alone > 0) touch_.add(rows[i], touching[i].normal, depth[i], firm(touching[i], rows[i]), start[i]);
    }
  };
  add(deepest_constraints(
          contact_constraints(watch(motion, near_, weights_.heaviest(), 2 * most_between), motion, {dt, 0, reach}),
          weights_, most_between),
      copies, here, gap + clear * surface_.edge);
  std::vector<ContactConstraint> sides;
  add_sheet_constraints(copies, free, vertex_normals(surface_, fans(), copies, positions_), -reach, {dt}, sides);
  add(deepest_constraints(sides, weights_, most_between), Copies::each_alone(copies.size()), now, 0);
  begun_ = true;
  return touch_.size() > 0 ? &touch_ : nullptr;
}

// For steps whose forces know nothing of contact: returns how many places touched.
std::size_t SelfContact::apply_impulses_after(const Body& body, const Solid& solid, const std::vector<Vec3>& before,
                                              double dt, const std::vector<std::uint8_t>& fixed,
                                              std::span<const std::uint32_t> together, const Copies& copies,
                                              State& state) {
  const std::size_t n = solid.size();
  const double gap = options_.gap * surface_.edge;
  std::vector<double> inverse_mass(n);
  std::vector<Vec3> velocity(n), u = state.displacement;
  for (std::size_t i = 0; i < n; ++i) {
    inverse_mass[i] = fixed.empty() || !fixed[i] ? 1 / solid.mass(NodeId(i)) : 0;
    velocity[i] = (state.displacement[i] - before[i]) / dt;
  }
  const std::vector<Vec3> free = velocity, normals = vertex_normals(surface_, fans(), copies, positions_);
  const Copies alone = Copies::each_alone(copies.size());
  // What touches in the motion to where u has the surface, and the change of velocities that keeps
  // it from approaching.
  std::vector<Watched> watched;
  const auto respond = [&](const ConstraintOptions& constraint, const ImpulseOptions& how, std::vector<Vec3>& change) {
    const std::vector<Vec3> to = targets(body, u), goal = averaged(to, together, copies);
    const SurfaceMotion motion{surface_.triangles, together, positions_, goal, gap, 2 * gap};
    if (watched.empty()) watched = watch(motion, near_);
    const auto touching = deepest_constraints(contact_constraints(watched, motion, constraint), weights_, most_between);
    std::vector<ContactConstraint> all_sides;
    add_sheet_constraints(copies, to, normals, 0.01 * gap, constraint, all_sides);
    const auto sides = deepest_constraints(all_sides, weights_, most_between);
    const std::size_t count = apply_impulses(weights_, touching, copies, inverse_mass, how, change).touching;
    return count + apply_impulses(weights_, sides, alone, inverse_mass, how, change).touching;
  };
  ImpulseOptions how;
  how.friction = options_.friction;
  std::size_t touching = 0;
  for (int round = 0; round < options_.rounds; ++round) {
    const std::size_t count = respond({dt}, how, velocity);
    touching += count;
    if (count == 0) break;
    for (std::size_t i = 0; i < n; ++i) u[i] = state.displacement[i] + dt * (velocity[i] - free[i]);
  }
  if (touching == 0) return 0;
  // Where nodes have let their surfaces pass through each other all the same, they are brought back
  // without velocity.
  std::vector<Vec3> back(n, Vec3::Zero());
  how.friction = 0;
  respond({dt, options_.recovery}, how, back);
  for (std::size_t i = 0; i < n; ++i) {
    state.displacement[i] += dt * (velocity[i] - free[i] + back[i]);
    state.velocity[i] += velocity[i] - free[i];
  }
  return touching;
}

// What kept places from where nodes would have them when the step began is likely to do so at its
// end. Where it does not, they come back by and by.
std::vector<Vec3> SelfContact::likely(const std::vector<Vec3>& goal, std::span<const std::uint32_t> together) const {
  constexpr double stays = 0.9, negligible = 1e-3;  // a step; of a mean edge
  std::vector<Vec3> result = goal;
  parallel_for(std::min(result.size(), held_off_.size()), vertices_a_task, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v)
      if (const Vec3& off = held_off_[together[v]]; off.norm() > negligible * surface_.edge) result[v] += stays * off;
  });
  return result;
}

void SelfContact::resolve(const Body& body, const Solid& solid, const std::vector<Vec3>& before, double dt,
                          const std::vector<std::uint8_t>& fixed, State& state, ContactStats* told) {
  Stopwatch clock;
  ContactStats work;
  work.touching =
      begun_ ? touch_.pressing()
             : apply_impulses_after(body, solid, before, dt, fixed, standing().together, standing().copies, state);
  const std::vector<Vec3>& to = targets_at(body, state.displacement);
  work.opened = open_sheets(surface_, fans(), standing().copies, to, options_.gap * surface_.edge,
                            options_.opening * surface_.edge, positions_);
  if (work.opened > 0) standing_.reset();
  const auto& [together, copies] = standing();
  const std::vector<Vec3> goal = averaged(to, together, copies);
  const double gap = options_.gap * surface_.edge;
  const std::vector<Vec3> guess = likely(goal, together);
  BoundedMotionStats bounded;
  positions_ =
      move_without_crossing({surface_.triangles, together, positions_, goal, gap, 2 * gap, begun_ ? &guess : nullptr},
                            true, &bounded, &near_, &fans());
  standing_.reset();
  work.planes = bounded.planes, work.in_zones = bounded.in_zones, work.held = bounded.held;
  for (std::size_t v = 0; v < to.size(); ++v)
    if (body.surface.alive(SurfaceVertexId(v)))
      work.tracking_error = std::max(work.tracking_error, (positions_[v] - to[v]).norm());
  work.seconds = clock.lap();
  begun_ = false, near_.forget(), held_off_.clear();
  if (told) *told += work;
}

void SelfContact::expect(const Body& body, const Solid& solid, const State& state, const Complex& grown,
                         const CrackDelta& crack) {
  birth_ = give_birth(body, solid, state, surface_, positions_, grown, crack, options_.gap * surface_.edge);
}

void SelfContact::follow(const Body& body, const Solid& solid, const BodyDelta& delta) {
  if (delta.crack.empty()) return;
  surface_ = std::move(birth_.surface), positions_ = std::move(birth_.positions);
  fans_ = {}, standing_.reset(), near_.forget_triangles();
  const auto stale = weights_.follow(body, solid, delta);
  last_.stale.insert(last_.stale.end(), stale.begin(), stale.end());
}

}  // namespace geo
