// Self-contact of a sliced block that sags: the cost of implicit steps by number of triangles. Then
// the parts of contact on a folded sheet.
#include <cmath>

#include "bench.h"
#include "body/crack_transaction.h"
#include "contact/self_contact.h"
#include "contact_peers.h"
#include "kerf/contact.h"
#include "kerf/mesh.h"
#include "kerf/nodes.h"
#include "kerf/parallel.h"

namespace bench {

int contact(const Options& options) {
  geo::set_threads(1);
  contact_of_sheet(options);
  const geo::Vec3 size(2, 1, 1.2);
  for (const std::size_t count : options.nodes) {
    const double spacing = std::cbrt(size.prod() / double(count));
    const geo::TriangleMesh mesh =
        geo::make_block(size, 0.62 * spacing);  // about six triangles a node, as a block of Jell-O has
    geo::SampleOptions sampling;
    sampling.spacing = spacing;
    geo::Body body = geo::build_body(geo::Complex::from_skin(mesh), geo::sample_nodes(mesh, sampling),
                                     {26, geo::NeighborMethod::automatic});
    geo::Material material;
    material.young = 2e4;
    material.damping = 1;
    geo::Solid solid(body.nodes, body.graph, material);
    geo::State state{std::vector<geo::Vec3>(solid.size(), geo::Vec3::Zero()),
                     std::vector<geo::Vec3>(solid.size(), geo::Vec3::Zero())};
    geo::SelfContact surface(body, solid);
    geo::Environment environment;
    double following = 0;
    for (int blade = 0; blade < 3; ++blade) {
      const auto edge = [&](double z) {
        std::vector<geo::Vec3> points;
        for (int i = 0; i <= 12; ++i)
          points.push_back(
              {0.52 + 0.48 * blade + 0.3 * (z - 0.6) + 0.02 * std::sin(7 * z + i), -0.2 + 1.4 * i / 12, z});
        return points;
      };
      geo::FrontState front = geo::begin_front(edge(1.3), false, blade + 1);
      for (int step = 1; step <= 8; ++step) {
        std::optional<geo::EmbeddingPlan> plan;
        const std::vector<geo::Vec3> next = edge(1.3 - 0.14 * step);
        geo::CrackTransaction transaction(body, geo::advance_of(front, next, {}), nullptr);
        const geo::BodyDelta delta = transaction.commit([&](const geo::Complex& grown, const geo::CrackDelta& crack) {
          plan = surface.plan_embedding(body, solid, state, grown, crack);
        });
        solid.update(body.nodes, body.graph, delta.first_new_node, delta.donors, delta.updated_nodes, state);
        const double start = cpu_seconds();
        if (plan) surface.commit(std::move(*plan), body, delta);
        surface.update_weights(body, solid, state.displacement);
        following += cpu_seconds() - start;
      }
    }
    environment.gravity = {4, 0, -9};
    environment.fixed.assign(solid.size(), 0);
    for (std::size_t i = 0; i < solid.size(); ++i) environment.fixed[i] = body.nodes.position[i].z() < 1.2 * spacing;
    double moving = 0, touching = 0, worst = 0;
    geo::ContactStats work;
    constexpr int steps = 24;
    for (int step = 0; step < steps; ++step) {
      double start = cpu_seconds();
      environment.contact.clear();
      geo::ContactStep contact = surface.begin_step(body, solid, state, 1.0 / 24, environment);
      if (geo::Potential* potential = contact.potential()) environment.contact.push_back(potential);
      double one = cpu_seconds() - start;
      start = cpu_seconds();
      solid.step_implicit(state, 1.0 / 24, environment);
      moving += cpu_seconds() - start;
      start = cpu_seconds();
      work += surface.finish_step(std::move(contact), solid, state.displacement);
      one += cpu_seconds() - start;
      touching += one;
      worst = std::max(worst, one);
    }
    geo::TriangleMesh end;
    end.vertices = surface.positions();
    end.triangles = surface.surface().triangles;
    end.site = surface.surface().site;
    print({{"nodes", double(solid.size())},
           {"triangles", double(end.triangles.size())},
           {"nodes_ms_a_step", 1e3 * moving / steps},
           {"contact_ms_a_step", 1e3 * touching / steps},
           {"contact_ms_worst", 1e3 * worst},
           {"share", touching / (touching + moving)},
           {"follow_ms_a_cut_step", 1e3 * following / 24},
           {"watched_a_step", double(work.planes) / steps},
           {"touching_a_step", double(work.touching) / steps},
           {"in_zones_a_step", double(work.in_zones) / steps},
           {"opened", double(work.opened)},
           {"held", double(work.held)},
           {"lag_in_spacings", work.tracking_error / spacing},
           {"crossings", double(geo::count_crossings(end))}},
          options.json);
  }
  return 0;
}

}  // namespace bench
