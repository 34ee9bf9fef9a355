// write_graph_ply() and write_vtu() of kerf/export.h. PLY (binary, little-endian) with nodes as
// vertices; VTK XML (.vtu) with raw appended data.
#include <functional>

#include "io/graph_edges.h"
#include "io/kerf_writer.h"
#include "kerf/export.h"

namespace geo {
namespace {

template <class T>
void put(std::ostream& out, const T* values, std::size_t count) {
  out.write(reinterpret_cast<const char*>(values), static_cast<std::streamsize>(count * sizeof(T)));
}

// Gathers small values into blocks.
KerfSink into(std::ostream& out) {
  return KerfSink([&out](std::span<const std::byte> bytes) {
    out.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  });
}

}  // namespace

void write_graph_ply(std::ostream& out, const Body& body) {
  const NodeSet& nodes = body.nodes;
  std::vector<std::uint32_t> component;
  body.graph.components(component);
  out << "ply\nformat binary_little_endian 1.0\ncomment visibility graph by kerf\nelement vertex " << nodes.size()
      << '\n';
  for (const char* field : {"x", "y", "z", "radius", "spacing", "volume"}) out << "property double " << field << '\n';
  out << "property uchar debris\nproperty uint component\nelement edge " << body.graph.edge_count()
      << "\nproperty int vertex1\nproperty int vertex2\nend_header\n";
  KerfSink sink = into(out);
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    for (int k = 0; k < 3; ++k) sink.put(nodes.position[i][k]);
    for (const double x : {nodes.radius[i], nodes.spacing[i], nodes.volume[i]}) sink.put(x);
    sink.put(body.debris[i]);
    sink.put(component[i]);
  }
  each_edge(body, [&](std::uint32_t i, std::uint32_t j) {
    sink.put(i);
    sink.put(j);
  });
  sink.finish();
}

void write_vtu(std::ostream& out, const Body& body) {
  const NodeSet& nodes = body.nodes;
  const std::size_t n = nodes.size(), edges = body.graph.edge_count();
  std::vector<std::uint32_t> component;
  body.graph.components(component);
  struct Part {
    const char* type;
    const char* name;
    int columns;
    std::uint64_t bytes;
    std::function<void()> write;
  };
  const auto field = [&](const char* name, const std::vector<double>& values) {
    return Part{
        .type = "Float64", .name = name, .columns = 1, .bytes = 8 * n, .write = [&] { put(out, values.data(), n); }};
  };
  const auto position = [&] { put(out, nodes.position[0].data(), 3 * n); };
  const auto debris = [&] { put(out, body.debris.data(), n); };
  const auto component_of_nodes = [&] { put(out, component.data(), n); };
  const std::vector<Part> points{
      {.type = "Float64", .name = "Points", .columns = 3, .bytes = 24 * n, .write = position}};
  const std::vector<Part> fields{
      field("radius", nodes.radius),
      field("spacing", nodes.spacing),
      field("volume", nodes.volume),
      {.type = "UInt8", .name = "debris", .columns = 1, .bytes = n, .write = debris},
      {.type = "UInt32", .name = "component", .columns = 1, .bytes = 4 * n, .write = component_of_nodes}};
  const auto filled = [&](const auto& fill) {
    return [&out, fill] {
      KerfSink sink = into(out);
      fill(sink);
      sink.finish();
    };
  };
  const auto connectivity = filled([&](KerfSink& sink) {
    each_edge(body, [&](std::uint32_t i, std::uint32_t j) {
      sink.put(std::int64_t(i));
      sink.put(std::int64_t(j));
    });
  });
  const auto offsets = filled([&](KerfSink& sink) {
    for (std::size_t e = 1; e <= edges; ++e) sink.put(static_cast<std::int64_t>(2 * e));
  });
  const auto types = filled([&](KerfSink& sink) {
    for (std::size_t e = 0; e < edges; ++e) sink.put(std::uint8_t(3));  // lines
  });
  const std::vector<Part> cells{
      {.type = "Int64", .name = "connectivity", .columns = 1, .bytes = 16 * edges, .write = connectivity},
      {.type = "Int64", .name = "offsets", .columns = 1, .bytes = 8 * edges, .write = offsets},
      {.type = "UInt8", .name = "types", .columns = 1, .bytes = edges, .write = types}};
  out << "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" "
         "header_type=\"UInt64\">\n  <UnstructuredGrid>\n    <Piece NumberOfPoints=\""
      << n << "\" NumberOfCells=\"" << edges << "\">\n";
  std::uint64_t offset = 0;
  const auto declare = [&](const char* group, const std::vector<Part>& parts) {
    out << "      <" << group << ">\n";
    for (const auto& p : parts) {
      out << "        <DataArray type=\"" << p.type << "\" Name=\"" << p.name << "\" NumberOfComponents=\"" << p.columns
          << "\" format=\"appended\" offset=\"" << offset << "\"/>\n";
      offset += sizeof(std::uint64_t) + p.bytes;
    }
    out << "      </" << group << ">\n";
  };
  declare("PointData", fields);
  declare("Points", points);
  declare("Cells", cells);
  out << "    </Piece>\n  </UnstructuredGrid>\n  <AppendedData encoding=\"raw\">\n_";
  for (const auto* parts : {&fields, &points, &cells})
    for (const auto& p : *parts) {
      put(out, &p.bytes, 1);
      p.write();
    }
  out << "\n  </AppendedData>\n</VTKFile>\n";
}

}  // namespace geo
