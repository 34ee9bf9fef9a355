// Where Newton's method begins.
#include <algorithm>

#include "mechanics/solver/ground.h"
#include "mechanics/solver/implicit_step.h"

namespace geo {

// Nodes go on as they are, and parts whose accelerations are much the same from node to node, as those of what falls or
// swings, accelerate as in the step before, or, where that is unknown, as they would on their own. Other accelerations
// are mostly of what trembles, which goes on otherwise.
void ImplicitStep::go_on() {
  constexpr double alike = 0.8;  // of squares
  u_ = target_;
  const bool known = state_.acceleration.size() == n_;
  std::vector<Vec3> more(n_, Vec3::Zero());
  parts_.each_node([&](std::size_t i) {
    const Vec3 way = dt_ * dt_ * (known ? state_.acceleration[i] : Vec3(load_[i] / s_.mass_[i]));
    if (!is_fixed(env_, i) && way.norm() < (known ? 0.5 : 1.0) * s_.spacing_[i])
      more[i] = way;  // else it is too far from anything
  });
  // The squares that the affine field nearest to them has, of all.
  std::vector<double> mass, squares;
  std::vector<Vec3> middle, mean;
  std::vector<Mat3> spread, slope;
  const auto m = [&](std::size_t i) { return is_fixed(env_, i) ? 0.0 : s_.mass_[i]; };
  const auto arm = [&](std::size_t i) -> Vec3 { return s_.position_[i] - middle[parts_.of(i)]; };
  parts_.sums(mass, 0.0, m);
  parts_.sums(middle, Vec3(Vec3::Zero()), [&](std::size_t i) -> Vec3 { return m(i) * s_.position_[i]; });
  parts_.sums(mean, Vec3(Vec3::Zero()), [&](std::size_t i) -> Vec3 { return m(i) * more[i]; });
  parts_.sums(squares, 0.0, [&](std::size_t i) { return m(i) * more[i].squaredNorm(); });
  for (std::size_t p = 0; p < mass.size(); ++p)
    if (mass[p] > 0) middle[p] /= mass[p], mean[p] /= mass[p];
  parts_.sums(spread, Mat3(Mat3::Zero()), [&](std::size_t i) -> Mat3 { return m(i) * arm(i) * arm(i).transpose(); });
  parts_.sums(slope, Mat3(Mat3::Zero()), [&](std::size_t i) -> Mat3 { return m(i) * more[i] * arm(i).transpose(); });
  std::vector<char> together(mass.size());
  for (std::size_t p = 0; p < mass.size(); ++p) {
    const Mat3 firm = spread[p] + 1e-9 * spread[p].trace() * Mat3::Identity();
    const double affine = spread[p].trace() > 0 ? (slope[p] * firm.inverse()).cwiseProduct(slope[p]).sum() : 0;
    together[p] = mass[p] * mean[p].squaredNorm() + affine > alike * squares[p];
  }
  parts_.each_node([&](std::size_t i) {
    if (together[parts_.of(i)]) u_[i] += more[i];
  });
}

// How much of the way back to where the step began Newton had better go before it begins: after an impact or a cut, or
// where it is pushed, a part does not go on as before. By a parabola through the potential here, its slope there, and
// the potential where the step began. That is asked only of parts for which forces say that it could have less there,
// by how far they pull and what inertia alone has against it. Parts with pieces that turn begin where these have gone
// round, if the potential is less there than at both ends.
void ImplicitStep::go_back(const std::vector<Vec3>& force, const std::vector<double>& value, std::vector<char>& moved) {
  constexpr double least = 0.2;  // less is not worth the evaluation
  std::vector<double> pull, inert, at_start, at_turned, share(parts_.count(), 0);
  std::vector<char> asked(parts_.count()), turns;
  const auto back = [&](std::size_t i) -> Vec3 { return state_.displacement[i] - u_[i]; };
  parts_.sums(pull, 0.0, [&](std::size_t i) { return back(i).dot(force[i]); });
  parts_.sums(inert, 0.0, [&](std::size_t i) { return 0.5 * s_.mass_[i] / (dt_ * dt_) * back(i).squaredNorm(); });
  for (std::size_t p = 0; p < asked.size(); ++p) asked[p] = pull[p] > inert[p];
  parts_.choose(asked);
  evaluate(state_.displacement, at_start, nullptr);
  const std::vector<Vec3> rigid = gone_round(turns);
  for (std::size_t p = 0; p < asked.size(); ++p) turns[p] = turns[p] && asked[p];
  if (!rigid.empty()) parts_.choose(turns), evaluate(rigid, at_turned, nullptr);
  for (std::size_t p = 0; p < asked.size(); ++p) {
    turns[p] = turns[p] && at_turned[p] < std::min(value[p], at_start[p]);
    if (!asked[p] || turns[p]) continue;
    const double bend = 2 * (at_start[p] - value[p] + pull[p]), best = bend > pull[p] ? pull[p] / bend : 1;
    if (best > least) share[p] = best > 1 - least ? 1 : best;
  }
  for (std::size_t p = 0; p < moved.size(); ++p) moved[p] = turns[p] || share[p] > 0;
  parts_.choose(moved);
  parts_.each_node([&](std::size_t i) {
    const auto p = parts_.of(i);
    u_[i] = turns[p]        ? rigid[i]
            : share[p] == 1 ? state_.displacement[i]
                            : Vec3((1 - share[p]) * u_[i] + share[p] * state_.displacement[i]);
  });
}

// u_, the potential there, the forces, and what elasticity has of these.
void ImplicitStep::start(std::vector<double>& value, std::vector<Vec3>& force, std::vector<Vec3>& elastic) {
  go_on();
  evaluate(u_, value, &force);
  add_forces(force, elastic);
  std::vector<char> moved(parts_.count());
  go_back(force, value, moved);
  if (std::find(moved.begin(), moved.end(), 1) == moved.end()) return;
  evaluate(u_, value, &force);
  add_forces(force, elastic);
}

}  // namespace geo
