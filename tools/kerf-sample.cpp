// kerf-sample: samples nodes inside a surface or volume.
#include <cmath>
#include <iostream>
#include <map>

#include <kerf/files.h>
#include <kerf/nodes.h>
#include <kerf/progress.h>
#include "model.h"
#include "tool.h"

namespace {

// The surface of a volume, checked like any other model.
geo::TriangleMesh read_checked_volume(const std::string& path, const geo::VolumeOptions& options) {
  geo::TriangleMesh mesh = geo::read_volume(path, options);
  try {
    geo::require_solid(mesh);
  } catch (const geo::InputError& e) {
    throw geo::InputError(path + ": the surface at this level is no solid: " + e.what() +
                          "; choose another --iso, --adaptivity 0 or smaller voxels");
  }
  return mesh;
}

std::string figures(const geo::NodeSet& nodes, const geo::SampleReport& report, double volume, double read_seconds) {
  std::map<double, std::size_t> levels;
  for (const double spacing : nodes.spacing) ++levels[spacing];
  std::string out = "{\"nodes\":" + std::to_string(nodes.size()) + ",\"volume\":" + tool::number(volume) +
                    ",\"spacing\":" + tool::number(report.spacing) +
                    ",\"finest\":" + tool::number(levels.begin()->first) +
                    ",\"coarsest\":" + tool::number(levels.rbegin()->first) + ",\"levels\":[";
  for (const auto& [spacing, count] : levels)
    out += (out.back() == '[' ? "" : ",") + std::string("{\"spacing\":") + tool::number(spacing) +
           ",\"nodes\":" + std::to_string(count) + "}";
  const auto [least, most] = std::minmax_element(nodes.radius.begin(), nodes.radius.end());
  const auto wall = [](double thickness, const geo::Vec3& at) {
    return thickness > 0 ? "{\"thickness\":" + tool::number(thickness) + ",\"at\":[" + tool::number(at.x()) + "," +
                               tool::number(at.y()) + "," + tool::number(at.z()) + "]}"
                         : "null";
  };
  return out + "],\"radius\":[" + tool::number(*least) + "," + tool::number(*most) +
         "],\"thinnest\":" + wall(report.thinnest, report.thinnest_at) +
         ",\"too_thin\":" + wall(report.unresolved, report.unresolved_at) +
         ",\"seconds\":{\"read\":" + tool::number(read_seconds) + ",\"octree\":" + tool::number(report.octree_seconds) +
         ",\"nodes\":" + tool::number(report.node_seconds) + ",\"support\":" + tool::number(report.support_seconds) +
         "}}";
}

}  // namespace

int main(int argc, char** argv) {
  tool::Tool t("kerf-sample", "Samples a solid into nodes, finer at the surface than in the depth.",
               R"(  kerf-sample bear.off --spacing 3% -o nodes.pcd
  kerf-sample bear.off -n 2000 | kerf-graph --surface bear.off -o bear.kerf
  kerf-sample cloud.vdb --grid density --iso 0.2 --levels 3 --surface cloud.ply -o nodes.pcd)");
  std::string model, spacing, pattern = "jitter", grid, iso, surface;
  int levels = 2, count = 0, across = 3;
  double jitter = 0.15, support = 1.8, adaptivity = 0;
  t.argument("MODEL", model,
             "Closed surface (PLY, OBJ, STL, OFF, glTF, FBX) or OpenVDB volume; - reads standard input");
  t.option("--spacing", spacing, "Spacing at the surface, in model units or as P% of the diagonal (3%)");
  t.option("--levels", levels, "Resolution levels, each twice as coarse as the one before");
  t.option("-n,--count", count, "Wanted number of nodes instead of a spacing");
  t.option("--min-across", across, "Nodes across thin material, which is sampled up to 32 times finer; 0: as the rest");
  t.choice("--pattern", pattern, {"jitter", "blue", "grid"},
           "Nodes displaced at random, pushed apart, or in the middle");
  t.option("--jitter", jitter, "Random displacement, as a fraction of a node's cell");
  t.option("--support", support, "Support radii over the spacing around; enlarged where they would hold too few nodes");
  t.option("--grid", grid, "Of a volume: the grid's name");
  t.option("--iso", iso, "Of a volume: the surface's level (0 of a level set, 0.5 of a fog volume)");
  t.option("--adaptivity", adaptivity, "Of a volume: 0 to 1, larger triangles where its surface is flat");
  t.output_option("--surface", surface, "Of a volume: also write its surface (PLY), for kerf-graph and kerf-crack");
  t.output("Nodes as PCD (or .ply)", {".pcd", ".ply"});
  return t.run(argc, argv, [&] {
    geo::SampleOptions options;
    options.levels = levels;
    options.jitter = jitter;
    options.seed = t.seed;
    options.across = across;
    options.support = support;
    if (levels < 1 || levels > 10) throw tool::UsageError("--levels must be from 1 to 10");
    if (count < 0 || (count > 0 && !spacing.empty()))
      throw tool::UsageError("give a positive --count or a --spacing, not both");
    if (!(jitter >= 0 && jitter <= 0.4)) throw tool::UsageError("--jitter must be from 0 to 0.4");
    if (!(support >= 1 && support <= 10)) throw tool::UsageError("--support must be from 1 to 10");
    if (across < 0 || across > 100) throw tool::UsageError("--min-across must be from 0 to 100");
    if (pattern == "blue")
      options.pattern = geo::NodePattern::blue;
    else if (pattern == "grid")
      options.pattern = geo::NodePattern::grid;
    double percent = 0;
    const auto parse = [](const std::string& name, const std::string& text, std::size_t& used) {
      double value = 0;
      used = 0;
      try {
        value = std::stod(text, &used);
      } catch (const std::exception&) {
      }
      if (used == 0 || !std::isfinite(value)) throw tool::UsageError(name + " '" + text + "' is not a number");
      return value;
    };
    std::size_t used = 0;
    if (!spacing.empty()) {
      const double value = parse("--spacing", spacing, used);
      if (!(value > 0) || (used != spacing.size() && spacing.substr(used) != "%"))
        throw tool::UsageError("--spacing '" + spacing + "' is not a positive number or percentage");
      (used == spacing.size() ? options.spacing : percent) = value;
    }
    options.count = static_cast<std::size_t>(count);
    geo::VolumeOptions volume{grid, {}, adaptivity};
    if (!iso.empty()) volume.iso = parse("--iso", iso, used);
    if (!iso.empty() && used != iso.size()) throw tool::UsageError("--iso '" + iso + "' is not a number");
    if (!(adaptivity >= 0 && adaptivity <= 1)) throw tool::UsageError("--adaptivity must be from 0 to 1");
    const bool is_volume = model.ends_with(".vdb");
    if (!is_volume && !(grid.empty() && iso.empty() && surface.empty() && adaptivity == 0))
      throw tool::UsageError("--grid, --iso, --adaptivity and --surface are for volumes (.vdb)");
    const std::string target = t.target(true);
    geo::Stopwatch clock;
    geo::TriangleMesh mesh = is_volume ? read_checked_volume(model, volume) : tool::read_solid(model).mesh;
    const double read_seconds = clock.lap();
    if (percent > 0) options.spacing = percent / 100 * geo::bounding_box(mesh).diagonal();
    tool::require_whole(mesh, model, "sample the model before it is cut");
    geo::NodeSet nodes;
    geo::SampleReport report;
    try {
      nodes = geo::sample_nodes(mesh, options, t.progress(), &report);
    } catch (const geo::InputError& e) {
      throw geo::InputError(model + ": " + e.what());
    }
    if (!surface.empty())
      geo::write_all(surface, [&](std::ostream& out) { geo::write_ply(out, mesh, {}, "kerf-sample " + model); });
    geo::write_all(target, [&](std::ostream& out) {
      target.ends_with(".ply") ? geo::write_nodes_ply(out, nodes) : geo::write_pcd(out, nodes);
    });
    if (report.unresolved > 0)
      t.say("kerf-sample: the material is only " + tool::rounded(report.unresolved) + " thick at (" +
            tool::rounded(report.unresolved_at) + "), with fewer than " + std::to_string(across) + " nodes across; " +
            (count > 0 ? "ask for more nodes" : "choose a smaller --spacing") + ", or --min-across 0 if that is meant");
    if (t.verbose) t.say("kerf-sample: " + std::to_string(nodes.size()) + " nodes");
    if (t.json)
      (target == "-" ? std::cerr : std::cout) << figures(nodes, report, geo::signed_volume(mesh), read_seconds) << '\n';
  });
}
