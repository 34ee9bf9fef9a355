// Reports a body or checkpoint: sizes, histograms, and the invariants of check_body() (declared in
// info/files.h).
#include <algorithm>
#include <cmath>
#include <numeric>

#include <kerf/body_file.h>
#include <kerf/check.h>
#include <kerf/pieces.h>
#include "info/files.h"
#include "tool.h"

namespace info {
namespace {

std::vector<double> edge_lengths(const geo::Body& body) {
  std::vector<double> lengths;
  for (std::uint32_t i = 0; i < body.nodes.size(); ++i)
    for (const geo::NodeId j : body.graph.edges(geo::NodeId(i)))
      if (j.value > i) lengths.push_back((body.nodes.position[i] - body.nodes.position[j.index()]).norm());
  return lengths;
}

void report_motion(const geo::Checkpoint& checkpoint, Report& report) {
  double displacement = 0, speed = 0;
  for (const auto& u : checkpoint.state.motion.displacement) displacement = std::max(displacement, u.norm());
  for (const auto& v : checkpoint.state.motion.velocity) speed = std::max(speed, v.norm());
  report.headline += " The checkpoint of a run at frame " + std::to_string(checkpoint.state.frame) + ", " +
                     rounded(checkpoint.state.time) + " s.";
  report.add("frame", static_cast<std::size_t>(checkpoint.state.frame));
  report.add_number("time", checkpoint.state.time);
  const auto& bonds = checkpoint.state.glued.bonds;
  if (!bonds.empty()) {
    const auto broken = std::count_if(bonds.begin(), bonds.end(), [](const geo::GluedBond& b) { return b.broken; });
    report.add("bonds", bonds.size());
    report.add("bonds_broken", static_cast<std::size_t>(broken));
  }
  report.add_number("displacement_max", displacement);
  report.add_number("speed_max", speed);
}

}  // namespace

std::string report_body(const geo::KerfFile& file, const geo::Body& body, std::size_t bytes,
                        const ReportOptions& options, Report& report) {
  geo::BodyReport result;
  std::string problem;
  std::vector<std::uint32_t> component;
  if (options.check) {
    result = geo::check_body(body);
    problem = result.first_problem;
    if (problem.empty()) problem = geo::check_complex(body.surface, geo::SelfIntersections::find).first_problem;
  } else {
    result.graph_components = body.graph.components(component);
    result.pieces = geo::find_pieces(body.surface).count;
    for (std::uint32_t v = 0; v < body.surface.surface_vertex_count(); ++v)
      result.orphans += body.surface.alive(geo::SurfaceVertexId(v)) && !body.binding.master[v].valid();
  }
  std::size_t vertices = 0;
  std::vector<double> neighbors;
  for (std::size_t i = 0; i < body.nodes.size(); ++i)
    neighbors.push_back(double(body.graph.neighbor_count(geo::NodeId(i))));
  for (std::uint32_t v = 0; v < body.surface.surface_vertex_count(); ++v)
    vertices += body.surface.alive(geo::SurfaceVertexId(v));
  const auto [least, most] = std::minmax_element(neighbors.begin(), neighbors.end());
  const double sum = std::accumulate(neighbors.begin(), neighbors.end(), 0.0),
               volume = std::accumulate(body.nodes.volume.begin(), body.nodes.volume.end(), 0.0);
  const auto debris = static_cast<std::size_t>(std::count(body.debris.begin(), body.debris.end(), 1));
  report.headline =
      "A body of " + counted(result.pieces, "piece") + ": " + counted(body.nodes.size(), "node") + " and " +
      counted(body.graph.edge_count(), "visibility edge") + ", " +
      (body.surface.crack_count() > 0 ? counted(static_cast<std::size_t>(body.surface.crack_count()), "crack")
                                      : "no crack") +
      ", " + counted(body.crack_steps, "crack step") + "; volume " + rounded(volume) + "." +
      (debris > 0 ? " " + counted(debris, "node is", "nodes are") + " debris." : "");
  report.add_text("kind", "body");
  report.add("nodes", body.nodes.size());
  report.add("edges", body.graph.edge_count());
  if (body.graph.guide_count() > 0) report.add("guides", body.graph.guide_count());
  report.add("graph_components", result.graph_components);
  report.add("pieces", result.pieces);
  report.add("edges_crossing", options.check ? std::to_string(result.edges_crossing) : "null");
  report.add_number("neighbors_min", neighbors.empty() ? 0 : *least);
  report.add_number("neighbors_mean", neighbors.empty() ? 0 : std::round(100 * sum / double(neighbors.size())) / 100);
  report.add_number("neighbors_max", neighbors.empty() ? 0 : *most);
  report.add("vertices", vertices);
  report.add("orphans", result.orphans);
  report.add("bytes", bytes);
  report.add("updates", static_cast<std::size_t>(body.crack_steps));
  report.add("debris", debris);
  report.add_number("volume", volume);
  report.add("appended", static_cast<std::size_t>(file.updates()));
  std::vector<std::string> history;
  for (const auto& h : body.history) history.push_back(tool::quoted(h.tool + " " + h.version));
  report.add("history", list(history));
  if (file.sections().count("run/displacement") > 0) report_motion(geo::read_checkpoint(file), report);
  if (options.histograms) {
    report.add_histogram("radii", body.nodes.radius);
    report.add_histogram("edge_lengths", edge_lengths(body));
    report.add_histogram("neighbors", neighbors);
  }
  return problem;
}

}  // namespace info
