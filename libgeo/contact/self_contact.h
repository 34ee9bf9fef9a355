// Self-contact (§ 3.3): the surface of a deforming body, which follows its nodes by Eq. 1 and does
// not come to cross itself.
//
// The surface has positions of its own. At each step the nodes move as if nothing touched; places
// that would pass through each other are found, and impulses on the nodes take away their approach;
// then the surface goes where Eq. 1 wants it, but for what would still cross (bounded_motion.h).
// How far it stays behind is reported, and made good as soon as there is room.
//
// Sheets are born together: copies of a site at the same coordinates, to the bit, that move as one
// (their average) and part along their own normals once Eq. 1 pulls them apart or along each other
// by more than its own noise.
#pragma once

#include <optional>

#include "contact/birth/birth.h"
#include "contact/detection/near_pairs.h"
#include "contact/motion/bounded_motion.h"
#include "contact/response/self_contact_penalty.h"
#include "contact/surface/contact_surface.h"
#include "contact/surface/surface_weights.h"
#include "kerf/run.h"
#include "kerf/scene.h"

namespace geo {

class SelfContact {
 public:
  /// The surface of a body at rest (no displacement), or at the positions of an earlier one (per
  /// surface vertex).
  SelfContact(const Body& body, const Solid& solid, const ContactOptions& options = {},
              std::vector<Vec3> positions = {});

  /// Before a crack step is made that will turn the surface into `grown`: where what is new will be
  /// (birth.h). Throws GeometryError when it would cross itself or what is there; the step must not
  /// be made then.
  void expect(const Body& body, const Solid& solid, const State& state, const Complex& grown, const CrackDelta& crack);
  /// After it was made; nothing happens where it changed nothing.
  void follow(const Body& body, const Solid& solid, const BodyDelta& delta);
  /// Before an implicit step of dt, at whose beginning state is: what parts of the surface that may
  /// come together in it do to each other (touch_penalty.h); null: nothing. It is valid until the
  /// next call. resolve() then leaves the nodes as they are.
  Potential* begin(const Body& body, const Solid& solid, const State& state, double dt, const Vec3& gravity,
                   const std::vector<std::uint8_t>& fixed);
  /// After a step of nodes that began at displacements `before` and took dt: moves the surface;
  /// displacements and velocities are corrected by impulses before, unless begin() was called.
  /// `fixed` (per node, or empty) as in Environment.
  void resolve(const Body& body, const Solid& solid, const std::vector<Vec3>& before, double dt,
               const std::vector<std::uint8_t>& fixed, State& state, ContactStats* work = nullptr);

  /// World positions, per surface vertex; of dead ones nothing is said.
  const std::vector<Vec3>& positions() const { return positions_; }
  /// Where displacements of nodes have each; kept until other ones are asked for.
  const std::vector<Vec3>& targets_at(const Body& body, const std::vector<Vec3>& u);
  const SurfaceWeights& weights() const { return weights_; }
  const ContactSurface& surface() const { return surface_; }

 private:
  std::vector<Vec3> targets(const Body& body, const std::vector<Vec3>& u) const;
  std::size_t apply_impulses_after(const Body& body, const Solid& solid, const std::vector<Vec3>& before, double dt,
                                   const std::vector<std::uint8_t>& fixed, std::span<const std::uint32_t> together,
                                   const Copies& copies, State& state);
  std::vector<Vec3> likely(const std::vector<Vec3>& goal, std::span<const std::uint32_t> together) const;
  const VertexFans& fans();
  // Which of the vertices are together where they are.
  struct Standing {
    std::vector<std::uint32_t> together;
    Copies copies;
  };
  const Standing& standing();

  ContactOptions options_;
  ContactSurface surface_;
  SurfaceWeights weights_;
  std::vector<Vec3> positions_;
  SelfContactPenalty touch_{SelfContactPenaltyOptions{}};
  NearPairs near_;                    // of the step that is worked on
  VertexFans fans_;                   // of the surface; empty: not asked for yet
  std::optional<Standing> standing_;  // empty: not asked for since positions_ changed
  // What targets_at() said last, of which displacements, and the vertices whose weights have
  // changed since.
  struct {
    std::vector<Vec3> targets, of;
    std::vector<std::uint32_t> stale;
  } last_;
  std::vector<Vec3>
      held_off_;        // how far the surface was from where nodes would have it at begin(); empty: no step has begun
  bool begun_ = false;  // a step that touch_ acts in
  Birth birth_;         // of the step that was expected last
};

}  // namespace geo
