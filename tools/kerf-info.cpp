// kerf-info: what a file holds, and whether it is sound.
#include <algorithm>
#include <cmath>
#include <functional>
#include <iostream>
#include <numeric>

#include "body/body.h"
#include "io/body_file.h"
#include "io/export.h"
#include "io/front_file.h"
#include "io/node_file.h"
#include "io/stream.h"
#include "kind.h"
#include "model.h"
#include "surface/pieces.h"
#include "tool.h"

namespace {

using tool::number;

class Report {
 public:
  void add(const std::string& key, const std::string& value) { rows_.push_back({key, value}); }
  void add(const std::string& key, std::size_t value) { add(key, std::to_string(value)); }
  void add(const std::string& key, bool value) { add(key, std::string(value ? "true" : "false")); }
  void print(bool json) const {
    if (!json) {
      for (const auto& [key, value] : rows_) std::cout << key << std::string(std::max<std::size_t>(1, 20 - std::min<std::size_t>(19, key.size())), ' ') << value << '\n';
      return;
    }
    std::cout << '{';
    for (std::size_t i = 0; i < rows_.size(); ++i) std::cout << (i ? "," : "") << tool::quoted(rows_[i].first) << ':' << rows_[i].second;
    std::cout << "}\n";
  }

 private:
  std::vector<std::pair<std::string, std::string>> rows_;
};

std::string surface_report(const geo::SurfaceFile& file, bool check, Report& report) {
  const auto& mesh = file.mesh;
  const auto result = geo::check_surface(mesh, check);
  report.add("kind", tool::quoted("surface"));
  report.add("vertices", mesh.vertices.size());
  report.add("faces", mesh.triangles.size());
  const auto cracks = static_cast<std::size_t>(std::count_if(mesh.patch.begin(), mesh.patch.end(), [](auto p) { return p > 0; }));
  report.add("skin_faces", static_cast<std::size_t>(mesh.triangles.size() - 2 * cracks));
  report.add("crack_faces", cracks);
  std::size_t pieces = 0, front_edges = 0;
  if (result.good() || (result.closed && result.manifold && result.oriented)) try {
      const auto complex = geo::Complex::from_two_sided(mesh);
      pieces = geo::find_pieces(complex).count;
      for (std::uint32_t f = 0; f < complex.face_count(); ++f)
        for (int k = 0; k < 3; ++k)
          if (complex.face(geo::FaceId(f)).crack > 0) front_edges += complex.around(complex.face(geo::FaceId(f)).v[k], complex.face(geo::FaceId(f)).v[(k + 1) % 3]).size() == 1;
    } catch (const geo::InputError&) {
    }
  report.add("pieces", pieces);
  report.add("closed", result.closed);
  report.add("manifold", result.manifold);
  report.add("oriented", result.oriented);
  report.add("self_intersections", result.self_intersections ? std::to_string(*result.self_intersections) : "null");
  report.add("volume", number(geo::signed_volume(mesh)));
  report.add("area", number(geo::area(mesh)));
  report.add("front_edges", front_edges);
  report.add("degenerate_faces", result.degenerate_faces);
  report.add("fronts", file.fronts.size());
  auto names = mesh.attributes.names();
  if (!mesh.source.empty()) names.push_back("source");
  std::string list;
  for (const auto& name : names) list += (list.empty() ? "" : ",") + tool::quoted(name);
  report.add("attributes", "[" + list + "]");
  if (result.good() && check && !mesh.two_sided() && geo::signed_volume(mesh) <= 0) return "the surface is inside out; reverse its triangles";
  return result.first_problem;
}

// Names two nodes at one place; empty when there are none.
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
      return "nodes " + std::to_string(order[i - 1]) + " and " + std::to_string(order[i]) + " are at one place; remove one of them";
  return {};
}

std::string body_report(const geo::Body& body, std::size_t bytes, bool check, Report& report) {
  geo::BodyReport result;
  std::string problem;
  std::vector<std::uint32_t> component;
  if (check) {
    result = geo::check_body(body);
    problem = result.first_problem;
    if (problem.empty()) problem = geo::check_complex(body.surface, true).first_problem;
  } else {
    result.graph_components = body.graph.components(component);
    result.pieces = geo::find_pieces(body.surface).count;
    for (std::uint32_t v = 0; v < body.surface.surface_vertex_count(); ++v)
      result.orphans += body.surface.alive(geo::SurfaceVertexId(v)) && !body.binding.master[v].valid();
  }
  std::size_t least = ~std::size_t(0), most = 0, sum = 0, vertices = 0;
  for (std::size_t i = 0; i < body.nodes.size(); ++i) {
    const std::size_t count = body.graph.neighbor_count(geo::NodeId(i));
    least = std::min(least, count), most = std::max(most, count), sum += count;
  }
  for (std::uint32_t v = 0; v < body.surface.surface_vertex_count(); ++v) vertices += body.surface.alive(geo::SurfaceVertexId(v));
  report.add("kind", tool::quoted("body"));
  report.add("nodes", body.nodes.size());
  report.add("edges", body.graph.edge_count());
  if (body.graph.guides().size() > 0) report.add("guides", std::size_t(body.graph.guides().size()));
  report.add("graph_components", result.graph_components);
  report.add("pieces", result.pieces);
  report.add("edges_crossing", check ? std::to_string(result.edges_crossing) : "null");
  report.add("neighbors_min", least);
  report.add("neighbors_mean", number(std::round(100 * double(sum) / double(body.nodes.size())) / 100));
  report.add("neighbors_max", most);
  report.add("vertices", vertices);
  report.add("orphans", result.orphans);
  report.add("bytes", bytes);
  report.add("updates", static_cast<std::size_t>(body.updates));
  report.add("debris", static_cast<std::size_t>(std::count(body.debris.begin(), body.debris.end(), 1)));
  report.add("volume", number(std::accumulate(body.nodes.volume.begin(), body.nodes.volume.end(), 0.0)));
  return problem;
}

std::string other_report(const std::string& bytes, const std::string& path, bool check, Report& report) {
  switch (tool::kind_of(bytes, path)) {
    case tool::Kind::nodes: {
      const auto nodes = geo::parse_nodes(bytes, path);
      const auto [lo, hi] = std::minmax_element(nodes.spacing.begin(), nodes.spacing.end());
      report.add("kind", tool::quoted("nodes"));
      report.add("nodes", nodes.size());
      report.add("spacing_min", number(*lo));
      report.add("spacing_max", number(*hi));
      report.add("volume", number(std::accumulate(nodes.volume.begin(), nodes.volume.end(), 0.0)));
      return check ? twins(nodes) : std::string();
    }
    case tool::Kind::fronts: {
      const auto fronts = geo::parse_fronts(bytes, path);
      report.add("kind", tool::quoted("fronts"));
      report.add("fronts", fronts.size());
      std::size_t steps = 0, points = 0;
      for (const auto& f : fronts) {
        steps += f.steps.size();
        for (const auto& s : f.steps) points += s.size();
      }
      report.add("steps", steps);
      report.add("points", points);
      return {};
    }
    default: return surface_report(geo::parse_surface(bytes, path), check, report);
  }
}

using Exporter = std::function<void(std::ostream&, const geo::KerfFile&, const geo::Body&)>;
Exporter exporter(const std::string& path) {
  if (path.ends_with(".vtu")) return [](std::ostream& out, const geo::KerfFile&, const geo::Body& body) { geo::write_vtu(out, body); };
  if (path.ends_with(".hdf")) return [](std::ostream& out, const geo::KerfFile&, const geo::Body& body) { geo::write_vtkhdf(out, body); };
  if (path.ends_with(".ply")) return [](std::ostream& out, const geo::KerfFile&, const geo::Body& body) { geo::write_graph_ply(out, body); };
  if (path.ends_with(".npz")) return [](std::ostream& out, const geo::KerfFile& file, const geo::Body&) { geo::write_npz(out, file); };
  if (path.ends_with(".json")) return [](std::ostream& out, const geo::KerfFile& file, const geo::Body&) { geo::write_json(out, file); };
  throw tool::UsageError("--export writes .vtu, .hdf, .ply, .npz or .json, not '" + path + "'");
}

}  // namespace

int main(int argc, char** argv) {
  tool::Tool t("kerf-info", "Says what a surface, node, body or front file holds; --check verifies every invariant.",
               "  kerf-info cut.kerf\n  kerf-info --check cut.ply\n  kerf-info --json bear.off\n  kerf-info cut.kerf --export cut.vtu\n  kerf-info --compact cut.kerf");
  std::string path;
  bool check = false, compact = false;
  std::string exported;
  t.argument("FILE", path, "Any file of Kerf's; - reads standard input");
  t.flag("--check", check, "Verify everything; exit code 1 names the first offending ids");
  t.flag("--compact", compact, "Fold what updates appended to a body, in the file itself or into that of --output");
  t.option("--export", exported, "Write a body as .vtu, .hdf (for ParaView), .ply, .npz or .json, told by the name's end");
  t.output("Where --compact writes");
  return t.run(argc, argv, [&] {
    if (!t.output_path.empty() && !compact) throw tool::UsageError("--output goes with --compact");
    const Exporter write = exported.empty() ? Exporter() : exporter(exported);
    if (compact && path != "-" && (t.output_path.empty() || geo::same_file(path, t.output_path))) return geo::KerfUpdate(path).compact();
    const std::string target = compact ? t.target(true) : std::string();
    geo::Input input(path);
    const auto size = input.size();
    const bool kerf = geo::looks_like_kerf(input.text(0, 16));
    if (!kerf && (compact || write)) throw geo::InputError(path + ": is not a .kerf file, which alone can be compacted or exported");
    Report report;
    std::string problem;
    if (kerf) {
      const geo::KerfFile file(std::move(input));
      if (compact) return geo::write_all(target, [&](std::ostream& out) { geo::write_compacted(out, file); });
      const geo::Body body = geo::read_body(file);
      if (write) return geo::write_all(exported, [&](std::ostream& out) { write(out, file, body); });
      problem = body_report(body, size, check, report);
      report.add("appended", static_cast<std::size_t>(file.updates()));
    } else {
      problem = other_report(input.text(0, size), path, check, report);
    }
    if (!t.quiet || t.json) report.print(t.json);
    if (check && !problem.empty()) throw tool::Failure(path + ": " + problem);
  });
}
