// read_body() and write_body() of kerf/body_file.h. A body as sections of a .kerf file
// (docs/formats.md). Reading checks every index and value, and derives what is not stored: lengths,
// edges of guides from both ends, the grid.
#include "kerf/body_file.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "body/incremental_cache.h"
#include "body/node_insertion.h"
#include "graph/graph_storage.h"
#include "io/body_sections.h"
#include "io/json_integer.h"
#include "io/kerf_update.h"

namespace geo {

std::span<const double> coordinates(const std::vector<Vec3>& points) {
  return {points.empty() ? nullptr : points[0].data(), 3 * points.size()};
}

std::vector<Vec3> read_points(const KerfFile& file, const std::string& section) {
  const auto values = file.read<double>(section, 3);
  std::vector<Vec3> result;
  result.reserve(values.size() / 3);
  for (std::size_t i = 0; i + 2 < values.size(); i += 3) {
    result.push_back({values[i], values[i + 1], values[i + 2]});
    if (!in_range(result.back()))
      file.fail("section '" + section + "' holds a value that is not a finite number of sensible size");
  }
  return result;
}

namespace {

// ---- Writing: the arrays of each part of a body. They refer to the body and to members of Arrays.

struct Arrays {
  const Body& body;
  TriangleMesh mesh = {};
  std::vector<std::uint32_t> rows = {};  // of the mesh, by surface vertex
  std::vector<std::uint32_t> master_node = {}, master = {}, parent = {}, closest = {};
  std::vector<std::array<std::uint32_t, 2>> guide_edges = {};
  std::vector<std::uint8_t> about = {};
  std::vector<KerfArray> all = {};
  template <class T>
  void add(const std::string& name, std::span<const T> values, std::uint64_t columns = 1) {
    all.push_back(kerf_array(name, values, columns));
  }
  template <class T>
  void add(const std::string& name, const std::vector<T>& values) {
    add(name, std::span<const T>(values));
  }
  template <class T>
  void add(const std::string& name, std::uint64_t count, std::uint64_t columns, std::function<void(KerfSink&)> fill) {
    all.push_back(kerf_array<T>(name, count, columns, std::move(fill)));
  }
};

void add_surface(Arrays& a) {
  a.mesh = a.body.surface.two_sided(&a.rows);
  a.add("surface/vertices", coordinates(a.mesh.vertices), 3);
  a.add("surface/triangles",
        std::span<const std::uint32_t>(a.mesh.triangles.empty() ? nullptr : a.mesh.triangles[0].data(),
                                       3 * a.mesh.triangles.size()),
        3);
  a.add("surface/patch", a.mesh.patch);
  a.add("surface/site", a.mesh.site);
  a.add("surface/source", a.mesh.source);
}

void add_nodes(Arrays& a) {
  a.add("nodes/position", coordinates(a.body.nodes.position), 3);
  a.add("nodes/radius", a.body.nodes.radius);
  a.add("nodes/spacing", a.body.nodes.spacing);
  a.add("nodes/volume", a.body.nodes.volume);
  a.add("nodes/debris", a.body.debris);
}

// Guides, where there are any. Their edges to nodes are in the adjacency of the nodes.
void add_guides(Arrays& a) {
  const GuideSet& guides = GraphStorage::of(a.body.graph).guides();
  if (guides.size() == 0) return;
  a.add<double>("guides/position", guides.size(), 3, [&guides](KerfSink& out) {
    for (std::uint32_t g = 0; g < guides.size(); ++g)
      for (const double x : guides.position(g)) out.put(x);
  });
  a.add<double>("guides/radius", guides.size(), 1, [&guides](KerfSink& out) {
    for (std::uint32_t g = 0; g < guides.size(); ++g) out.put(guides.radius(g));
  });
  a.guide_edges = GraphStorage::of(a.body.graph).guide_edges();
  a.add("guides/edges",
        std::span<const std::uint32_t>(a.guide_edges.empty() ? nullptr : a.guide_edges[0].data(),
                                       2 * a.guide_edges.size()),
        2);
}

// Edges and neighbours. Lengths of rows, not offsets: a change in one row leaves the others as they
// are.
void add_rows(Arrays& a) {
  const AdjacencyStore& rows = GraphStorage::of(a.body.graph).rows();
  const std::size_t n = rows.size();
  std::uint64_t entries = 0, paths = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const AdjacencyRow row = rows.row(i);
    entries += row.to.size();
    paths += row.paths.size();
  }
  const auto each = [&rows, n](const auto& part) {
    return [&rows, n, part](KerfSink& out) {
      for (std::size_t i = 0; i < n; ++i) out.write(std::as_bytes(part(rows.row(i))));
    };
  };
  a.add<double>("graph/plain_unit", 1, 1,
                [&body = a.body](KerfSink& out) { out.put(GraphStorage::of(body.graph).plain_unit()); });
  a.add<std::uint32_t>("graph/count", n, 1, [&rows, n](KerfSink& out) {
    for (std::size_t i = 0; i < n; ++i) out.put(static_cast<std::uint32_t>(rows.entries(i).to.size()));
  });
  a.add<std::uint32_t>("graph/to", entries, 1, each([](const AdjacencyRow& row) { return row.to; }));
  a.add<std::uint16_t>("graph/bits", entries, 1, each([](const AdjacencyRow& row) { return row.bits; }));
  a.add<float>("graph/paths", paths, 1, each([](const AdjacencyRow& row) { return row.paths; }));
}

void add_binding(Arrays& a) {
  const Body& body = a.body;
  const auto row_of = [&](SurfaceVertexId v) { return v.valid() && body.surface.alive(v) ? a.rows[v.index()] : ~0u; };
  for (std::uint32_t v = 0; v < a.rows.size(); ++v) {
    if (a.rows[v] == ~0u) continue;
    a.master_node.push_back(body.binding.master_node[v].value);
    a.master.push_back(row_of(body.binding.master[v]));
    a.parent.push_back(row_of(body.binding.parent[v]));
  }
  for (const auto v : body.binding.closest) a.closest.push_back(row_of(v));
  a.add("binding/master_node", a.master_node);
  a.add("binding/master", a.master);
  a.add("binding/parent", a.parent);
  a.add("binding/closest", a.closest);
}

void add_about(Arrays& a) {
  const Body& body = a.body;
  nlohmann::ordered_json about = {{"k", body.k},
                                  {"updates", body.crack_steps},
                                  {"resample_limit", body.resample_limit},
                                  {"sampled", body.original_nodes},
                                  {"cell", body.cache->grid.cell()},
                                  {"crack_count", body.surface.crack_count()}};
  if (body.guide_spacing > 0) about["guides"] = body.guide_spacing;
  if (const auto first = body.nodes.radius.begin();
      body.widest_radius != *std::max_element(first, first + body.original_nodes))
    about["widest"] = body.widest_radius;
  about["history"] = nlohmann::ordered_json::array();
  for (const auto& p : body.history)
    about["history"].push_back(
        {{"tool", p.tool}, {"version", p.version}, {"arguments", p.arguments}, {"inputs", p.inputs}});
  const std::string text = about.dump();
  a.about.assign(text.begin(), text.end());
  a.add("about", a.about);
  a.all.back().dtype = "json";
}

void add_all(Arrays& a) {
  add_surface(a);
  add_nodes(a);
  add_guides(a);
  add_rows(a);
  add_binding(a);
  add_about(a);
}

// ---- Reading: each part is checked before the next one refers to it.

void read_surface(const KerfFile& in, Body& body) {
  TriangleMesh mesh;
  mesh.vertices = read_points(in, "surface/vertices");
  const auto triangles = in.read<std::uint32_t>("surface/triangles", 3);
  mesh.triangles.reserve(triangles.size() / 3);
  for (std::size_t i = 0; i + 2 < triangles.size(); i += 3)
    mesh.triangles.push_back({triangles[i], triangles[i + 1], triangles[i + 2]});
  mesh.patch = in.read<std::int32_t>("surface/patch");
  mesh.site = in.read<std::uint32_t>("surface/site");
  if (mesh.site.empty()) in.fail("the surface is empty");
  const bool traced = in.sections().count("surface/source") > 0;
  if (traced) mesh.source = in.read<std::uint32_t>("surface/source");
  try {
    body.surface = Complex::from_two_sided(mesh);
    if (traced) body.surface.map_sources(mesh.source);
  } catch (const InputError& e) {
    in.fail(e.what());
  }
}

void read_nodes(const KerfFile& in, Body& body) {
  NodeSet& nodes = body.nodes;
  nodes.position = read_points(in, "nodes/position");
  nodes.radius = in.read<double>("nodes/radius");
  nodes.spacing = in.read<double>("nodes/spacing");
  nodes.volume = in.read<double>("nodes/volume");
  body.debris = in.read<std::uint8_t>("nodes/debris");
  const std::size_t n = nodes.size();
  if (n == 0 || n >= NodeId::none || nodes.radius.size() != n || nodes.spacing.size() != n ||
      nodes.volume.size() != n || body.debris.size() != n)
    in.fail("the sections of nodes have different lengths");
  for (std::size_t i = 0; i < n; ++i)
    if (!(nodes.radius[i] > 0) || !(nodes.spacing[i] > 0) || !(nodes.volume[i] > 0) ||
        !(nodes.radius[i] + nodes.spacing[i] + nodes.volume[i] <= largest_coordinate))
      in.fail("node " + std::to_string(i) +
              " has a radius, spacing or volume that is not positive or of no sensible size");
}

// Files of version 1, and early ones of version 2, have edges i < j and neighbours in separate
// sections, with all distances.
void read_old_rows(const KerfFile& in, Body& body, double unit) {
  const NodeSet& nodes = body.nodes;
  const std::size_t n = nodes.size();
  const auto ends_of = [&](const std::string& group, std::size_t size) {
    const bool counted = in.sections().count(group + "/ends") == 0;
    const std::string section = group + (counted ? "/count" : "/ends");
    const auto values = in.read<std::uint32_t>(section);
    std::vector<std::uint64_t> ends(values.begin(), values.end());
    if (counted) std::partial_sum(ends.begin(), ends.end(), ends.begin());
    if (!std::is_sorted(ends.begin(), ends.end())) in.fail("section '" + section + "' is not ascending");
    if (ends.size() != n || ends.back() != size) in.fail("section '" + section + "' does not fit");
    return ends;
  };
  GraphStorage edges;
  edges.resize(n);
  const auto edge = in.read<std::uint32_t>("graph/to");
  const auto edge_ends = ends_of("graph", edge.size());
  for (std::uint32_t i = 0; i < n; ++i)
    for (auto e = i ? edge_ends[i - 1] : 0; e < edge_ends[i]; ++e)
      if (edge[e] >= n || edge[e] <= i || !edges.add(nodes, i, edge[e]))
        in.fail("edge " + std::to_string(e) + " of the graph is out of range or there twice");
  const auto neighbor = in.read<std::uint32_t>("neighbors/to"), warped = in.read<std::uint32_t>("neighbors/warped");
  const auto distance = in.read<float>("neighbors/distance");
  const auto ends = ends_of("neighbors", neighbor.size());
  if (warped.size() != neighbor.size() || distance.size() != neighbor.size())
    in.fail("the sections of neighbours have different lengths");
  std::vector<std::uint32_t> count, to;
  std::vector<std::uint16_t> bits;
  std::vector<float> paths;
  for (std::uint32_t i = 0; i < n; ++i) {
    std::map<std::uint32_t, std::pair<std::uint16_t, float>> row;
    for (const NodeId j : edges.edges(NodeId(i)))
      row[j.value] = {AdjacencyRow::edge_bit | AdjacencyRow::path_bit | AdjacencyRow::bits_of_bound(unit_radius), 0};
    for (auto e = i ? ends[i - 1] : 0; e < ends[i]; ++e) {
      if (neighbor[e] >= n || warped[e] >= unit_radius || !(distance[e] >= 0) || !std::isfinite(distance[e]))
        in.fail("neighbour " + std::to_string(e) + " is out of range");
      // A pair without sight of each other has a path longer than the straight line.
      const auto straight =
          static_cast<float>(std::sqrt(squared_distance(nodes.position[i], nodes.position[neighbor[e]])));
      const bool hidden = distance[e] > std::nextafter(straight, 2 * straight);
      const std::uint16_t kind = row.count(neighbor[e]) ? AdjacencyRow::edge_bit : hidden ? AdjacencyRow::path_bit : 0;
      row[neighbor[e]] = {kind | AdjacencyRow::bits_of_bound(warped[e]), distance[e]};
    }
    count.push_back(static_cast<std::uint32_t>(row.size()));
    for (const auto& [j, entry] : row) {
      to.push_back(j);
      bits.push_back(entry.first);
      if (AdjacencyRow::has_path(entry.first)) paths.push_back(entry.second);
    }
  }
  GraphStorage::of(body.graph) =
      GraphStorage::from_arrays(nodes, unit, {.count = count, .to = to, .bits = bits, .paths = paths});
}

std::vector<Guide> read_guides(const KerfFile& in, std::vector<std::array<std::uint32_t, 2>>& edges) {
  std::vector<Guide> guides;
  if (in.sections().count("guides/position") == 0) return guides;
  const auto radius = in.read<double>("guides/radius");
  for (const Vec3& p : read_points(in, "guides/position"))
    guides.push_back({p, guides.size() < radius.size() ? radius[guides.size()] : -1});
  if (guides.size() != radius.size() || guides.size() >= VisibilityGraph::first_guide - 1)
    in.fail("the sections of guides have different lengths");
  for (const Guide& g : guides)
    if (!(g.radius >= 0 && g.radius <= largest_coordinate))
      in.fail("section 'guides/radius' holds a value that is negative or of no sensible size");
  const auto ends = in.read<std::uint32_t>("guides/edges", 2);
  for (std::size_t e = 0; e + 1 < ends.size(); e += 2) edges.push_back({ends[e], ends[e + 1]});
  return guides;
}

void read_rows(const KerfFile& in, Body& body) {
  const auto unit = in.read<double>("graph/plain_unit");
  if (unit.size() != 1 || !(unit[0] > 0) || !std::isfinite(unit[0]))
    in.fail("the unit of plain lengths is not positive");
  if (in.sections().count("neighbors/to")) return read_old_rows(in, body, unit[0]);
  const auto count = in.read<std::uint32_t>("graph/count"), to = in.read<std::uint32_t>("graph/to");
  const auto bits = in.read<std::uint16_t>("graph/bits");
  const auto paths = in.read<float>("graph/paths");
  std::vector<std::array<std::uint32_t, 2>> edges;
  const auto guides = read_guides(in, edges);
  try {
    GraphStorage::of(body.graph) =
        GraphStorage::from_arrays(body.nodes, unit[0], {count, to, bits, paths, guides, edges});
  } catch (const InputError& e) {
    in.fail(e.what());
  }
}

void read_binding(const KerfFile& in, Body& body) {
  const std::size_t vertices = in.sections().at("surface/vertices").shape[0], n = body.nodes.size();
  const auto ids = [&](const std::string& section, std::size_t size, std::size_t limit, auto& out) {
    const auto values = in.read<std::uint32_t>(section);
    if (values.size() != size) in.fail("section '" + section + "' has another length than expected");
    for (const auto v : values) {
      if (v != ~0u && v >= limit) in.fail("section '" + section + "' holds an id out of range");
      out.emplace_back(v);
    }
  };
  ids("binding/master_node", vertices, n, body.binding.master_node);
  ids("binding/master", vertices, vertices, body.binding.master);
  ids("binding/parent", vertices, vertices, body.binding.parent);
  ids("binding/closest", n, vertices, body.binding.closest);
  for (const auto v : body.binding.master)
    if (v.valid() && !body.binding.master_node[v.index()].valid()) in.fail("a master has no node");
}

void read_about(const KerfFile& in, Body& body) {
  const auto about = nlohmann::json::parse(in.text("about"), nullptr, false);
  double cell = 0, widest = 0;  // 0: derived from the nodes
  try {
    body.k = json_integer<int>(about.at("k"));
    body.crack_steps = json_integer<std::uint32_t>(about.at("updates"));
    body.resample_limit = about.at("resample_limit").get<double>();
    cell = about.at("cell").get<double>();
    body.guide_spacing = about.value("guides", 0.0);
    widest = about.value("widest", 0.0);
    body.original_nodes = about.contains("sampled") ? json_integer<std::uint32_t>(about.at("sampled"))
                                                    : static_cast<std::uint32_t>(body.nodes.size());
    for (const auto& p : about.at("history"))
      body.history.push_back({.tool = p.at("tool").get<std::string>(),
                              .version = p.at("version").get<std::string>(),
                              .arguments = p.at("arguments").get<std::string>(),
                              .inputs = p.at("inputs").get<std::vector<std::string>>()});
  } catch (const nlohmann::json::exception&) {
    in.fail("section 'about' is malformed");
  } catch (const std::out_of_range&) {
    in.fail("section 'about' holds an impossible value");
  }
  if (body.k < 1 || body.k > 100000 || !(cell > 0) || !(cell <= largest_coordinate) || !(body.resample_limit >= 0) ||
      body.original_nodes < 1 || body.original_nodes > body.nodes.size() ||
      !(widest >= 0 && widest <= largest_coordinate) ||
      (body.guide_spacing != 0 && !(body.guide_spacing >= 0.05 && body.guide_spacing <= 10)))
    in.fail("section 'about' holds an impossible value");
  set_original_nodes(body, body.original_nodes);
  body.widest_radius = widest > 0 ? widest : body.widest_radius;
  body.cache->grid = NodeGrid(cell, body.nodes.position);
}

}  // namespace

void write_body(std::ostream& out, const Body& body) { write_body_with(out, body, {}); }

void write_body_with(std::ostream& out, const Body& body, const std::vector<KerfArray>& more) {
  Arrays a{.body = body};
  add_all(a);
  a.all.insert(a.all.end(), more.begin(), more.end());
  write_kerf(out, a.all);
}

std::uint64_t write_body(KerfUpdate& file, const Body& body) {
  Arrays a{.body = body};
  add_all(a);
  return UpdatedFile::of(file).commit(a.all);
}

Body read_body(const KerfFile& file) {
  Body body;
  read_surface(file, body);
  read_nodes(file, body);
  read_rows(file, body);
  read_binding(file, body);
  read_about(file, body);
  return body;
}

Body read_body(const std::string& path) { return read_body(KerfFile(Input(path))); }
Body parse_body(const std::string& bytes, const std::string& name) { return read_body(KerfFile(Input(bytes, name))); }

}  // namespace geo
