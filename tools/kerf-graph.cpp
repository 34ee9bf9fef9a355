// kerf-graph: builds visibility graph, neighbourhoods and binding from nodes and their surface.
#include <sstream>

#include <kerf/body.h>
#include <kerf/body_file.h>
#include <kerf/files.h>
#include "model.h"
#include "tool.h"
#include "version.h"

int main(int argc, char** argv) {
  tool::Tool t("kerf-graph", "Builds the visibility graph of nodes inside a surface, and all that hangs on it.",
               R"(  kerf-graph nodes.pcd --surface bear.off -o bear.kerf
  kerf-sample bear.off | kerf-graph --surface bear.off -o bear.kerf)");
  std::string nodes_path = "-", surface_path, method = "auto";
  int k = 26;
  double guides = 0;
  t.argument("NODES", nodes_path, "Nodes from kerf-sample (PCD or PLY); default: standard input", false);
  t.option("--surface", surface_path, "The model that was sampled");
  t.option("-k", k, "Nearest neighbours per node");
  t.option("--guides", guides, "Guides along concave edges, so many node spacings apart; 0: none");
  t.choice("--method", method, {"auto", "mfw", "dijkstra"},
           "Neighbourhoods by the fastest way, the paper's, or Dijkstra's; all give the same");
  t.output("The body (.kerf)", {".kerf"});
  return t.run(argc, argv, [&] {
    if (surface_path.empty()) throw tool::UsageError("give the model with --surface");
    if (surface_path == "-" && nodes_path == "-")
      throw tool::UsageError("nodes and surface cannot both come from standard input");
    if (k < 3 || k > 1000) throw tool::UsageError("-k must be from 3 to 1000");
    if (guides != 0 && !(guides >= 0.05 && guides <= 10))
      throw tool::UsageError("--guides must be 0, or from 0.05 to 10");
    geo::BodyOptions options;
    options.k = k;
    options.guide_spacing = guides;
    if (method == "mfw")
      options.method = geo::NeighborMethod::mfw;
    else if (method == "dijkstra")
      options.method = geo::NeighborMethod::dijkstra;
    const std::string target = t.target(true);
    const std::string surface_bytes = geo::read_all(surface_path);
    const auto file = tool::parse_solid(surface_bytes, surface_path);
    const std::string nodes_bytes = geo::read_all(nodes_path);
    geo::NodeSet nodes = geo::parse_nodes(nodes_bytes, nodes_path);
    geo::Body body;
    try {
      body = geo::build_body(tool::complex_of(file, surface_path), std::move(nodes), options, t.progress());
    } catch (const geo::InputError& e) {
      throw geo::InputError(nodes_path + ": " + e.what());
    }
    std::ostringstream arguments;
    arguments << "-k " << k;
    if (guides > 0) arguments << " --guides " << guides;
    body.history.push_back({.tool = "kerf-graph",
                            .version = KERF_VERSION,
                            .arguments = arguments.str(),
                            .inputs = {tool::named_hash(nodes_path, geo::fingerprint(nodes_bytes)),
                                       tool::named_hash(surface_path, geo::fingerprint(surface_bytes))}});
    geo::write_all(target, [&](std::ostream& out) { geo::write_body(out, body); });
    if (t.verbose)
      t.say("kerf-graph: " + std::to_string(body.nodes.size()) + " nodes, " + std::to_string(body.graph.edge_count()) +
            " edges");
  });
}
