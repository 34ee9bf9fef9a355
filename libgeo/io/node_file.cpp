// Nodes of kerf/files.h. PLY, recognised by its first bytes, else PCD 0.7 (ASCII
// or binary; Point Cloud Library). A column of a PCD point may have single or double precision.
#include "kerf/files.h"

#include <array>
#include <cstring>

#include "io/line_reader.h"
#include "io/ply.h"
#include "kerf/body_file.h"

namespace geo {
namespace {

constexpr const char* fields[] = {"x", "y", "z", "radius", "spacing", "volume"};

NodeSet with_capacity(std::size_t count) {
  NodeSet nodes;
  nodes.position.reserve(count);
  nodes.radius.reserve(count);
  nodes.spacing.reserve(count);
  nodes.volume.reserve(count);
  return nodes;
}

void add(NodeSet& nodes, const double (&v)[6], const std::string& name) {
  const auto fail = [&](const char* what) {
    throw InputError(name + ": node " + std::to_string(nodes.size()) + " has a " + what);
  };
  for (const double x : v)
    if (!(std::abs(x) <= largest_coordinate))
      fail("value that is not a finite number of sensible size; repair the file");
  if (!(v[3] > 0) || !(v[4] > 0) || !(v[5] > 0)) fail("radius, spacing or volume that is not positive");
  nodes.position.push_back({v[0], v[1], v[2]});
  nodes.radius.push_back(v[3]);
  nodes.spacing.push_back(v[4]);
  nodes.volume.push_back(v[5]);
}

NodeSet from_ply(const std::string& bytes, const std::string& name) {
  const Ply ply = parse_ply(bytes, name);
  require_no_rest(ply, name);
  const auto* vertex = ply.find("vertex");
  if (!vertex) throw InputError(name + ": has no vertices");
  const PlyProperty* columns[6];
  for (int i = 0; i < 6; ++i) {
    columns[i] = vertex->find(fields[i]);
    if (!columns[i] || columns[i]->count_type)
      throw InputError(name + ": has no field '" + fields[i] + "'; nodes come from kerf-sample");
  }
  NodeSet nodes = with_capacity(vertex->count);
  for (std::size_t i = 0; i < vertex->count; ++i) {
    double v[6];
    for (int k = 0; k < 6; ++k) v[k] = columns[k]->values[i];
    add(nodes, v, name);
  }
  return nodes;
}

// The header of a PCD file.
struct PcdHeader {
  std::vector<std::string> names, sizes, types, counts;  // per field
  std::size_t points = 0;
  bool binary = false;
};

// Where the six columns of nodes are in a point.
struct PcdColumns {
  std::size_t word[6], offset[6];    // number of values, and of bytes, before the column
  bool single[6];                    // in single precision
  std::size_t words = 0, bytes = 0;  // of a point
};

PcdHeader read_pcd_header(LineReader& lines, const std::string& bytes, const std::string& name) {
  PcdHeader h;
  std::vector<std::string_view> words;
  long long width = -1, height = 1, points = -1;
  bool ended = false;
  while (!ended && lines.next(words)) {
    const auto rest = [&] { return std::vector<std::string>(words.begin() + 1, words.end()); };
    if (words[0] == "FIELDS")
      h.names = rest();
    else if (words[0] == "SIZE")
      h.sizes = rest();
    else if (words[0] == "TYPE")
      h.types = rest();
    else if (words[0] == "COUNT")
      h.counts = rest();
    else if (words[0] == "WIDTH" && words.size() == 2)
      width = lines.integer(words[1]);
    else if (words[0] == "HEIGHT" && words.size() == 2)
      height = lines.integer(words[1]);
    else if (words[0] == "POINTS" && words.size() == 2)
      points = lines.integer(words[1]);
    else if (words[0] == "DATA" && words.size() == 2) {
      if (words[1] != "ascii" && words[1] != "binary")
        lines.fail("PCD data '" + shown(words[1]) + "' is not read here; write ascii or binary");
      h.binary = words[1] == "binary";
      ended = true;
    } else if (words[0] != "VERSION" && words[0] != "VIEWPOINT")
      lines.fail("'" + shown(words[0]) + "' is not expected in a PCD header");
  }
  if (!ended) throw InputError(name + ": the PCD header is not complete; the file is truncated");
  if (h.names.empty() || h.sizes.size() != h.names.size() || h.types.size() != h.names.size() ||
      (!h.counts.empty() && h.counts.size() != h.names.size()))
    throw InputError(name + ": FIELDS, SIZE, TYPE and COUNT of the PCD header do not agree");
  if (points < 0) points = width * height;
  if (width < 0 || height < 0 || points != width * height || static_cast<std::size_t>(points) > bytes.size())
    throw InputError(name + ": the file is too short for " + std::to_string(points) +
                     " points; it is truncated or damaged");
  h.points = static_cast<std::size_t>(points);
  return h;
}

PcdColumns find_pcd_columns(const PcdHeader& h, const LineReader& lines, const std::string& name) {
  PcdColumns c;
  std::fill(std::begin(c.word), std::end(c.word), ~std::size_t(0));
  for (std::size_t i = 0; i < h.names.size(); ++i) {
    const auto size = lines.integer(h.sizes[i]), count = h.counts.empty() ? 1 : lines.integer(h.counts[i]);
    if ((size != 1 && size != 2 && size != 4 && size != 8) || count < 1 || count > 4096)
      throw InputError(name + ": the PCD header has a field of impossible size");
    for (int k = 0; k < 6; ++k)
      if (h.names[i] == fields[k]) {
        if (h.types[i] != "F" || (size != 4 && size != 8) || count != 1)
          throw InputError(name + ": field '" + h.names[i] + "' is not one floating-point number");
        c.word[k] = c.words;
        c.offset[k] = c.bytes;
        c.single[k] = size == 4;
      }
    c.bytes += static_cast<std::size_t>(size * count);
    c.words += static_cast<std::size_t>(count);
  }
  for (int k = 0; k < 6; ++k)
    if (c.word[k] == ~std::size_t(0))
      throw InputError(name + ": has no field '" + fields[k] + "'; nodes come from kerf-sample");
  return c;
}

void read_binary_points(std::string_view bytes, std::size_t points, const PcdColumns& c, const std::string& name,
                        NodeSet& nodes) {
  if (bytes.size() != c.bytes * points)
    throw InputError(name + ": holds " + std::to_string(bytes.size()) + " bytes of points instead of " +
                     std::to_string(c.bytes * points) + "; it is truncated or damaged");
  for (std::size_t i = 0; i < points; ++i) {
    double v[6];
    for (int k = 0; k < 6; ++k) {
      const char* p = bytes.data() + i * c.bytes + c.offset[k];
      if (c.single[k]) {
        float f;
        std::memcpy(&f, p, 4);
        v[k] = f;
      } else {
        std::memcpy(&v[k], p, 8);
      }
    }
    add(nodes, v, name);
  }
}

void read_ascii_points(std::string_view bytes, std::size_t points, const PcdColumns& c, const std::string& name,
                       NodeSet& nodes) {
  LineReader lines(bytes, name);
  std::vector<std::string_view> words;
  for (std::size_t i = 0; i < points; ++i) {
    if (!lines.next(words))
      throw InputError(name + ": ends after " + std::to_string(i) + " of " + std::to_string(points) +
                       " points; it is truncated");
    if (words.size() != c.words)
      lines.fail("a point has " + std::to_string(words.size()) + " numbers instead of " + std::to_string(c.words));
    double v[6];
    for (int k = 0; k < 6; ++k) v[k] = lines.real(words[c.word[k]]);
    add(nodes, v, name);
  }
  if (lines.next(words)) lines.fail("has lines after its last point");
}

NodeSet from_pcd(const std::string& bytes, const std::string& name) {
  LineReader lines(bytes, name);
  const PcdHeader header = read_pcd_header(lines, bytes, name);
  const PcdColumns columns = find_pcd_columns(header, lines, name);
  NodeSet nodes = with_capacity(header.points);  // bounded by the size of the file
  const auto rest = std::string_view(bytes).substr(lines.position());
  (header.binary ? read_binary_points : read_ascii_points)(rest, header.points, columns, name, nodes);
  return nodes;
}

void put_rows(std::ostream& out, const NodeSet& nodes) {
  constexpr std::size_t block = 4096;  // rows written at once
  std::vector<std::array<double, 6>> rows;
  for (std::size_t first = 0; first < nodes.size(); first += block) {
    rows.clear();
    for (std::size_t i = first; i < std::min(first + block, nodes.size()); ++i)
      rows.push_back({nodes.position[i].x(), nodes.position[i].y(), nodes.position[i].z(), nodes.radius[i],
                      nodes.spacing[i], nodes.volume[i]});
    out.write(reinterpret_cast<const char*>(rows.data()), static_cast<std::streamsize>(rows.size() * sizeof rows[0]));
  }
}

}  // namespace

NodeSet read_nodes(const std::string& path) { return parse_nodes(read_all(path), path); }

NodeSet parse_nodes(const std::string& bytes, const std::string& name) {
  if (looks_like_kerf(bytes))
    throw InputError(name + ": is a body (.kerf), which has its nodes already; give those of kerf-sample");
  NodeSet nodes = bytes.rfind("ply", 0) == 0 ? from_ply(bytes, name) : from_pcd(bytes, name);
  if (nodes.size() == 0) throw InputError(name + ": holds no nodes");
  return nodes;
}

void write_pcd(std::ostream& out, const NodeSet& nodes) {
  out << "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS x y z radius spacing volume\nSIZE 8 8 8 8 8 "
         "8\nTYPE F F F F F F\n"
      << "COUNT 1 1 1 1 1 1\nWIDTH " << nodes.size() << "\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " << nodes.size()
      << "\nDATA binary\n";
  put_rows(out, nodes);
}

void write_nodes_ply(std::ostream& out, const NodeSet& nodes) {
  out << "ply\nformat binary_little_endian 1.0\nelement vertex " << nodes.size() << '\n';
  for (const char* field : fields) out << "property double " << field << '\n';
  out << "end_header\n";
  put_rows(out, nodes);
}

}  // namespace geo
