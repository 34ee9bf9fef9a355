// Reports node files, fronts, scenes, and folders or frames of runs (declared in info/files.h).
#include <algorithm>
#include <filesystem>
#include <numeric>

#include <kerf/body_file.h>
#include <kerf/error.h>
#include <kerf/files.h>
#include <kerf/simulation.h>
#include "info/files.h"
#include "model.h"
#include "tool.h"

namespace info {
namespace {

namespace fs = std::filesystem;

// Names two nodes with the same position; empty where there are none.
std::string twins(const geo::NodeSet& nodes) {
  std::vector<std::uint32_t> order(nodes.size());
  std::iota(order.begin(), order.end(), 0u);
  const auto less = [&](std::uint32_t i, std::uint32_t j) {
    const auto &p = nodes.position[i], &q = nodes.position[j];
    return p == q ? i < j : std::lexicographical_compare(p.data(), p.data() + 3, q.data(), q.data() + 3);
  };
  std::sort(order.begin(), order.end(), less);
  for (std::size_t i = 1; i < order.size(); ++i)
    if (nodes.position[order[i - 1]] == nodes.position[order[i]])
      return "nodes " + std::to_string(order[i - 1]) + " and " + std::to_string(order[i]) +
             " are at one place; remove one of them";
  return {};
}

// Checks the topology of a frame only: in a deformed surface sheets are open, and triangles may
// touch, cross and have no area.
std::string check_frame(const std::string& path) {
  geo::TriangleMesh mesh = geo::read_surface(path).mesh;
  mesh.patch.clear();
  mesh.site.clear();
  const geo::SurfaceReport report = geo::check_surface(mesh, geo::SelfIntersections::ignore);
  if (report.closed && report.manifold && report.oriented) return {};
  return fs::path(path).filename().string() + ": " + report.first_problem;
}

}  // namespace

std::string report_nodes(const geo::NodeSet& nodes, const ReportOptions& options, Report& report) {
  const auto [lo, hi] = std::minmax_element(nodes.spacing.begin(), nodes.spacing.end());
  const double volume = std::accumulate(nodes.volume.begin(), nodes.volume.end(), 0.0);
  report.headline = counted(nodes.size(), "node") + ", " + rounded(*lo) + " to " + rounded(*hi) + " apart; volume " +
                    rounded(volume) + ".";
  report.add_text("kind", "nodes");
  report.add("nodes", nodes.size());
  report.add_number("spacing_min", *lo);
  report.add_number("spacing_max", *hi);
  report.add_number("volume", volume);
  if (options.histograms) {
    report.add_histogram("radii", nodes.radius);
    report.add_histogram("spacings", nodes.spacing);
  }
  return options.check ? twins(nodes) : std::string();
}

void report_fronts(const std::vector<geo::Front>& fronts, const ReportOptions& options, Report& report) {
  std::size_t steps = 0, points = 0, sheets = 0, triangles = 0;
  std::vector<double> moves;
  for (const auto& f : fronts) {
    sheets += f.is_sheet();
    triangles += f.triangles.size();
    if (!f.is_sheet()) steps += f.steps.size();
    for (std::size_t s = 0; s < f.steps.size(); ++s) {
      points += f.steps[s].size();
      if (s == 0) continue;
      const auto next = geo::resample_front(f.steps[s - 1], f.steps[s], f.closed);
      double longest = 0;
      for (std::size_t i = 0; i < next.size(); ++i) longest = std::max(longest, (next[i] - f.steps[s - 1][i]).norm());
      moves.push_back(longest);
    }
  }
  const std::string swept = counted(fronts.size() - sheets, "front") + " of " + counted(steps, "time step"),
                    whole = counted(sheets, "sheet") + " of " + counted(triangles, "triangle");
  report.headline = (sheets == 0               ? swept
                     : sheets == fronts.size() ? whole
                                               : swept + ", " + whole) +
                    "; " + counted(points, "point") +
                    (moves.empty() ? "."
                                   : "; the longest move of a point in a step is " +
                                         rounded(*std::max_element(moves.begin(), moves.end())) + ".");
  report.add_text("kind", "fronts");
  report.add("fronts", fronts.size() - sheets);
  report.add("sheets", sheets);
  report.add("steps", steps);
  report.add("triangles", triangles);
  report.add("points", points);
  std::vector<std::string> names;
  for (const auto& f : fronts) names.push_back(tool::quoted(f.name));
  report.add("names", list(names));
  if (options.histograms) report.add_histogram("moves", moves);
}

std::string report_scene(const std::string& path, const ReportOptions& options, Report& report) {
  const geo::Scene scene = geo::read_scene(path);
  std::vector<std::string> meshes, blades;
  for (const auto& body : scene.bodies) meshes.push_back(tool::quoted(body.mesh));
  for (const auto& blade : scene.blades) blades.push_back(tool::quoted(blade.name));
  report.headline = "A scene: " + counted(scene.bodies.size(), "body", "bodies") + " and " +
                    counted(scene.blades.size(), "blade") + (scene.ground ? " over a ground" : "") + ", " +
                    counted(static_cast<std::size_t>(scene.frames), "frame") + " at " + rounded(scene.frame_rate) +
                    " a second.";
  report.add_text("kind", "scene");
  report.add("bodies", scene.bodies.size());
  report.add("meshes", list(meshes));
  report.add("blades", list(blades));
  report.add("scores", scene.scores.size());
  report.add("grips", scene.grips.size());
  report.add("ground", scene.ground);
  report.add("obstacles", scene.obstacles.size());
  report.add("frames", static_cast<std::size_t>(scene.frames));
  report.add_number("frame_rate", scene.frame_rate);
  report.add_number("step", scene.dt);
  report.add_text("integrator", scene.integrator());
  if (options.check) try {
      std::vector<geo::TriangleMesh> meshes;
      for (const auto& body : scene.bodies) {
        meshes.push_back(tool::read_solid(body.mesh).mesh);
        tool::require_whole(meshes.back(), body.mesh, "a scene begins with whole models");
      }
      geo::place_models(scene, std::move(meshes));
    } catch (const geo::MissingInputError&) {
      throw;
    } catch (const geo::InputError& e) {
      return e.what();
    }
  return {};
}

std::string report_run(const std::string& folder, const ReportOptions& options, Report& report) {
  const fs::path top(folder), inner = fs::is_directory(top / "frames") ? top / "frames" : top,
                              checkpoint = top / "checkpoint.kerf";
  std::vector<std::string> frames;
  for (const auto& entry : fs::directory_iterator(inner))
    if (entry.path().extension() == ".ply") frames.push_back(entry.path().string());
  std::sort(frames.begin(), frames.end());
  const bool resumable = fs::exists(checkpoint);
  if (frames.empty() && !resumable)
    throw geo::InputError(folder + ": is no folder of a run: it has neither frames nor a checkpoint");
  report.headline = "A run: " + counted(frames.size(), "frame") +
                    (resumable ? ", and a checkpoint to go on from" : ", no checkpoint") + ".";
  report.add_text("kind", "run");
  report.add("frames", frames.size());
  report.add("checkpoint", resumable);
  if (!frames.empty()) {
    const auto last = geo::read_surface(frames.back()).mesh;
    report.add("vertices", last.vertices.size());
    report.add("faces", last.triangles.size());
  }
  std::string problem;
  if (options.check)
    for (std::size_t i = 0; i < frames.size() && problem.empty(); ++i) problem = check_frame(frames[i]);
  if (resumable) {
    geo::Input input(checkpoint.string());
    const auto bytes = input.size();
    const geo::KerfFile file(std::move(input));
    Report inside;
    const std::string found = report_body(file, geo::read_body(file), bytes, options, inside);
    if (problem.empty() && !found.empty()) problem = "checkpoint.kerf: " + found;
    report.headline += " " + inside.headline;
    report.add_report("body", inside);
  }
  return problem;
}

}  // namespace info
