// Points are those of Solid::update_points(), which does nothing where they are up to date.
#include "simulation/cut_solid.h"

#include <utility>

namespace geo {

CutSolid::CutSolid(const Body& body, State& motion, Materials materials)
    : body_(body), motion_(motion), solid_(body, std::move(materials)) {
  solid_.set_rotations(motion);
}

void CutSolid::restart(Materials materials) {
  if (has_followed_) return rebuild(std::move(materials));
  solid_.set_materials(materials);
  solid_.set_rotations(motion_);
}

void CutSolid::rebuild(Materials materials) {
  has_followed_ = false;
  solid_ = Solid(body_, std::move(materials));
  solid_.set_rotations(motion_);
}

void CutSolid::follow(const BodyDelta& delta) {
  has_followed_ = true;
  solid_.update_nodes(body_, delta, motion_);
}

Solid& CutSolid::whole() {
  const std::lock_guard lock(updating_);
  solid_.update_points(body_, motion_);
  return solid_;
}

}  // namespace geo
