// Pieces of a solid that move as a whole in an implicit step: what is stiff turns without a strain,
// and what nothing touches keeps its momenta.
#include <algorithm>

#include "mechanics/solver/ground.h"
#include "mechanics/solver/implicit_step.h"

namespace geo {
namespace {

// Of a spacing: how much too long the straight way of what turns may be before it goes round.
constexpr double felt = 1e-4;

bool goes_round(const RigidMotion& motion, double spacing) {
  return 0.5 * motion.turning.squaredNorm() * motion.reach > felt * spacing;
}

}  // namespace

// Where a node of the nodal discretisation sees too little to know a rotation from a strain, its
// piece turns as the potential has it, and is not told to.
void ImplicitStep::find_pieces() {
  pieces_.resize(parts_.pieces()), freedom_.assign(parts_.pieces(), Freedom::way_and_turn);
  for (std::size_t i = 0; i < n_; ++i) {
    Piece& piece = pieces_[piece_of(i)];
    piece.part = parts_.of(i), piece.spacing = std::min(piece.spacing, s_.spacing_[i]);
    Freedom& freedom = freedom_[piece_of(i)];
    if (is_fixed(env_, i))
      freedom = Freedom::none;
    else if (freedom == Freedom::way_and_turn && !s_.galerkin_ && s_.rows_.quality(i) != MomentQuality::good)
      freedom = Freedom::way;
  }
}

// Where pieces that nothing holds would be, had they gone where u_ is as rigid bodies do. Marks the
// parts of those that turn by enough to matter; nothing where there are none.
std::vector<Vec3> ImplicitStep::gone_round(std::vector<char>& turns) const {
  const auto at = [&](std::size_t i) -> Vec3 { return s_.position_[i] + state_.displacement[i]; };
  const auto motion = rigid_motions(parts_.piece_of_nodes(), freedom_, s_.mass_, at,
                                    [&](std::size_t i) -> Vec3 { return u_[i] - state_.displacement[i]; });
  turns.assign(parts_.count(), 0);
  bool any = false;
  for (std::size_t p = 0; p < motion.size(); ++p)
    if (goes_round(motion[p], pieces_[p].spacing)) turns[pieces_[p].part] = any = true;
  if (!any) return {};
  std::vector<Vec3> displacement = state_.displacement;
  parallel_for(n_, 1024, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      if (freedom_[piece_of(i)] != Freedom::none) displacement[i] += motion[piece_of(i)].displacement(at(i));
  });
  return displacement;
}

// How a direction from u_ on turns pieces that nothing holds, where that is enough to matter: these
// go round, and not straight on.
std::vector<RigidMotion> ImplicitStep::turning_by(const std::vector<Vec3>& direction) const {
  const auto at = [&](std::size_t i) -> Vec3 { return s_.position_[i] + u_[i]; };
  auto motion = rigid_motions(parts_.piece_of_nodes(), freedom_, s_.mass_, at,
                              [&](std::size_t i) -> Vec3 { return direction[i]; });
  for (std::size_t p = 0; p < motion.size(); ++p)
    if (!goes_round(motion[p], pieces_[p].spacing)) motion[p] = {};
  return motion;
}

// Internal forces do not change how a piece that nothing touches moves and turns as a whole:
// neither must rounding or an unfinished solve. The direction takes such a piece to where inertia
// and loads alone bring it.
void ImplicitStep::keep_momentum(std::vector<Vec3>& direction) const {
  std::vector<Freedom> freedom = freedom_;
  for (std::size_t i = 0; i < n_; ++i)
    if (Freedom& f = freedom[piece_of(i)]; f != Freedom::none) {
      const bool on_ground = env_.ground && (drag_[i] > 0 || depth(env_, i, s_.position_[i] + u_[i]) > 0);
      if (!parts_.chosen()[parts_.of(i)] || on_ground || contact_.acts_on(i)) f = Freedom::none;
    }
  if (std::all_of(freedom.begin(), freedom.end(), [](Freedom f) { return f == Freedom::none; })) return;
  const auto at = [&](std::size_t i) -> Vec3 { return s_.position_[i] + u_[i]; };
  const auto missing = [&](std::size_t i) -> Vec3 {
    return target_[i] + dt_ * dt_ / s_.mass_[i] * load_[i] - u_[i] - direction[i];
  };
  const auto motion = rigid_motions(parts_.piece_of_nodes(), freedom, s_.mass_, at, missing);
  parts_.each_node([&](std::size_t i) {
    if (freedom[piece_of(i)] != Freedom::none) direction[i] += motion[piece_of(i)].straight(at(i));
  });
}

}  // namespace geo
