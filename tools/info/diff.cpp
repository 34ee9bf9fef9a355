// Nodes and surface vertices are matched by index, edges by their ends. Values are compared bit for
// bit.
#include "info/diff.h"

#include <algorithm>

#include <kerf/pieces.h>
#include "tool.h"

namespace info {
namespace {

// Counts the differences of one kind, and keeps the first ids.
class Count {
 public:
  void add(const std::string& id) {
    if (n_++ < 8) first_.push_back(id);
  }
  void add(std::size_t id) { add(std::to_string(id)); }
  void put(const std::string& key, Report& report) const {
    report.add(key, n_);
    if (n_ > 0) report.add(key + "_first", list(first_));
  }
  std::size_t size() const { return n_; }

 private:
  std::size_t n_ = 0;
  std::vector<std::string> first_;
};

std::string pair(std::uint32_t i, std::uint32_t j) { return "[" + std::to_string(i) + "," + std::to_string(j) + "]"; }

// Edges of `a` that `b` lacks.
Count edges_missing(const geo::Body& a, const geo::Body& b) {
  Count gone;
  for (std::uint32_t i = 0; i < a.nodes.size(); ++i)
    for (const geo::NodeId j : a.graph.edges(geo::NodeId(i)))
      if (j.value > i && (j.index() >= b.nodes.size() || !b.graph.has_edge(geo::NodeId(i), j)))
        gone.add(pair(i, j.value));
  return gone;
}

std::size_t living(const geo::Complex& k) {
  std::size_t n = 0;
  for (std::uint32_t v = 0; v < k.surface_vertex_count(); ++v) n += k.alive(geo::SurfaceVertexId(v));
  return n;
}

}  // namespace

bool report_difference(const geo::Body& a, const geo::Body& b, Report& report) {
  const std::size_t common = std::min(a.nodes.size(), b.nodes.size());
  Count moved, resized, rows, added, removed;
  for (std::size_t i = 0; i < common; ++i) {
    if (a.nodes.position[i] != b.nodes.position[i]) moved.add(i);
    if (a.nodes.radius[i] != b.nodes.radius[i] || a.nodes.volume[i] != b.nodes.volume[i] ||
        a.nodes.spacing[i] != b.nodes.spacing[i] || a.debris[i] != b.debris[i])
      resized.add(i);
    if (!(a.graph.row(geo::NodeId(i)) == b.graph.row(geo::NodeId(i)))) rows.add(i);
  }
  for (std::size_t i = common; i < b.nodes.size(); ++i) added.add(i);
  for (std::size_t i = common; i < a.nodes.size(); ++i) removed.add(i);
  const Count cut = edges_missing(a, b), drawn = edges_missing(b, a);
  Count rebound;
  const std::size_t vertices = std::min(a.binding.master.size(), b.binding.master.size());
  const auto carrier = [](const geo::Body& body, std::size_t v) {
    return body.binding.master[v].valid() ? body.binding.master_node[body.binding.master[v].index()] : geo::NodeId();
  };
  for (std::size_t v = 0; v < vertices; ++v)
    if (carrier(a, v) != carrier(b, v)) rebound.add(v);
  const std::size_t pieces_a = geo::find_pieces(a.surface).count, pieces_b = geo::find_pieces(b.surface).count;
  const geo::TriangleMesh first = a.surface.two_sided(), second = b.surface.two_sided();
  const bool same_surface =
      first.vertices == second.vertices && first.triangles == second.triangles && first.patch == second.patch;
  const bool same = same_surface && moved.size() + resized.size() + rows.size() + added.size() + removed.size() == 0 &&
                    a.graph == b.graph && a.binding == b.binding;
  report.headline = same ? "The same body."
                         : "From the first to the second: " + counted(pieces_a, "piece") + " → " +
                               std::to_string(pieces_b) + ", " + counted(cut.size(), "edge") + " cut, " +
                               grouped(drawn.size()) + " drawn, " + counted(added.size(), "node") + " added, " +
                               counted(rows.size(), "node") + " with other edges or neighbours.";
  report.add("same", same);
  report.add("pieces", numbers(std::vector{pieces_a, pieces_b}));
  report.add("faces", numbers(std::vector{a.surface.live_face_count(), b.surface.live_face_count()}));
  report.add("vertices", numbers(std::vector{living(a.surface), living(b.surface)}));
  report.add("same_surface", same_surface);
  report.add("nodes", numbers(std::vector{a.nodes.size(), b.nodes.size()}));
  added.put("nodes_added", report);
  removed.put("nodes_removed", report);
  moved.put("nodes_moved", report);
  resized.put("nodes_resized", report);
  rows.put("rows_changed", report);
  report.add("edges", numbers(std::vector{a.graph.edge_count(), b.graph.edge_count()}));
  cut.put("edges_cut", report);
  drawn.put("edges_drawn", report);
  rebound.put("vertices_rebound", report);
  return same;
}

}  // namespace info
