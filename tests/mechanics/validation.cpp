#include "mechanics/validation.h"

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "kerf/solid.h"
#include "mechanics/bodies.h"
#include "mechanics/solver/solid_discretisation.h"

namespace validation {
namespace {

using namespace geo;

// Cells that end where the block does, near enough: n of them across its unit section.
double spacing_for(int across) { return 1.03 / across; }

Material steel_like() {
  Material m;
  m.young = 1e5;
  m.poisson = 0.3;
  m.density = 1000;
  m.damping = 0;
  return m;
}

// A bar along x of unit section, as long as whole cells make it, held over the two cells at its
// foot, which come on top.
struct Bar {
  Body body;
  double foot, length;
  Environment environment;  // no gravity; foot fixed
  Bar(double about, int across) : Bar(spacing_for(across), std::lround(about / spacing_for(across)) + 2) {}
  // After cuts.
  void hold() {
    environment.fixed.clear();
    for (const Vec3& x : body.nodes.position) environment.fixed.push_back(x.x() < foot);
  }
  bool at_tip(const Vec3& x) const { return x.x() > foot + length - spacing(); }
  double spacing() const { return foot / 1.975; }
  // A force on the nodes of the last layer; returns where it acts.
  double load_tip(const Vec3& force) {
    environment.load.assign(body.nodes.size(), Vec3::Zero());
    double total = 0, place = 0;
    for (std::size_t i = 0; i < body.nodes.size(); ++i)
      if (at_tip(body.nodes.position[i])) {
        total += body.nodes.volume[i];
        place += body.nodes.volume[i] * (body.nodes.position[i].x() - foot);
      }
    for (std::size_t i = 0; i < body.nodes.size(); ++i)
      if (at_tip(body.nodes.position[i])) environment.load[i] = body.nodes.volume[i] / total * force;
    return place / total;
  }
  std::vector<Vec3> rest(Solid& solid) const {
    State state = at_rest(body);
    solid.step_implicit(state, 1e3, environment, 1e-7);
    return state.displacement;
  }
  std::vector<Vec3> rest(Solid&& solid) const { return rest(solid); }
  // The work of the load, over its size: the mean displacement where it acts.
  double along_load(const std::vector<Vec3>& u) const {
    double work = 0;
    Vec3 force = Vec3::Zero();
    for (std::size_t i = 0; i < u.size(); ++i) {
      work += environment.load[i].dot(u[i]);
      force += environment.load[i];
    }
    return work / force.norm();
  }

 private:
  // The cells are centred on the block, which ends a little within the outermost.
  Bar(double h, long cells)
      : body(block_body({h * (double(cells) - 0.05), 1, 1}, h, 0.5)),
        foot(1.975 * h),
        length(h * (double(cells) - 2.025)) {
    environment.gravity.setZero();
  }
};

// Timoshenko's shear coefficient of a rectangle (Cowper 1966).
double shear_factor(double poisson) { return 10 * (1 + poisson) / (12 + 11 * poisson); }

constexpr double inertia = 1.0 / 12;

}  // namespace

double Finding::error() const { return absolute ? std::abs(measured - expected) : std::abs(measured / expected - 1); }

std::vector<Finding> rigid_motion(int size) {
  const Body body = block_body({1, 1, 1}, size ? 0.08 : 0.16);
  Solid solid(body, steel_like());
  const Mat3 turn = Eigen::AngleAxisd(2.1, Vec3(1, -1, 2).normalized()).toRotationMatrix();
  std::vector<Vec3> u;
  for (const Vec3& x : body.nodes.position) u.push_back(turn * x - x + Vec3(3, 2, 1));
  return {{"Rigid motion: strain energy over E V", "0", solid.energy(u) / steel_like().young, 0, 1e-20, true}};
}

std::vector<Finding> patch(int size) {
  std::vector<Finding> found;
  for (const bool cracked : {false, true}) {
    Body body = block_body({1, 1, 1}, size ? 0.08 : 0.16);
    if (cracked) {
      auto front = begin_front(blade_at({0.46, -0.2, 1.2}, {0.53, 1.2, 1.2}, {0.01, 0, -0.25}, 0), false, 1);
      for (int k = 1; k <= 3; ++k)
        split(body, front, blade_at({0.46, -0.2, 1.2}, {0.53, 1.2, 1.2}, {0.01, 0, -0.25}, k));
    }
    Solid solid(body, steel_like());
    Mat3 linear;
    linear << 0.1, 0.02, -0.03, 0.01, -0.05, 0.04, 0.0, 0.06, 0.02;
    std::vector<Vec3> u;
    for (const Vec3& x : body.nodes.position) u.push_back(linear * x);
    double worst = 0;
    for (std::size_t b = 0; b < SolidDiscretisation::of(solid).points.blocks.size(); ++b) {
      const auto g = SolidDiscretisation::of(solid).points.gradients(b, u);
      for (std::size_t i = 0; i < g.size(); ++i) worst = std::max(worst, (g[i] - linear).cwiseAbs().maxCoeff());
    }
    found.push_back(
        {cracked ? "Patch test, with a crack half way through: worst error of ∇u" : "Patch test: worst error of ∇u",
         "u = G x: ∇u = G", worst, 0, 1e-10, true});
  }
  return found;
}

std::vector<Finding> tension(int size) {
  const Material m = steel_like();
  Bar bar(5, size ? 8 : 5);
  bar.hold();
  const double force = 1e-3 * m.young;
  bar.load_tip({force, 0, 0});
  Solid solid(bar.body, m);
  const auto u = bar.rest(solid);
  // The mean strain of the middle part.
  double strain = 0, across = 0, volume = 0;
  for (std::size_t b = 0; b < SolidDiscretisation::of(solid).points.blocks.size(); ++b) {
    const auto g = SolidDiscretisation::of(solid).points.gradients(b, u);
    for (std::size_t i = 0; i < g.size(); ++i) {
      const auto& p = SolidDiscretisation::of(solid).points.blocks[b].points[i];
      if (std::abs(p.position.x() - bar.foot - 2.5) > 1) continue;
      volume += p.volume;
      strain += p.volume * g[i](0, 0);
      across += 0.5 * p.volume * (g[i](1, 1) + g[i](2, 2));
    }
  }
  strain /= volume;
  across /= volume;
  return {{"Bar in tension: Young's modulus, Pa", "E = F / (A ε)", force / strain, m.young, 0.02},
          {"Bar in tension: Poisson's ratio", "ν = −ε⊥ / ε", -across / strain, m.poisson, 0.02}};
}

std::vector<Finding> cantilever(int size) {
  std::vector<Finding> found;
  const Material m = steel_like();
  for (const int across : size ? std::vector{5, 8, 11} : std::vector{4, 6, 8}) {
    Bar bar(8, across);
    bar.hold();
    const double force = 2e-5 * m.young, at = bar.load_tip({0, 0, -force});
    const double tip = force * at * at * at / (3 * m.young * inertia) + force * at / (shear_factor(m.poisson) * m.mu());
    found.push_back({"Cantilever, 8 long, " + std::to_string(across) + " cells across: tip, m",
                     "w = P L³ / (3 E I) + P L / (κ G A)", bar.along_load(bar.rest(Solid(bar.body, m))), tip,
                     across == 11 ? 0.03 : 0.1});
  }
  return found;
}

std::vector<Finding> frequency(int size) {
  const Material m = steel_like();
  Bar bar(10, size ? 6 : 4);
  bar.hold();
  Solid solid(bar.body, m);
  // Inverse iteration: K u = M u₀, again and again, from a shape like the mode. λ = u·K u / u·M u.
  std::vector<Vec3> shape;
  for (const Vec3& x : bar.body.nodes.position) shape.push_back({0, 0, std::pow(std::max(0.0, x.x() - bar.foot), 2)});
  double lambda = 0;
  for (int k = 0; k < 3; ++k) {
    double most = 0, stiff = 0, inert = 0;
    for (const Vec3& u : shape) most = std::max(most, u.norm());
    bar.environment.load.clear();
    for (std::size_t i = 0; i < shape.size(); ++i)
      bar.environment.load.push_back(bar.environment.fixed[i] ? Vec3(Vec3::Zero())
                                                              : Vec3(1e-5 / most * solid.mass(NodeId(i)) * shape[i]));
    shape = bar.rest(solid);
    for (std::size_t i = 0; i < shape.size(); ++i) {
      stiff += shape[i].dot(bar.environment.load[i]);
      inert += solid.mass(NodeId(i)) * shape[i].squaredNorm();
    }
    lambda = stiff / inert;
  }
  const double exact =
      1.8751 * 1.8751 / (2 * std::numbers::pi * bar.length * bar.length) * std::sqrt(m.young * inertia / m.density);
  return {{"Cantilever, 10 long: first bending frequency, Hz", "f = 1.875² / (2π L²) √(E I / ρ A)",
           std::sqrt(lambda) / (2 * std::numbers::pi), exact, 0.05}};
}

std::vector<Finding> free_fall(int size) {
  Body body = block_body({2, 0.6, 0.6}, size ? 0.1 : 0.16);
  Solid solid(body, steel_like());
  State state = at_rest(body);
  for (std::size_t i = 0; i < body.nodes.size(); ++i)
    state.velocity[i] = Vec3(1, 0.5, 2) + Vec3(0.4, 1, -0.3).cross(body.nodes.position[i] - Vec3(1, 0.3, 0.3));
  Environment env;
  const double dt = 0.02;
  const auto middles = [&] {
    std::array<Vec3, 4> sums;  // place and velocity of the left part, then of the right
    std::array<double, 2> mass{};
    sums.fill(Vec3::Zero());
    for (std::size_t i = 0; i < body.nodes.size(); ++i) {
      const std::size_t side = body.nodes.position[i].x() > 0.93;
      const double m = solid.mass(NodeId(i));
      mass[side] += m;
      sums[2 * side] += m * (body.nodes.position[i] + state.displacement[i]);
      sums[2 * side + 1] += m * state.velocity[i];
    }
    for (std::size_t side = 0; side < 2; ++side) {
      sums[2 * side] /= mass[side];
      sums[2 * side + 1] /= mass[side];
    }
    return sums;
  };
  auto front = begin_front(blade_at({0.93, -0.2, 0.8}, {0.93, 0.8, 0.8}, {0, 0, -0.25}, 0), false, 1);
  for (int k = 1; k <= 4; ++k) {
    solid.update(body, split(body, front, blade_at({0.93, -0.2, 0.8}, {0.93, 0.8, 0.8}, {0, 0, -0.25}, k)), state);
    solid.step_implicit(state, dt, env);
  }
  const auto begin = middles();
  const int steps = 25;
  for (int k = 0; k < steps; ++k) solid.step_implicit(state, dt, env);
  const auto end = middles();
  double worst = 0;
  for (std::size_t side = 0; side < 2; ++side) {
    const Vec3 there =
        begin[2 * side] + steps * dt * begin[2 * side + 1] + 0.5 * steps * (steps + 1) * dt * dt * env.gravity;
    worst = std::max(worst, (end[2 * side] - there).norm());
  }
  return {{"Bar cut through while it falls and spins: worst distance of the two middles from their parabolas, m",
           "xₙ = x₀ + n Δt v₀ + ½ g Δt² n (n + 1)", worst, 0, 1e-9, true}};
}

// Slit along its middle plane from the free end: two leaves, which share the load.
std::vector<Finding> slit_bar(int size) {
  const Material m = steel_like();
  Bar bar(8, size ? 8 : 6);
  const double open = 0.5 * bar.length;
  const Vec3 a(bar.foot + bar.length + 0.4, -0.3, 0.503), b(bar.foot + bar.length + 0.4, 1.3, 0.503),
      step(-(open + 0.4) / 9, 0, 0);
  auto front = begin_front(blade_at(a, b, step, 0, 4), false, 1);
  for (int k = 1; k <= 9; ++k) split(bar.body, front, blade_at(a, b, step, k, 4));
  bar.hold();
  const double force = 1e-5 * m.young, at = bar.load_tip({0, 0, -force}), leaf = at - (bar.length - open),
               whole = bar.length - open, ei = m.young * inertia;
  const double shear = force * at / (shear_factor(m.poisson) * m.mu());
  const double root = force * whole * whole * whole / (3 * ei) + force * leaf * whole * whole / (2 * ei),
               slope = force * whole * whole / (2 * ei) + force * leaf * whole / ei;
  const double expected = root + slope * leaf + force * leaf * leaf * leaf / (3 * ei / 4) + shear;
  return {{"Bar slit half its length along its middle: tip, m", "two leaves of I / 8 on the foot's end",
           bar.along_load(bar.rest(Solid(bar.body, m))), expected, 0.1}};
}

// Cut half through across, near mid-length: how much that adds. Where the crack lies between nodes
// changes that, so at four places.
std::vector<Finding> notched_bar(int) {
  const Material m = steel_like();
  const double force = 1e-5 * m.young;
  std::vector<Finding> found;
  Bar whole(4, 8);
  whole.hold();
  const double at = whole.load_tip({0, 0, -force}), uncut = whole.along_load(whole.rest(Solid(whole.body, m)));
  for (const double place : {2.0, 2.03, 2.06, 2.09}) {
    Bar bar(4, 8);
    const Vec3 a(bar.foot + place + 0.003, -0.3, 1.25), b(bar.foot + place + 0.003, 1.3, 1.25), step(0, 0, -0.25);
    auto front = begin_front(blade_at(a, b, step, 0, 4), false, 1);
    for (int k = 1; k <= 3; ++k) split(bar.body, front, blade_at(a, b, step, k, 4));
    bar.hold();
    bar.load_tip({0, 0, -force});
    // Rotation of an edge crack of half the depth in bending, plane strain to plane stress (Tada,
    // Paris and Irwin 2000, 2.14).
    const double s = 5.93 - 19.69 * 0.5 + 37.14 * 0.25 - 35.84 * 0.125 + 13.12 * 0.0625, arm = at - place,
                 moment = force * arm;
    const double rotation = 4 * 6 * moment / m.young * s;
    found.push_back({"Bar cut half through " + std::to_string(place).substr(0, 4) +
                         " from its foot: what the cut adds to the tip, m",
                     "Δw = (L − x) · 24 M S(½) / E, S(½) = 1.71 (Tada)",
                     bar.along_load(bar.rest(Solid(bar.body, m))) - uncut,
                     arm * rotation * (1 - 0.5 * m.poisson * m.poisson), 0.1});
  }
  return found;
}

}  // namespace validation
