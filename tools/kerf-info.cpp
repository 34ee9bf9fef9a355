// kerf-info: reports on files, and checks them.
#include <filesystem>
#include <functional>
#include <iostream>

#include <kerf/body_file.h>
#include <kerf/export.h>
#include <kerf/files.h>
#include <kerf/peridynamics.h>
#include "info/ask.h"
#include "info/diff.h"
#include "info/files.h"
#include "kind.h"
#include "tool.h"

namespace {

using Exporter = std::function<void(std::ostream&, const geo::KerfFile&, const geo::Body&)>;
Exporter exporter(const std::string& path) {
  if (path.ends_with(".vtu"))
    return [](std::ostream& out, const geo::KerfFile&, const geo::Body& body) { geo::write_vtu(out, body); };
  if (path.ends_with(".hdf"))
    return [](std::ostream& out, const geo::KerfFile&, const geo::Body& body) { geo::write_vtkhdf(out, body); };
  if (path.ends_with(".ply"))
    return [](std::ostream& out, const geo::KerfFile&, const geo::Body& body) { geo::write_graph_ply(out, body); };
  if (path.ends_with(".npz"))
    return [](std::ostream& out, const geo::KerfFile& file, const geo::Body&) { geo::write_npz(out, file); };
  if (path.ends_with(".json"))
    return [](std::ostream& out, const geo::KerfFile& file, const geo::Body&) { geo::write_json(out, file); };
  throw tool::UsageError("--export writes .vtu, .hdf, .ply, .npz, .json, .peridigm, .perilab or .peridynamics, not '" +
                         path + "'");
}

struct Command {
  std::vector<std::string> paths, edge;
  int node = -1, vertex = -1;
  bool compact = false, diff = false;
  std::string exported;
  double horizon = 3.015;
  info::ReportOptions options;
  bool asks() const { return node >= 0 || vertex >= 0 || !edge.empty(); }
};

std::size_t id_of(const std::string& text) {
  if (text.empty() || text.size() > 10 || text.find_first_not_of("0123456789") != std::string::npos)
    throw tool::UsageError("--edge '" + text + "' is not a node's number");
  return std::stoull(text);
}

void check(const Command& c, const tool::Tool& t) {
  if (c.paths.empty()) throw tool::UsageError("give a file, or - for standard input");
  if (c.diff && c.paths.size() != 2) throw tool::UsageError("--diff takes two bodies");
  if (!t.output_path.empty() && !c.compact) throw tool::UsageError("--output goes with --compact");
  if (!c.edge.empty() && c.edge.size() != 2) throw tool::UsageError("--edge takes two nodes");
  if (c.node < -1 || c.vertex < -1) throw tool::UsageError("--node and --vertex must not be negative");
  const int actions = c.diff + c.compact + !c.exported.empty() + (c.node >= 0) + (c.vertex >= 0) + !c.edge.empty();
  if (actions > 1) throw tool::UsageError("give one of --diff, --compact, --export, --node, --edge and --vertex");
  if (actions == 1 && !c.diff && c.paths.size() > 1)
    throw tool::UsageError("give one file to --compact, --export, --node, --edge and --vertex");
}

void ask(const Command& c, const geo::Body& body, info::Report& report) {
  if (c.node >= 0)
    info::ask_node(body, static_cast<std::size_t>(c.node), report);
  else if (c.vertex >= 0)
    info::ask_vertex(body, static_cast<std::size_t>(c.vertex), report);
  else
    info::ask_edge(body, id_of(c.edge[0]), id_of(c.edge[1]), report);
}

// Reports on any file but a body.
std::string report_other(const Command& c, const std::string& path, const std::string& bytes, info::Report& report) {
  const auto kind = tool::kind_of(bytes, path);
  if (c.asks() && (kind != tool::Kind::surface || c.vertex < 0))
    throw geo::InputError(path + ": is no body, which alone has nodes and edges to ask for");
  if (kind == tool::Kind::nodes) return info::report_nodes(geo::parse_nodes(bytes, path), c.options, report);
  if (kind == tool::Kind::fronts) {
    info::report_fronts(geo::parse_fronts(bytes, path), c.options, report);
    return std::string();
  }
  const auto file = tool::parse_surface(bytes, path);
  if (c.vertex < 0) return info::report_surface(file, c.options, report);
  info::ask_vertex(file.mesh, static_cast<std::size_t>(c.vertex), report);
  return {};
}

// --compact and --export.
void write(const Command& c, const tool::Tool& t) {
  const std::string& path = c.paths[0];
  const bool bonds = !c.compact && geo::is_bond_folder(c.exported);
  const Exporter put = c.compact || bonds ? Exporter() : exporter(c.exported);
  if (c.compact && path != "-" && (t.output_path.empty() || geo::same_file(path, t.output_path)))
    return geo::KerfUpdate(path).compact();
  const std::string target = c.compact ? t.target(true) : c.exported;
  geo::require_writable(target);
  geo::Input input(path);
  if (!geo::looks_like_kerf(input.text(0, 16)))
    throw geo::InputError(path + ": is not a .kerf file, which alone can be compacted or exported");
  const geo::KerfFile file(std::move(input));
  if (c.compact) return geo::write_all(target, [&](std::ostream& out) { geo::write_compacted(out, file); });
  const geo::Body body = geo::read_body(file);
  if (bonds) return geo::write_bond_folder(target, body, c.horizon);
  geo::write_all(target, [&](std::ostream& out) { put(out, file, body); });
}

// Fills the report; returns the first fault.
std::string inspect(const Command& c, const std::string& path, info::Report& report) {
  if (c.diff) {
    const bool same = info::report_difference(geo::read_body(path), geo::read_body(c.paths[1]), report);
    return same ? std::string() : "differs from " + c.paths[1];
  }
  if (!c.asks() && std::filesystem::is_directory(path)) return info::report_run(path, c.options, report);
  if (!c.asks() && path.ends_with(".toml")) return info::report_scene(path, c.options, report);
  geo::Input input(path);
  const auto size = input.size();
  if (!geo::looks_like_kerf(input.text(0, 16))) return report_other(c, path, input.text(0, size), report);
  const geo::KerfFile file(std::move(input));
  const geo::Body body = geo::read_body(file);
  if (!c.asks()) return info::report_body(file, body, size, c.options, report);
  ask(c, body, report);
  return {};
}

void one(const Command& c, const tool::Tool& t) {
  info::Report report;
  const std::string problem = inspect(c, c.paths[0], report);
  if (!t.quiet || t.json) report.print(t.json);
  if ((c.options.check || c.diff) && !problem.empty()) throw tool::Failure(c.paths[0] + ": " + problem);
}

// A sentence for each file. Files that cannot be read, or have faults, do not stop the rest.
void many(const Command& c, const tool::Tool& t) {
  std::size_t wrong = 0;
  for (const auto& path : c.paths) {
    std::string problem;
    info::Report report;
    report.add_text("file", path);
    try {
      const std::string found = inspect(c, path, report);
      if (c.options.check && !found.empty()) problem = path + ": " + found;
      if (t.json)
        report.print(true);
      else if (!t.quiet)
        std::cout << path << ": " << report.headline << '\n';
    } catch (const geo::InputError& e) {
      problem = e.what();
    }
    if (problem.empty()) continue;
    std::cerr << "kerf-info: " << problem << '\n';
    ++wrong;
  }
  if (wrong > 0)
    throw tool::Failure(std::to_string(wrong) + " of " + std::to_string(c.paths.size()) +
                        " files cannot be read or are not sound");
}

}  // namespace

int main(int argc, char** argv) {
  tool::Tool t("kerf-info",
               "Says what a surface, node, body, front or scene file or the folder of a run holds; --check verifies "
               "every invariant.",
               R"(  kerf-info cut.kerf
  kerf-info --check cut.ply
  kerf-info --json bear.off
  kerf-info --check pieces/*.ply
  kerf-info cut.kerf --histogram
  kerf-info cut.kerf --node 12
  kerf-info cut.kerf --edge 12 40
  kerf-info cut.kerf --vertex 7
  kerf-info --diff bear.kerf cut.kerf
  kerf-info out/halve
  kerf-info cut.kerf --export cut.vtu
  kerf-info cut.kerf --export cut.peridigm
  kerf-info --compact cut.kerf)");
  Command c;
  t.argument("FILE", c.paths,
             "Files of Kerf's, folders of runs; - reads standard input; of several a sentence each; two with --diff");
  t.flag("--check", c.options.check, "Verify everything; exit code 1 names the first offending ids");
  t.flag("--histogram", c.options.histograms,
         "Distributions: of radii, edge lengths, neighbours, as far as there are any");
  t.option("--node", c.node, "Say what is known of this node of a body; the first is 0");
  t.option("--edge", c.edge, "Say what is between these two nodes of a body");
  t.option("--vertex", c.vertex,
           "Say what is known of this surface vertex of a body, or vertex of a surface; the first is 0");
  t.flag("--diff", c.diff, "Say what differs between two bodies; exit code 1 when anything does");
  t.flag("--compact", c.compact, "Fold what updates appended to a body, in the file itself or into that of --output");
  t.output_option(
      "--export", c.exported,
      "Write a body as .vtu, .hdf (for ParaView), .ply, .npz or .json, told by the name's end; as a folder for "
      "peridynamics: .peridigm, .perilab, .peridynamics (for Peridynamics.jl)");
  t.option("--horizon", c.horizon, "Horizon of a node for peridynamics, in node spacings, from 1 to 20");
  t.output("Where --compact writes", {".kerf"});
  return t.run(argc, argv, [&] {
    if (c.paths.empty() && c.edge.size() == 3) {
      c.paths = {c.edge[2]};
      c.edge.pop_back();
    }  // --edge I J FILE
    check(c, t);
    if (c.compact || !c.exported.empty()) return write(c, t);
    c.paths.size() > 1 && !c.diff ? many(c, t) : one(c, t);
  });
}
