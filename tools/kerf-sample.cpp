// kerf-sample: adaptive nodes inside a surface or volume.
#include "io/node_file.h"
#include "io/stream.h"
#include "io/volume_file.h"
#include "model.h"
#include "sampling/sample.h"
#include "tool.h"

int main(int argc, char** argv) {
  tool::Tool t("kerf-sample", "Samples a solid into nodes, finer at the surface than in the depth.",
               "  kerf-sample bear.off --spacing 3% -o nodes.pcd\n  kerf-sample bear.off -n 2000 | kerf-graph --surface bear.off -o bear.kerf\n  kerf-sample cloud.vdb --spacing 0.1 --levels 3 -o nodes.pcd");
  std::string model, spacing;
  int levels = 2, count = 0;
  double jitter = 0.15;
  t.argument("MODEL", model, "Closed surface (PLY, OBJ, STL, OFF) or OpenVDB volume; - reads standard input");
  t.option("--spacing", spacing, "Finest spacing, in model units or as P% of the diagonal (3%)");
  t.option("--levels", levels, "Resolution levels");
  t.option("-n,--count", count, "Wanted number of nodes instead of a spacing");
  t.option("--jitter", jitter, "Random displacement, as a fraction of a node's cell");
  t.output("Nodes as PCD (or .ply)");
  return t.run(argc, argv, [&] {
    geo::SampleOptions options;
    options.levels = levels, options.jitter = jitter, options.seed = t.seed;
    if (levels < 1 || levels > 10) throw tool::UsageError("--levels must be from 1 to 10");
    if (count < 0 || (count > 0 && !spacing.empty())) throw tool::UsageError("give a positive --count or a --spacing, not both");
    if (!(jitter >= 0 && jitter <= 0.4)) throw tool::UsageError("--jitter must be from 0 to 0.4");
    double percent = 0;
    if (!spacing.empty()) {
      std::size_t used = 0;
      double value = 0;
      try {
        value = std::stod(spacing, &used);
      } catch (const std::exception&) {
      }
      if (!(value > 0) || (used != spacing.size() && spacing.substr(used) != "%")) throw tool::UsageError("--spacing '" + spacing + "' is not a positive number or percentage");
      (used == spacing.size() ? options.spacing : percent) = value;
    }
    options.count = static_cast<std::size_t>(count);
    const std::string target = t.target(true);
    geo::TriangleMesh mesh = model.ends_with(".vdb") ? geo::read_volume(model) : tool::read_solid(model).mesh;
    if (percent > 0) options.spacing = percent / 100 * geo::bounding_box(mesh).diagonal();
    if (mesh.two_sided()) throw geo::InputError(model + ": is cut already; sample the model before it is cut");
    geo::NodeSet nodes;
    try {
      nodes = geo::sample_nodes(mesh, options, t.progress());
    } catch (const geo::InputError& e) {
      throw geo::InputError(model + ": " + e.what());
    }
    geo::write_all(target, [&](std::ostream& out) { target.ends_with(".ply") ? geo::write_nodes_ply(out, nodes) : geo::write_pcd(out, nodes); });
    if (t.verbose) t.say("kerf-sample: " + std::to_string(nodes.size()) + " nodes");
  });
}
