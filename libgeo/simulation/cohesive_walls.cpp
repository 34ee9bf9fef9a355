// Faces keep the number of their crack when they are divided: a part belongs to the face of the
// bond that is nearest to its middle.
#include "simulation/cohesive_walls.h"

#include <algorithm>
#include <map>

#include "geometry/bvh.h"
#include "mechanics/terms/contact_law.h"
#include "simulation/strength.h"

namespace geo {
namespace {

// Time steps in which the traction falls to zero, at least: fewer would spend the energy too early
// or too late.
constexpr double steps_of_opening = 4;

CohesiveLaw law_of(const Cohesion& cohesion) { return {.peak = cohesion.peak, .opening = cohesion.opening}; }

}  // namespace

// Two sides that were pulled with a traction σ, and are free, part as far as the material beside
// them is relieved of its strain: on both sides of the wall as far as a pressure wave has run, and
// about as far as the wall is wide at last. That is 2 σ / (ρ c²) of this length.
CohesiveLaw CohesiveLaw::of(const GluedBond& bond, double limit, const Material& material, double dt) {
  if (bond.toughness == 0) return {};
  const double energy = bond.toughness * bond.toughness * (1 - material.poisson * material.poisson) / material.young;
  const double modulus = material.lambda() + 2 * material.mu();
  const double relieved = std::min(pressure_wave_speed(material) * dt, std::sqrt(bond.area));
  const double opening = std::max(2 * energy / limit, steps_of_opening * 2 * limit / modulus * relieved);
  return {.peak = 2 * energy / opening, .opening = opening};
}

double CohesiveLaw::traction(double reached) const {
  return std::max(0.0, peak * (opening - reached) / (opening - first()));
}

double CohesiveLaw::spent(double reached) const {
  return 0.5 * peak * opening * (std::min(reached, opening) - first()) / (opening - first());
}

double CohesiveLaw::energy(double delta, double reached) const {
  if (delta <= reached) return 0.5 * secant(delta, reached) * delta * delta;
  const double end = std::min(delta, opening);
  return 0.5 * traction(end) * end + spent(end) - spent(std::min(reached, opening));
}

double CohesiveLaw::secant(double delta, double reached) const {
  const double largest = std::max(delta, reached);
  return traction(largest) / largest;
}

std::vector<CohesiveWalls::Face> CohesiveWalls::faces_of(const Body& body, const GluedBonds& glued) {
  std::vector<Face> faces;
  std::vector<std::array<Vec3, 3>> corners;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> of;  // bond, and its face
  std::map<std::int32_t, Box3> cracks;
  for (std::uint32_t b = 0; b < glued.bonds.size(); ++b) {
    const GluedBond& bond = glued.bonds[b];
    if (!bond.cohesion.holds()) continue;
    for (std::uint32_t f = 0; f < bond.faces.size(); ++f) {
      const auto& [i, j, k] = bond.faces[f];
      corners.push_back({glued.points[i], glued.points[j], glued.points[k]});
      of.push_back({b, f});
      for (const Vec3& x : corners.back()) cracks[bond.cohesion.crack].add(x);
    }
  }
  if (corners.empty()) return faces;
  const TriangleBvh walls(corners);
  std::vector<FaceId> near;
  for (const auto& [crack, box] : cracks) {
    near.clear();
    body.surface.faces_near(box, near);
    for (const FaceId face : near) {
      if (body.surface.face(face).crack != crack) continue;
      const auto [a, b, c] = body.surface.corners(face);
      const auto [bond, part] = of[walls.closest((a + b + c) / 3).triangle];
      if (glued.bonds[bond].cohesion.crack != crack) continue;
      faces.push_back({.face = face, .bond = bond, .of = part, .area = 0.5 * (b - a).cross(c - a).norm()});
    }
  }
  return faces;
}

void CohesiveWalls::begin_step(const Body& body, const GluedBonds& glued, const SurfaceWeights& weights) {
  if (crack_steps_ != body.crack_steps) {
    terms_.clear();
    for (const Face& f : faces_of(body, glued)) add_term(f, body, glued, weights);
    crack_steps_ = body.crack_steps;
  }
  // Parts of a divided face share what it remembers, as they do after a checkpoint.
  for (Term& t : terms_) t.before = glued.bonds[t.at.bond].cohesion.reached[t.at.of];
  std::erase_if(terms_, [](const Term& t) { return !(t.before < t.law.opening); });
  for (Term& t : terms_) {
    t.offset = Vec3::Zero();
    for (int which = 0; which < 2; ++which)
      for (int k = 0; k < 3; ++k)
        t.offset +=
            (which == 0 ? 1.0 : -1.0) / 3 * weights.rotated(body.surface.surface_vertex({t.at.face, which}, k).index());
  }
}

void CohesiveWalls::add_term(const Face& at, const Body& body, const GluedBonds& glued, const SurfaceWeights& weights) {
  const Cohesion& cohesion = glued.bonds[at.bond].cohesion;
  const double reached = cohesion.reached[at.of];
  if (!(reached < cohesion.opening)) return;
  std::vector<NodeWeight> all;
  for (int which = 0; which < 2; ++which)
    for (int k = 0; k < 3; ++k) {
      const Stencil stencil = weights.stencil(body.surface.surface_vertex({at.face, which}, k).index());
      if (stencil.empty()) return;  // no node carries the vertex
      for (const NodeWeight& w : stencil) all.push_back({w.node, (which == 0 ? 1.0 : -1.0) / 3 * w.weight});
    }
  std::stable_sort(all.begin(), all.end(), [](const NodeWeight& a, const NodeWeight& b) { return a.node < b.node; });
  Term term{.stencil = {},
            .offset = Vec3::Zero(),
            .law = law_of(cohesion),
            .area = at.area,
            .before = reached,
            .reached = reached,
            .at = at};
  for (const NodeWeight& w : all) {
    if (term.stencil.empty() || term.stencil.back().node != w.node)
      term.stencil.push_back(w);
    else
      term.stencil.back().weight += w.weight;
  }
  terms_.push_back(std::move(term));
}

void CohesiveWalls::begin_substep(const std::vector<Vec3>& u, double from, double /*to*/) {
  for (Term& t : terms_)
    t.reached = from > 0 ? std::max(t.reached, (weighted_sum(t.stencil, u) + t.offset).norm()) : t.before;
}

double CohesiveWalls::end_step(const std::vector<Vec3>& u, GluedBonds& glued) {
  double spent = 0;
  for (const Term& t : terms_) {
    const double opening = (weighted_sum(t.stencil, u) + t.offset).norm();
    const double reached = std::max(t.reached, opening);
    spent += t.area * (t.law.spent(reached) - t.law.spent(t.before));
    double& largest = glued.bonds[t.at.bond].cohesion.reached[t.at.of];
    largest = std::max(largest, reached);
  }
  return spent;
}

double CohesiveWalls::energy(std::size_t k, const Vec3& d) const {
  const Term& t = terms_[k];
  return t.area * t.law.energy((d + t.offset).norm(), t.reached);
}

Potential::Derivatives CohesiveWalls::derivatives(std::size_t k, const Vec3& d) const {
  const Term& t = terms_[k];
  const Vec3 opening = d + t.offset;
  const double delta = opening.norm(), secant = t.area * t.law.secant(delta, t.reached);
  Derivatives result{.force = -secant * opening, .hessian = secant * Mat3::Identity()};
  if (delta > t.reached) result.hessian -= secant / (delta * delta) * opening * opening.transpose();
  return result;
}

double CohesiveWalls::stiffness_bound(std::size_t k) const {
  const Term& t = terms_[k];
  return t.area * t.law.secant(0, t.reached);
}

void CohesiveWalls::apply_impulse(const std::vector<Vec3>& u, double h, const std::vector<double>& inverse_mass,
                                  std::vector<Vec3>& velocity) {
  for (Term& t : terms_) {
    const Vec3 opening = weighted_sum(t.stencil, u) + t.offset;
    const double delta = opening.norm();
    add_impulse(t.stencil, -h * t.area * t.law.secant(delta, t.reached) * opening, inverse_mass, velocity);
    t.reached = std::max(t.reached, delta);
  }
}

}  // namespace geo
