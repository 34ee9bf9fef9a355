// kerf-update: updates a body to a surface that was cut after the body was built.
#include <chrono>
#include <iostream>
#include <memory>

#include <kerf/body.h>
#include <kerf/body_file.h>
#include <kerf/files.h>
#include "model.h"
#include "tool.h"
#include "version.h"

int main(int argc, char** argv) {
  tool::Tool t("kerf-update",
               "Cuts a body's visibility graph with the cracks of a surface, samples new nodes near them, and updates "
               "neighbourhoods and binding.",
               R"(  kerf-update bear.kerf --surface cut.ply -o cut.kerf
  kerf-update bear.kerf --surface cut.ply -o bear.kerf)");
  std::string body_path, surface_path;
  bool no_resample = false;
  t.argument("BODY", body_path, "The body before (.kerf)");
  t.option("--surface", surface_path, "The cut surface from kerf-crack");
  t.flag("--no-resample", no_resample, "No new nodes near cracks");
  t.output("The body after (.kerf); BODY itself: what changed is appended to it", {".kerf"});
  return t.run(argc, argv, [&] {
    if (surface_path.empty()) throw tool::UsageError("give the cut surface with --surface");
    if (surface_path == "-" && body_path == "-")
      throw tool::UsageError("body and surface cannot both come from standard input");
    const std::string target = t.target(true);
    // An update of the input file appends the changes.
    const auto in_place =
        target != "-" && geo::same_file(body_path, target) ? std::make_unique<geo::KerfUpdate>(body_path) : nullptr;
    std::uint64_t state = 0;
    const auto load = [&](const geo::KerfFile& file) {
      state = file.fingerprint();
      return geo::read_body(file);
    };
    geo::Body body = in_place ? load(in_place->file()) : load(geo::KerfFile(geo::Input(body_path)));
    const std::string surface_bytes = geo::read_all(surface_path);
    const auto file = tool::parse_solid(surface_bytes, surface_path);
    if (no_resample) body.resample_limit = 0;
    geo::SplitStats work;
    const auto start = std::chrono::steady_clock::now();
    std::size_t triangles_cut = 0;
    try {
      triangles_cut =
          geo::update_body(body, tool::complex_of(file, surface_path), &work, t.progress()).crack.removed_faces.size();
    } catch (const geo::InputError& e) {
      throw geo::InputError(surface_path + ": " + e.what());
    }
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    body.history.push_back({.tool = "kerf-update",
                            .version = KERF_VERSION,
                            .arguments = no_resample ? "--no-resample" : "",
                            .inputs = {tool::named_hash(body_path, state),
                                       tool::named_hash(surface_path, geo::fingerprint(surface_bytes))}});
    if (in_place)
      geo::write_body(*in_place, body);
    else
      geo::write_all(target, [&](std::ostream& out) { geo::write_body(out, body); });
    if (t.json)
      (target == "-" ? std::cerr : std::cout)
          << "{\"triangles_cut\":" << triangles_cut << ",\"edges_cut\":" << work.edges_cut
          << ",\"edges_added\":" << work.edges_added << ",\"nodes_updated\":" << work.nodes_updated
          << ",\"nodes_added\":" << work.nodes_added << ",\"nodes_moved\":" << work.nodes_moved
          << ",\"seconds\":{\"resample\":" << tool::number(work.resample_seconds)
          << ",\"graph\":" << tool::number(work.graph_seconds) << ",\"binding\":" << tool::number(work.binding_seconds)
          << ",\"total\":" << tool::number(seconds) << "}}\n";
    if (t.verbose)
      t.say("kerf-update: " + tool::counted(triangles_cut, "triangle") + " and " +
            tool::counted(work.edges_cut, "edge") + " cut, " + tool::counted(work.nodes_added, "node") + " added; " +
            tool::counted(body.nodes.size(), "node") + ", " + tool::counted(body.graph.edge_count(), "edge"));
  });
}
