// The halved pumpkin of samples/scenes/halve.toml with more and more nodes: cost by phase, and how
// smooth the cut is.
#include <sys/resource.h>

#include <cmath>
#include <cstdio>

#include "bench.h"
#include "kerf/files.h"
#include "kerf/mesh.h"
#include "kerf/parallel.h"
#include "kerf/progress.h"
#include "kerf/simulation.h"

namespace bench {
namespace {

constexpr int frames = 16;  // the blade has gone through

// "2k", "128k", "1m".
std::string short_name(std::size_t count) {
  return count % 1000000 == 0 ? std::to_string(count / 1000000) + "m" : std::to_string(count / 1000) + "k";
}

// Peak memory of the process, bytes.
double peak_memory() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return 1024 * double(usage.ru_maxrss);
}

}  // namespace

int simulation(const Options& options) {
  geo::set_threads(2);
  Figures figures;
  if (options.scenes) simulation_scenes(options.json, figures);
  double first_mechanics = 0, first_contact = 0, first_processor = 0, first_nodes = 0;
  for (const std::size_t nodes : options.nodes) {
    const geo::Scene scene = geo::read_scene(KERF_HALVE_SCENE, {{"body.nodes", std::to_string(nodes)}});
    // 9,680 triangles at 2,000 nodes, and as many for a node of the surface with more.
    const int frequency = static_cast<int>(std::lround(22 * std::cbrt(double(nodes) / 2000)));
    geo::Simulation run(scene, geo::make_pumpkin(frequency));
    geo::FrameStats total;
    geo::Stopwatch watch;
    const double begin = cpu_seconds();
    for (int f = 0; f < frames; ++f) {
      const geo::FrameStats frame = run.advance_frame();
      total += frame;
      if (!options.json)
        std::fprintf(stderr, "%zu nodes, frame %2d: mechanics %.2f s, contact %.2f s, CG %zu, Newton %zu\n", nodes,
                     f + 1, frame.mechanics_seconds, frame.contact_seconds, frame.cg, frame.newton);
    }
    const double seconds = watch.lap(), processor = cpu_seconds() - begin;
    const std::string name = "_" + short_name(nodes);
    figures["seconds_per_frame" + name] = seconds / frames;
    figures["processor_seconds_per_frame" + name] = processor / frames;
    figures["mechanics_seconds" + name] = total.mechanics_seconds;
    figures["contact_seconds" + name] = total.contact_seconds;
    figures["contact_share" + name] = total.contact_seconds / seconds;
    figures["cg_per_newton" + name] = double(total.cg) / double(total.newton);
    figures["newton_per_step" + name] = double(total.newton) / double(total.steps);
    figures["in_zones" + name] = double(total.contact.in_zones);
    figures["sheet_deviation" + name] = total.sheet.deviation;
    figures["sheet_turning" + name] = total.sheet.turning;
    figures["crumbs" + name] = double(total.sheet.crumbs);
    figures["refused" + name] = double(total.refused);
    figures["bytes_per_node"] = peak_memory() / double(nodes);  // of the last size
    if (nodes == 1000000) figures["nodes_1m_seconds_per_frame"] = seconds / frames;
    if (nodes < 8000) continue;
    if (first_nodes == 0) {
      first_nodes = double(nodes);
      first_mechanics = total.mechanics_seconds;
      first_contact = total.contact_seconds;
      first_processor = processor;
      continue;
    }
    if (nodes > 512000) continue;  // the exponents are those from 8,000 nodes to 512,000
    figures["processor_exponent"] = growth(first_processor, processor, first_nodes, double(nodes));
    figures["mechanics_exponent"] = growth(first_mechanics, total.mechanics_seconds, first_nodes, double(nodes));
    figures["contact_exponent"] = growth(first_contact, total.contact_seconds, first_nodes, double(nodes));
  }
  print(figures, options.json);
  return 0;
}

}  // namespace bench
