#include "io/body_file.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numeric>

#include "io/json_internal.h"
#include "io/kerf_container.h"
#include "io/stream.h"

namespace geo {
namespace {

template <class T>
constexpr const char* dtype_of() {
  if constexpr (std::is_same_v<T, double>) return "f8";
  if constexpr (std::is_same_v<T, float>) return "f4";
  if constexpr (std::is_same_v<T, std::uint32_t>) return "u4";
  if constexpr (std::is_same_v<T, std::int32_t>) return "i4";
  if constexpr (std::is_same_v<T, std::uint8_t>) return "u1";
}

template <class T>
void put(KerfSections& sections, const std::string& name, const std::vector<T>& values, std::uint64_t columns = 1) {
  KerfSection s;
  s.dtype = dtype_of<T>();
  s.shape = {values.size() / columns};
  if (columns > 1) s.shape.push_back(columns);
  s.bytes.assign(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));
  sections[name] = std::move(s);
}

class Reader {
 public:
  Reader(const KerfSections& sections, const std::string& name) : sections_(sections), name_(name) {}
  template <class T>
  std::vector<T> get(const std::string& section, std::uint64_t columns = 1) const {
    const auto it = sections_.find(section);
    if (it == sections_.end()) fail("has no section '" + section + "'");
    const auto& s = it->second;
    if (s.dtype != dtype_of<T>() || s.shape.size() != (columns > 1 ? 2u : 1u) || (columns > 1 && s.shape[1] != columns))
      fail("section '" + section + "' is not of the expected type and shape");
    std::vector<T> values(s.bytes.size() / sizeof(T));
    if (!values.empty()) std::memcpy(values.data(), s.bytes.data(), values.size() * sizeof(T));
    return values;
  }
  [[noreturn]] void fail(const std::string& what) const { throw InputError(name_ + ": " + what + "; the file is damaged"); }

 private:
  const KerfSections& sections_;
  const std::string& name_;
};

std::vector<double> flat(const std::vector<Vec3>& points) {
  std::vector<double> values;
  values.reserve(points.size() * 3);
  for (const Vec3& p : points) values.insert(values.end(), {p.x(), p.y(), p.z()});
  return values;
}

}  // namespace

void write_body(std::ostream& out, const Body& body) {
  KerfSections s;
  std::vector<std::uint32_t> rows;
  const TriangleMesh mesh = body.surface.two_sided(&rows);
  std::vector<std::uint32_t> triangles;
  for (const auto& t : mesh.triangles) triangles.insert(triangles.end(), t.begin(), t.end());
  put(s, "surface/vertices", flat(mesh.vertices), 3);
  put(s, "surface/triangles", triangles, 3);
  put(s, "surface/patch", mesh.patch);
  put(s, "surface/site", mesh.site);
  put(s, "surface/source", mesh.source);
  put(s, "nodes/position", flat(body.nodes.position), 3);
  put(s, "nodes/radius", body.nodes.radius);
  put(s, "nodes/spacing", body.nodes.spacing);
  put(s, "nodes/volume", body.nodes.volume);
  put(s, "nodes/debris", body.debris);
  std::vector<std::uint32_t> ends, to, warped;
  std::vector<float> distance;
  for (std::uint32_t i = 0; i < body.nodes.size(); ++i) {
    for (const auto& arc : body.graph.arcs(NodeId(i)))
      if (arc.to.value > i) to.push_back(arc.to.value);
    std::sort(to.begin() + (ends.empty() ? 0 : ends.back()), to.end());
    ends.push_back(static_cast<std::uint32_t>(to.size()));
  }
  put(s, "graph/ends", ends);
  put(s, "graph/to", to);
  put(s, "graph/plain_unit", std::vector<double>{body.graph.plain_unit()});
  ends.clear(), to.clear();
  for (const auto& row : body.neighbors.rows) {
    for (const auto& n : row) to.push_back(n.to.value), warped.push_back(n.warped), distance.push_back(n.distance);
    ends.push_back(static_cast<std::uint32_t>(to.size()));
  }
  put(s, "neighbors/ends", ends);
  put(s, "neighbors/to", to);
  put(s, "neighbors/warped", warped);
  put(s, "neighbors/distance", distance);
  const auto row_of = [&](SurfaceVertexId v) { return v.valid() && body.surface.alive(v) ? rows[v.index()] : ~0u; };
  std::vector<std::uint32_t> node, master, parent, closest;
  for (std::uint32_t v = 0; v < rows.size(); ++v) {
    if (rows[v] == ~0u) continue;
    node.push_back(body.binding.master_node[v].value);
    master.push_back(row_of(body.binding.master[v]));
    parent.push_back(row_of(body.binding.parent[v]));
  }
  for (const auto v : body.binding.closest) closest.push_back(row_of(v));
  put(s, "binding/master_node", node);
  put(s, "binding/master", master);
  put(s, "binding/parent", parent);
  put(s, "binding/closest", closest);
  nlohmann::ordered_json about = {{"k", body.k}, {"updates", body.updates}, {"resample_limit", body.resample_limit}, {"cell", body.grid.cell()}, {"crack_count", body.surface.crack_count()}};
  about["history"] = nlohmann::ordered_json::array();
  for (const auto& p : body.history) about["history"].push_back({{"tool", p.tool}, {"version", p.version}, {"arguments", p.arguments}, {"inputs", p.inputs}});
  const std::string text = about.dump();
  s["about"] = {"json", {text.size()}, text};
  write_kerf(out, s);
}

Body read_body(const std::string& path) { return parse_body(read_all(path), path); }

Body parse_body(const std::string& bytes, const std::string& name) {
  const KerfSections sections = parse_kerf(bytes, name);
  const Reader in(sections, name);
  Body body;
  TriangleMesh mesh;
  const auto points = [&](const std::string& section) {
    const auto values = in.get<double>(section, 3);
    std::vector<Vec3> result;
    for (std::size_t i = 0; i + 2 < values.size(); i += 3) {
      result.push_back({values[i], values[i + 1], values[i + 2]});
      if (!in_range(result.back())) in.fail("section '" + section + "' holds a value that is not a finite number of sensible size");
    }
    return result;
  };
  mesh.vertices = points("surface/vertices");
  const auto triangles = in.get<std::uint32_t>("surface/triangles", 3);
  for (std::size_t i = 0; i + 2 < triangles.size(); i += 3) mesh.triangles.push_back({triangles[i], triangles[i + 1], triangles[i + 2]});
  mesh.patch = in.get<std::int32_t>("surface/patch");
  mesh.site = in.get<std::uint32_t>("surface/site");
  if (mesh.site.empty()) in.fail("the surface is empty");
  const bool traced = sections.count("surface/source") > 0;
  if (traced) mesh.source = in.get<std::uint32_t>("surface/source");
  try {
    body.surface = Complex::from_two_sided(mesh);
    if (traced) body.surface.trace_sources(mesh.source);
  } catch (const InputError& e) {
    in.fail(e.what());
  }
  body.nodes.position = points("nodes/position");
  body.nodes.radius = in.get<double>("nodes/radius");
  body.nodes.spacing = in.get<double>("nodes/spacing");
  body.nodes.volume = in.get<double>("nodes/volume");
  body.debris = in.get<std::uint8_t>("nodes/debris");
  const std::size_t n = body.nodes.size();
  if (n == 0 || body.nodes.radius.size() != n || body.nodes.spacing.size() != n || body.nodes.volume.size() != n || body.debris.size() != n)
    in.fail("the sections of nodes have different lengths");
  for (std::size_t i = 0; i < n; ++i)
    if (!(body.nodes.radius[i] > 0) || !(body.nodes.spacing[i] > 0) || !(body.nodes.volume[i] > 0) || !(body.nodes.radius[i] + body.nodes.spacing[i] + body.nodes.volume[i] <= largest_coordinate))
      in.fail("node " + std::to_string(i) + " has a radius, spacing or volume that is not positive or of no sensible size");
  const auto rows = [&](const std::string& group, std::size_t size) {
    const auto ends = in.get<std::uint32_t>(group + "/ends");
    std::uint32_t last = 0;
    for (const auto e : ends) {
      if (e < last) in.fail("section '" + group + "/ends' is not ascending");
      last = e;
    }
    if (ends.size() != n || last != size) in.fail("section '" + group + "/ends' does not fit");
    return ends;
  };
  const auto unit = in.get<double>("graph/plain_unit");
  if (unit.size() != 1 || !(unit[0] > 0) || !std::isfinite(unit[0])) in.fail("the unit of plain lengths is not positive");
  body.graph.set_plain_unit(unit[0]);
  body.graph.resize(n);
  const auto to = in.get<std::uint32_t>("graph/to");
  const auto graph_ends = rows("graph", to.size());
  for (std::uint32_t i = 0; i < n; ++i)
    for (auto e = i ? graph_ends[i - 1] : 0; e < graph_ends[i]; ++e)
      if (to[e] >= n || to[e] <= i || !body.graph.add(body.nodes, NodeId(i), NodeId(to[e]))) in.fail("edge " + std::to_string(e) + " of the graph is out of range or there twice");
  const auto neighbor = in.get<std::uint32_t>("neighbors/to"), warped = in.get<std::uint32_t>("neighbors/warped");
  const auto distance = in.get<float>("neighbors/distance");
  const auto ends = rows("neighbors", neighbor.size());
  if (warped.size() != neighbor.size() || distance.size() != neighbor.size()) in.fail("the sections of neighbours have different lengths");
  body.neighbors.rows.resize(n);
  for (std::uint32_t i = 0; i < n; ++i)
    for (auto e = i ? ends[i - 1] : 0; e < ends[i]; ++e) {
      if (neighbor[e] >= n || warped[e] >= unit_radius || !(distance[e] >= 0) || !std::isfinite(distance[e])) in.fail("neighbour " + std::to_string(e) + " is out of range");
      body.neighbors.rows[i].push_back({NodeId(neighbor[e]), warped[e], distance[e]});
    }
  const auto ids = [&](const std::string& section, std::size_t size, std::size_t limit) {
    const auto values = in.get<std::uint32_t>(section);
    if (values.size() != size) in.fail("section '" + section + "' has another length than expected");
    for (const auto v : values)
      if (v != ~0u && v >= limit) in.fail("section '" + section + "' holds an id out of range");
    return values;
  };
  const std::size_t vertices = mesh.vertices.size();
  for (const auto v : ids("binding/master_node", vertices, n)) body.binding.master_node.push_back(NodeId(v));
  for (const auto v : ids("binding/master", vertices, vertices)) {
    if (v != ~0u && !body.binding.master_node[v].valid()) in.fail("a master has no node");
    body.binding.master.push_back(SurfaceVertexId(v));
  }
  for (const auto v : ids("binding/parent", vertices, vertices)) body.binding.parent.push_back(SurfaceVertexId(v));
  for (const auto v : ids("binding/closest", n, vertices)) body.binding.closest.push_back(SurfaceVertexId(v));
  const auto about_section = sections.find("about");
  const auto about = about_section == sections.end() ? nlohmann::json() : nlohmann::json::parse(about_section->second.bytes, nullptr, false);
  double cell = 0;
  try {
    body.k = whole<int>(about.at("k")), body.updates = whole<std::uint32_t>(about.at("updates"));
    body.resample_limit = about.at("resample_limit").get<double>(), cell = about.at("cell").get<double>();
    for (const auto& p : about.at("history"))
      body.history.push_back({p.at("tool").get<std::string>(), p.at("version").get<std::string>(), p.at("arguments").get<std::string>(), p.at("inputs").get<std::vector<std::string>>()});
  } catch (const nlohmann::json::exception&) {
    in.fail("section 'about' is malformed");
  } catch (const std::out_of_range&) {
    in.fail("section 'about' holds an impossible value");
  }
  if (body.k < 1 || body.k > 100000 || !(cell > 0) || !(cell <= largest_coordinate) || !(body.resample_limit >= 0)) in.fail("section 'about' holds an impossible value");
  body.grid = NodeGrid(cell, body.nodes.position);
  return body;
}

}  // namespace geo
