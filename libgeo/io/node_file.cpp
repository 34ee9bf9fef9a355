#include "kerf/node_file.h"

#include <array>
#include <cstring>

#include "io/line_reader.h"
#include "io/ply.h"
#include "kerf/body_file.h"
#include "kerf/stream.h"

namespace geo {
namespace {

constexpr const char* fields[] = {"x", "y", "z", "radius", "spacing", "volume"};

NodeSet with_room(std::size_t count) {
  NodeSet nodes;
  nodes.position.reserve(count), nodes.radius.reserve(count), nodes.spacing.reserve(count), nodes.volume.reserve(count);
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
  const auto* vertex = ply.find("vertex");
  if (!vertex) throw InputError(name + ": has no vertices");
  const PlyProperty* columns[6];
  for (int i = 0; i < 6; ++i) {
    columns[i] = vertex->find(fields[i]);
    if (!columns[i] || columns[i]->count_type)
      throw InputError(name + ": has no field '" + fields[i] + "'; nodes come from kerf-sample");
  }
  NodeSet nodes = with_room(vertex->count);
  for (std::size_t i = 0; i < vertex->count; ++i) {
    double v[6];
    for (int k = 0; k < 6; ++k) v[k] = columns[k]->values[i];
    add(nodes, v, name);
  }
  return nodes;
}

NodeSet from_pcd(const std::string& bytes, const std::string& name) {
  LineReader header(bytes, name);
  std::vector<std::string_view> words;
  std::vector<std::string> names, sizes, types, counts;
  long long width = -1, height = 1, points = -1;
  int data = -1;
  while (data < 0 && header.next(words)) {
    const auto rest = [&] { return std::vector<std::string>(words.begin() + 1, words.end()); };
    if (words[0] == "FIELDS")
      names = rest();
    else if (words[0] == "SIZE")
      sizes = rest();
    else if (words[0] == "TYPE")
      types = rest();
    else if (words[0] == "COUNT")
      counts = rest();
    else if (words[0] == "WIDTH" && words.size() == 2)
      width = header.integer(words[1]);
    else if (words[0] == "HEIGHT" && words.size() == 2)
      height = header.integer(words[1]);
    else if (words[0] == "POINTS" && words.size() == 2)
      points = header.integer(words[1]);
    else if (words[0] == "DATA" && words.size() == 2) {
      data = words[1] == "ascii" ? 0 : words[1] == "binary" ? 1 : 2;
      if (data == 2) header.fail("PCD data '" + shown(words[1]) + "' is not read here; write ascii or binary");
    } else if (words[0] != "VERSION" && words[0] != "VIEWPOINT")
      header.fail("'" + shown(words[0]) + "' is not expected in a PCD header");
  }
  if (data < 0) throw InputError(name + ": the PCD header is not complete; the file is truncated");
  if (names.empty() || sizes.size() != names.size() || types.size() != names.size() ||
      (!counts.empty() && counts.size() != names.size()))
    throw InputError(name + ": FIELDS, SIZE, TYPE and COUNT of the PCD header do not agree");
  if (points < 0) points = width * height;
  if (width < 0 || height < 0 || points != width * height || static_cast<std::size_t>(points) > bytes.size())
    throw InputError(name + ": the file is too short for " + std::to_string(points) +
                     " points; it is truncated or damaged");
  std::size_t column[6], offset[6], stride = 0, total = 0;
  bool single[6];
  std::fill(std::begin(column), std::end(column), ~std::size_t(0));
  for (std::size_t i = 0; i < names.size(); ++i) {
    const auto size = header.integer(sizes[i]), count = counts.empty() ? 1 : header.integer(counts[i]);
    if ((size != 1 && size != 2 && size != 4 && size != 8) || count < 1 || count > 4096)
      throw InputError(name + ": the PCD header has a field of impossible size");
    for (int k = 0; k < 6; ++k)
      if (names[i] == fields[k]) {
        if (types[i] != "F" || (size != 4 && size != 8) || count != 1)
          throw InputError(name + ": field '" + names[i] + "' is not one floating-point number");
        column[k] = total, offset[k] = stride, single[k] = size == 4;
      }
    stride += static_cast<std::size_t>(size * count);
    total += static_cast<std::size_t>(count);
  }
  for (int k = 0; k < 6; ++k)
    if (column[k] == ~std::size_t(0))
      throw InputError(name + ": has no field '" + fields[k] + "'; nodes come from kerf-sample");
  NodeSet nodes = with_room(static_cast<std::size_t>(points));  // the file has a byte for each at least
  const std::size_t at = header.position();
  if (data == 1) {
    if (bytes.size() - at != stride * static_cast<std::size_t>(points))
      throw InputError(name + ": holds " + std::to_string(bytes.size() - at) + " bytes of points instead of " +
                       std::to_string(stride * static_cast<std::size_t>(points)) + "; it is truncated or damaged");
    for (long long i = 0; i < points; ++i) {
      double v[6];
      for (int k = 0; k < 6; ++k) {
        const char* p = bytes.data() + at + static_cast<std::size_t>(i) * stride + offset[k];
        if (single[k]) {
          float f;
          std::memcpy(&f, p, 4);
          v[k] = f;
        } else {
          std::memcpy(&v[k], p, 8);
        }
      }
      add(nodes, v, name);
    }
    return nodes;
  }
  LineReader rows(std::string_view(bytes).substr(at), name);
  for (long long i = 0; i < points; ++i) {
    if (!rows.next(words))
      throw InputError(name + ": ends after " + std::to_string(i) + " of " + std::to_string(points) +
                       " points; it is truncated");
    if (words.size() != total)
      rows.fail("a point has " + std::to_string(words.size()) + " numbers instead of " + std::to_string(total));
    double v[6];
    for (int k = 0; k < 6; ++k) v[k] = rows.real(words[column[k]]);
    add(nodes, v, name);
  }
  if (rows.next(words)) rows.fail("has lines after its last point");
  return nodes;
}

void put_rows(std::ostream& out, const NodeSet& nodes) {
  constexpr std::size_t share = 4096;  // rows in one go
  std::vector<std::array<double, 6>> rows;
  for (std::size_t first = 0; first < nodes.size(); first += share) {
    rows.clear();
    for (std::size_t i = first; i < std::min(first + share, nodes.size()); ++i)
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
