// How motion is carried over a cut: to new and moved nodes, with the momentum of every part.
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <utility>

#include "kerf/parallel.h"
#include "kerf/solid.h"

namespace geo {
namespace {

// Mass, momenta about the origin and inertia of a connected part.
struct PartMotion {
  double mass = 0;
  Vec3 middle = Vec3::Zero(), linear = Vec3::Zero(), angular = Vec3::Zero();  // middle: times mass
  Mat3 inertia = Mat3::Zero();                                                // about the origin
  void add(double m, const Vec3& x, const Vec3& v) {
    mass += m, middle += m * x, linear += m * v, angular += m * x.cross(v);
    inertia += m * (x.squaredNorm() * Mat3::Identity() - x * x.transpose());
  }
};

struct RigidMotion {
  Vec3 middle, velocity, spin;
};

// The rigid motion that brings a part's momenta from `now` to what they were: the linear one, and
// the angular one about its centre of mass. (About a fixed point it may change, for mass is shared
// out anew: were that made good, a part that only travels would begin to turn.) A part on a line or
// point has no inertia about it, and can have no such momentum.
RigidMotion correction(const PartMotion& was, const PartMotion& now) {
  const Vec3 c = now.middle / now.mass, linear = was.linear - now.linear;
  const Vec3 turning = was.angular - (was.middle / was.mass).cross(was.linear) - now.angular + c.cross(now.linear);
  const Mat3 inertia = now.inertia - now.mass * (c.squaredNorm() * Mat3::Identity() - c * c.transpose());
  const Eigen::SelfAdjointEigenSolver<Mat3> eigen(inertia);
  const Vec3 spin = eigen.eigenvectors().transpose() * turning;
  Vec3 turned = Vec3::Zero();
  for (int k = 0; k < 3; ++k)
    if (eigen.eigenvalues()[k] > 1e-9 * eigen.eigenvalues()[2]) turned[k] = spin[k] / eigen.eigenvalues()[k];
  return {c, linear / now.mass, eigen.eigenvectors() * turned};
}

}  // namespace

// Where nothing came off: new nodes are of the part of those that they see. The lowest node of each
// part decides its number, so all stay.
void Solid::number_parts(const VisibilityGraph& graph, std::size_t first_new) {
  for (std::size_t i = first_new; i < graph.node_count(); ++i) {
    std::uint32_t part = ~0u;
    for (const NodeId j : graph.edges(NodeId(i)))
      if (j.index() < part_.size()) part = part_[j.index()];
    if (part == ~0u) {  // it sees newer ones only
      parts_ = graph.components(part_);
      return;
    }
    part_.push_back(part);
  }
}

void Solid::follow_nodes(const NodeSet& nodes, const VisibilityGraph& graph, NodeId first_new,
                         std::span<const NodeId> donors, std::span<const NodeId> updated, State& state, bool parted) {
  const std::size_t n = nodes.size(), old = first_new.index();
  const bool moving = !state.displacement.empty();
  // Where the mass of those was that change, and how it moved: a new node's at its donor.
  struct Was {
    std::uint32_t node;
    Vec3 place, velocity;
  };
  std::vector<Was> changed;
  if (moving) {
    for (std::size_t i = old; i < n; ++i) {
      std::size_t d = donors[i - old].index();
      while (d >= old) d = donors[d - old].index();
      changed.push_back({static_cast<std::uint32_t>(i), position_[d] + state.displacement[d], state.velocity[d]});
      const Vec3 away = nodes.position[i] - position_[d];
      const std::vector<Vec3>&u = state.displacement, &v = state.velocity;
      const Vec3 displaced = u[d] + rows_.gradient(d, u) * away, moved = v[d] + rows_.gradient(d, v) * away;
      state.displacement.push_back(displaced), state.velocity.push_back(moved);
      if (!state.acceleration.empty()) state.acceleration.push_back(Vec3(state.acceleration[d]));
    }
    // A moved node keeps its place in the deformed field.
    for (const NodeId i : updated)
      if (i.index() < old && position_[i.index()] != nodes.position[i.index()]) {
        changed.push_back({i.value, position_[i.index()] + state.displacement[i.index()], state.velocity[i.index()]});
        state.displacement[i.index()] +=
            rows_.gradient(i.index(), state.displacement) * (nodes.position[i.index()] - position_[i.index()]);
      }
  }
  volume_ = nodes.volume, spacing_ = nodes.spacing, position_ = nodes.position;
  mass_.resize(n);
  for (std::size_t i = old; i < n; ++i) materials_.add_node(donors[i - old].index());
  for (std::size_t i = 0; i < n; ++i) mass_[i] = materials_.of(i).density * volume_[i];
  parallel_invoke([&] { rows_.update(nodes, graph, updated); },
                  [&] {
                    if (parted || part_.size() != old)
                      parts_ = graph.components(part_);
                    else
                      number_parts(graph, old);
                  });
  if (changed.empty()) return;
  std::vector<char> concerned(parts_, 0);
  for (const Was& w : changed) concerned[part_[w.node]] = 1;
  std::sort(changed.begin(), changed.end(), [](const Was& a, const Was& b) { return a.node < b.node; });
  std::vector<PartMotion> was(parts_), now(parts_);
  std::vector<char> differs(parts_, 0);  // up to a part's first node that changes, both sums are one
  auto next = changed.begin();
  for (std::size_t i = 0; i < n; ++i) {
    const auto p = part_[i];
    if (!concerned[p]) continue;
    const bool changes = next != changed.end() && next->node == i;
    if (changes && !std::exchange(differs[p], 1)) was[p] = now[p];
    const Vec3 place = position_[i] + state.displacement[i];
    now[p].add(mass_[i], place, state.velocity[i]);
    if (changes)
      was[p].add(mass_[i], next->place, next->velocity), ++next;
    else if (differs[p])
      was[p].add(mass_[i], place, state.velocity[i]);
  }
  std::vector<RigidMotion> by(parts_);
  for (std::uint32_t p = 0; p < parts_; ++p)
    if (concerned[p]) by[p] = correction(was[p], now[p]);
  for (std::size_t i = 0; i < n; ++i)
    if (const auto p = part_[i]; concerned[p])
      state.velocity[i] += by[p].velocity + by[p].spin.cross(position_[i] + state.displacement[i] - by[p].middle);
}

}  // namespace geo
