#include "mechanics.h"

#include <cstdio>

#include "bench.h"
#include "kerf/parallel.h"
#include "kerf/solid.h"
#include "mechanics/bodies.h"

namespace bench {
namespace {

using namespace geo;

struct Run {
  Bent bent;
  std::size_t points = 0;
  double newton = 0, cg = 0, substeps = 0;  // a frame
};

State at_rest(std::size_t n) { return {std::vector<Vec3>(n, Vec3::Zero()), std::vector<Vec3>(n, Vec3::Zero())}; }

Environment held(const Body& body, const Beam& beam) {
  Environment env;
  env.gravity = {0, 0, -beam.gravity};
  for (const Vec3& x : body.nodes.position) env.fixed.push_back(x.x() < 1.0 / beam.across);
  return env;
}

Material material(const Beam& beam) {
  Material m;
  m.young = beam.young;
  m.poisson = beam.poisson;
  m.density = beam.density;
  m.damping = 0;
  return m;
}

Run bend(const Body& body, Solid& solid, const Beam& beam) {
  const Environment env = held(body, beam);
  State state = at_rest(body.nodes.size());
  Run run;
  run.bent.nodes = body.nodes.size();
  run.points = solid.point_count();
  const double start = cpu_seconds();
  for (int f = 0; f < beam.frames; ++f) {
    const StepReport r = solid.step_implicit(state, beam.dt, env);
    run.newton += double(r.newton) / beam.frames;
    run.cg += double(r.cg) / beam.frames;
    run.substeps += double(r.substeps) / beam.frames;
  }
  run.bent.seconds = cpu_seconds() - start;
  double tips = 0;
  for (std::size_t i = 0; i < body.nodes.size(); ++i)
    if (body.nodes.position[i].x() > 4 - 1.0 / beam.across) {
      run.bent.tip += state.displacement[i].z();
      tips += 1;
    }
  run.bent.tip /= tips;
  return run;
}

}  // namespace

int mechanics(const Options& options) {
  for (const std::size_t nodes : options.nodes) {
    Beam beam;
    beam.across = std::max(2, int(std::cbrt(double(nodes) / 4) + 0.5));
    const double spacing = 1.03 / beam.across;
    const Body body = block_body({4, 1, 1}, spacing, 0.5);
    set_threads(1);
    double built = cpu_seconds();
    Solid solid(body, material(beam));
    built = cpu_seconds() - built;
    const Run ours = bend(body, solid, beam);
    const Bent theirs = bend_with_bullet(beam);
    set_threads(0);
    Beam few = beam;
    few.frames = 5;
    const double speedup = threads_speedup([&] { bend(body, solid, few); });
    set_threads(0);
    const auto rate = [&](const Bent& b) { return double(b.nodes) * beam.frames / b.seconds; };
    Figures f;
    f["nodes"] = double(ours.bent.nodes);
    f["points"] = double(ours.points);
    f["build_seconds"] = built;
    f["frame_ms"] = 1e3 * ours.bent.seconds / beam.frames;
    f["newton"] = ours.newton;
    f["cg"] = ours.cg;
    f["substeps"] = ours.substeps;
    f["node_steps_per_second"] = rate(ours.bent);
    f["tip"] = ours.bent.tip;
    f["two_threads"] = speedup;
    f["bullet_nodes"] = double(theirs.nodes);
    f["bullet_frame_ms"] = 1e3 * theirs.seconds / beam.frames;
    f["bullet_node_steps_per_second"] = rate(theirs);
    f["bullet_tip"] = theirs.tip;
    f["ratio"] = rate(ours.bent) / rate(theirs);
    print(f, options.json);
  }
  return 0;
}

}  // namespace bench
