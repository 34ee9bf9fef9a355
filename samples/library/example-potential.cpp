// An energy of one's own in the implicit step: springs that pull some nodes of a block to the side.
#include <cstdio>
#include <vector>

#include <kerf/body.h>
#include <kerf/mesh.h>
#include <kerf/potential.h>
#include <kerf/solid.h>

namespace {

class Springs : public geo::Potential {
 public:
  Springs(const geo::Vec3& way, double stiffness) : way_(way), stiffness_(stiffness) {}
  void add(std::uint32_t node) { nodes_.push_back({.node = node, .weight = 1}); }

  std::size_t size() const override { return nodes_.size(); }
  geo::Stencil stencil(std::size_t k) const override { return {&nodes_[k], 1}; }
  double energy(std::size_t, const geo::Vec3& d) const override { return 0.5 * stiffness_ * (d - way_).squaredNorm(); }
  Derivatives derivatives(std::size_t, const geo::Vec3& d) const override {
    return {.force = stiffness_ * (way_ - d), .hessian = stiffness_ * geo::Mat3::Identity()};
  }
  double stiffness_bound(std::size_t) const override { return stiffness_; }

 private:
  geo::Vec3 way_;  // to which each spring pulls the displacement of its node, m
  double stiffness_;
  std::vector<geo::NodeWeight> nodes_;
};

}  // namespace

int main() {
  const geo::TriangleMesh block = geo::make_block({1, 1, 2}, 0.5);
  const geo::Body body = geo::build_body(geo::Complex::from_skin(block), geo::sample_nodes(block, {.count = 200}));
  geo::Solid solid(body, geo::Material{.young = 1e4, .damping = 4});
  const std::size_t n = body.nodes.size();
  geo::State state{std::vector<geo::Vec3>(n, geo::Vec3::Zero()), std::vector<geo::Vec3>(n, geo::Vec3::Zero())};

  Springs springs({0.3, 0, 0}, 100);
  geo::Environment environment;
  environment.gravity = geo::Vec3::Zero();
  for (std::uint32_t i = 0; i < n; ++i) {
    environment.fixed.push_back(body.nodes.position[i].z() < 0.3);
    if (body.nodes.position[i].z() > 1.7) springs.add(i);
  }
  environment.contact = {&springs};
  for (int step = 0; step < 60; ++step) solid.step_implicit(state, 1.0 / 24, environment);

  double top = 0;
  for (std::size_t i = 0; i < n; ++i)
    if (body.nodes.position[i].z() > 1.7) top += state.displacement[i].x() / double(springs.size());
  std::printf("%zu springs move the top by %.3f m\n", springs.size(), top);
  return top > 0.05 && top < 0.3 ? 0 : 1;
}
