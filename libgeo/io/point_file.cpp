// Scans of kerf/files.h. PLY without faces; PCD 0.7 (ASCII, binary, compressed); text with a point
// on each line.
#include <algorithm>
#include <array>
#include <cstring>
#include <filesystem>
#include <map>

#include "base/bit_cast.h"
#include "io/line_reader.h"
#include "io/ply.h"
#include "kerf/files.h"

namespace geo {
namespace {

using Column = std::vector<double>;
using Columns = std::map<std::string, Column>;  // of a file, by the names of their fields

const Column* find_column(const Columns& columns, std::initializer_list<const char*> names) {
  for (const char* name : names)
    if (const auto at = columns.find(name); at != columns.end()) return &at->second;
  return nullptr;
}

// The cloud that some columns hold. Points that are not finite are left out, and so are normals and
// colours that not all other points have.
PointCloud cloud_of(const Columns& columns, const std::string& name, bool byte_colors) {
  const std::array<const Column*, 3> at{find_column(columns, {"x"}), find_column(columns, {"y"}),
                                        find_column(columns, {"z"})};
  if (!at[0] || !at[1] || !at[2]) throw InputError(name + ": has no fields x, y and z; give a scan");
  if (columns.contains("radius") && columns.contains("spacing") && columns.contains("volume"))
    throw InputError(name + ": is a file of nodes; give the surface that they were made of");
  const std::array<const Column*, 3> normal{find_column(columns, {"nx", "normal_x"}),
                                            find_column(columns, {"ny", "normal_y"}),
                                            find_column(columns, {"nz", "normal_z"})};
  const std::array<const Column*, 3> color{find_column(columns, {"red", "r", "diffuse_red"}),
                                           find_column(columns, {"green", "g", "diffuse_green"}),
                                           find_column(columns, {"blue", "b", "diffuse_blue"})};
  // Programs that know no normals write zeros.
  const auto holds = [](const Column* column) {
    return column && std::any_of(column->begin(), column->end(), [](double x) { return x != 0; });
  };
  const bool normals =
      normal[0] && normal[1] && normal[2] && (holds(normal[0]) || holds(normal[1]) || holds(normal[2]));
  const bool colors = color[0] && color[1] && color[2];
  PointCloud cloud;
  for (std::size_t i = 0; i < at[0]->size(); ++i) {
    const Vec3 p((*at[0])[i], (*at[1])[i], (*at[2])[i]);
    Vec3 n = Vec3::Zero();
    if (normals) n = Vec3((*normal[0])[i], (*normal[1])[i], (*normal[2])[i]).stableNormalized();
    if (!in_range(p) || (normals && (!n.allFinite() || n.isZero()))) {
      ++cloud.left_out;
      continue;
    }
    cloud.position.push_back(p);
    if (normals) cloud.normal.push_back(n);
    if (!colors) continue;
    const double full = byte_colors ? 255 : 1;
    Color c((*color[0])[i] / full, (*color[1])[i] / full, (*color[2])[i] / full, 1);
    cloud.color.push_back(c.allFinite() ? Color(c.array().max(0).min(1)) : Color(Color::Ones()));
  }
  return cloud;
}

PointCloud cloud_of_ply(const std::string& bytes, const std::string& name) {
  const Ply ply = parse_ply(bytes, name);
  const PlyElement* vertex = ply.find("vertex");
  if (!vertex) throw InputError(name + ": has no vertices; give a scan");
  Columns columns;
  bool byte_colors = true;
  for (const PlyProperty& property : vertex->properties) {
    if (property.count_type) continue;
    if (property.name == "red") byte_colors = property.type != 'f' && property.type != 'd';
    columns[property.name] = property.values;
  }
  return cloud_of(columns, name, byte_colors);
}

// ---- PCD

struct PcdField {
  std::string name;
  std::size_t size = 4, count = 1;
  char type = 'F';
};

struct PcdScan {
  std::vector<PcdField> fields;
  std::size_t points = 0;
  std::string data;
  std::size_t begin = 0;  // of the data
};

std::size_t pcd_count(const LineReader& lines, const std::string& word, std::size_t max) {
  const long long n = lines.integer(word);
  if (n < 0 || static_cast<unsigned long long>(n) > max) lines.fail("'" + shown(word) + "' is out of range");
  return static_cast<std::size_t>(n);
}

void read_field_line(const LineReader& lines, const std::string& key, const std::vector<std::string>& rest,
                     PcdScan& scan) {
  if (key == "FIELDS") {
    for (const std::string& field : rest) scan.fields.push_back({.name = field, .size = 4, .count = 1, .type = 'F'});
    return;
  }
  if (rest.size() != scan.fields.size()) lines.fail(key + " does not agree with FIELDS");
  for (std::size_t i = 0; i < rest.size(); ++i) {
    if (key == "SIZE") scan.fields[i].size = pcd_count(lines, rest[i], 8);
    if (key == "COUNT") scan.fields[i].count = pcd_count(lines, rest[i], 10000);
    if (key == "TYPE") scan.fields[i].type = rest[i][0];
  }
}

PcdScan pcd_header(const std::string& bytes, const std::string& name) {
  PcdScan scan;
  LineReader lines(bytes, name);
  std::vector<std::string_view> words;
  std::size_t width = 0, height = 1;
  while (scan.data.empty() && lines.next(words)) {
    const std::string key(words[0]);
    const std::vector<std::string> rest(words.begin() + 1, words.end());
    if (key == "FIELDS" || key == "SIZE" || key == "TYPE" || key == "COUNT") read_field_line(lines, key, rest, scan);
    if (rest.size() != 1) continue;
    if (key == "WIDTH") width = pcd_count(lines, rest[0], bytes.size());
    if (key == "HEIGHT") height = pcd_count(lines, rest[0], bytes.size());
    if (key == "DATA") scan.data = rest[0];
  }
  scan.begin = lines.position();
  if (scan.data.empty() || scan.fields.empty())
    throw InputError(name + ": the PCD header is not complete; the file is truncated");
  // Each point takes a byte at least, or a compressed share of one.
  constexpr std::size_t max_compression = 300;
  if (height > 0 && width > max_compression * bytes.size() / height)
    throw InputError(name + ": the file is too short for its number of points; it is truncated");
  scan.points = width * height;
  return scan;
}

double pcd_number(const char* at, char type, std::size_t size, const std::string& name) {
  const auto as = [&]<class T>(T value) {
    std::memcpy(&value, at, sizeof value);
    return static_cast<double>(value);
  };
  if (type == 'F' && size == 4) return as(float());
  if (type == 'F' && size == 8) return as(double());
  if (type == 'U' && size == 1) return as(std::uint8_t());
  if (type == 'U' && size == 2) return as(std::uint16_t());
  if (type == 'U' && size == 4) return as(std::uint32_t());
  if (type == 'I' && size == 1) return as(std::int8_t());
  if (type == 'I' && size == 2) return as(std::int16_t());
  if (type == 'I' && size == 4) return as(std::int32_t());
  if (size == 8) return type == 'I' ? as(std::int64_t()) : as(std::uint64_t());
  throw InputError(name + ": has a PCD field of an unknown type; write floats");
}

// LZF, the compression of PCD: runs of bytes, and copies of bytes that came before. Empty where the
// bytes are damaged.
std::string from_lzf(std::string_view in, std::size_t size) {
  std::string out;
  out.reserve(size);
  std::size_t i = 0;
  const auto next = [&] { return i < in.size() ? static_cast<unsigned char>(in[i++]) : 0u; };
  while (i < in.size()) {
    const std::size_t control = next();
    if (control < 32) {
      out += in.substr(i, control + 1);
      i += control + 1;
    } else {
      std::size_t length = control >> 5;
      if (length == 7) length += next();
      const std::size_t back = ((control & 31) << 8 | next()) + 1;
      if (back > out.size() || out.size() + length + 2 > size) return {};
      for (std::size_t k = 0; k < length + 2; ++k) out += out[out.size() - back];
    }
  }
  return out.size() == size ? out : std::string();
}

// Colours in one field: red, green and blue as bytes of an integer, which a float may hold.
void unpack_colors(Columns& columns, const std::vector<PcdField>& fields) {
  for (const PcdField& field : fields) {
    if ((field.name != "rgb" && field.name != "rgba") || !columns.contains(field.name)) continue;
    const Column packed = columns.at(field.name);
    for (const double value : packed) {
      const auto bits = field.type == 'F' ? bit_cast<std::uint32_t>(static_cast<float>(value))
                                          : static_cast<std::uint32_t>(std::clamp(value, 0.0, 4294967295.0));
      columns["red"].push_back(bits >> 16 & 255);
      columns["green"].push_back(bits >> 8 & 255);
      columns["blue"].push_back(bits & 255);
    }
  }
}

Columns pcd_text(const std::string& bytes, const PcdScan& scan, const std::string& name) {
  Columns columns;
  LineReader lines(bytes, name, 0);
  for (std::vector<std::string_view> header; lines.position() < scan.begin && lines.next(header);) {
  }
  std::vector<std::string_view> words;
  for (std::size_t i = 0; i < scan.points; ++i) {
    if (!lines.next(words)) throw InputError(name + ": ends before its last point; the file is truncated");
    std::size_t at = 0;
    for (const PcdField& field : scan.fields) {
      if (at + field.count > words.size()) lines.fail("a point has too few numbers");
      if (field.count == 1) columns[field.name].push_back(lines.any_real(words[at]));
      at += field.count;
    }
  }
  return columns;
}

// `by_field`: all values of a field stand together, as compressed files have them.
Columns pcd_binary(std::string_view data, const PcdScan& scan, bool by_field, const std::string& name) {
  Columns columns;
  std::size_t row = 0;
  for (const PcdField& field : scan.fields) row += field.size * field.count;
  if (row == 0 || data.size() / row < scan.points)
    throw InputError(name + ": ends before its last point; the file is truncated");
  std::size_t offset = 0;
  for (const PcdField& field : scan.fields) {
    const std::size_t bytes = field.size * field.count;
    if (field.count == 1 && field.name != "_") {
      Column& column = columns[field.name];
      for (std::size_t i = 0; i < scan.points; ++i)
        column.push_back(pcd_number(data.data() + (by_field ? offset * scan.points + i * bytes : i * row + offset),
                                    field.type, field.size, name));
    }
    offset += bytes;
  }
  return columns;
}

PointCloud cloud_of_pcd(const std::string& bytes, const std::string& name) {
  const PcdScan scan = pcd_header(bytes, name);
  const std::string_view data = std::string_view(bytes).substr(scan.begin);
  Columns columns;
  if (scan.data == "ascii") {
    columns = pcd_text(bytes, scan, name);
  } else if (scan.data == "binary") {
    columns = pcd_binary(data, scan, false, name);
  } else if (scan.data == "binary_compressed" && data.size() >= 8) {
    std::array<std::uint32_t, 2> sizes{};
    std::memcpy(sizes.data(), data.data(), 8);
    const std::string all = from_lzf(data.substr(8, sizes[0]), sizes[1]);
    if (all.empty() && scan.points > 0) throw InputError(name + ": its compressed data are damaged; write them again");
    columns = pcd_binary(all, scan, true, name);
  } else {
    throw InputError(name + ": has PCD data '" + shown(scan.data) + "'; write ascii or binary");
  }
  unpack_colors(columns, scan.fields);
  return cloud_of(columns, name, true);
}

// ---- Text

// Columns 3 to 5 of six hold colours where all are integers from 0 to 255 and one exceeds 1.
bool are_colors(const std::vector<Column>& columns, std::size_t first) {
  double largest = 0;
  for (std::size_t k = first; k < first + 3; ++k)
    for (const double x : columns[k]) {
      if (x < 0 || x > 255 || x != std::floor(x)) return false;
      largest = std::max(largest, x);
    }
  return largest > 1;
}

void name_columns(std::vector<Column>& columns, std::size_t first, Columns& named) {
  const bool colors = are_colors(columns, first);
  for (std::size_t k = 0; k < 3; ++k)
    named[std::string(colors ? "rgb" : "xyz").substr(k, 1).insert(0, colors ? "" : "n")] =
        std::move(columns[first + k]);
}

PointCloud from_text(const std::string& bytes, const std::string& name) {
  std::string text = bytes;
  std::replace(text.begin(), text.end(), ',', ' ');
  std::replace(text.begin(), text.end(), ';', ' ');
  LineReader lines(text, name);
  std::vector<Column> columns;
  for (std::vector<std::string_view> words; lines.next(words);) {
    if (columns.empty() && words.size() < 3) continue;  // a number of points
    if (columns.empty()) columns.resize(std::min<std::size_t>(words.size(), 9));
    if (words.size() < columns.size())
      lines.fail("a point has " + std::to_string(words.size()) + " numbers, not " + std::to_string(columns.size()));
    for (std::size_t k = 0; k < columns.size(); ++k) columns[k].push_back(lines.any_real(words[k]));
  }
  if (columns.empty()) throw InputError(name + ": has no points; give a scan");
  Columns named;
  const std::size_t width = columns.size();
  // Seven numbers: an intensity stands before the colours.
  if (width == 6 || width == 9) name_columns(columns, 3, named);
  if (width == 7) name_columns(columns, 4, named);
  if (width == 9) name_columns(columns, 6, named);
  for (std::size_t k = 0; k < 3; ++k) named[std::string(1, static_cast<char>('x' + k))] = std::move(columns[k]);
  return cloud_of(named, name, true);
}

bool looks_like_pcd(const std::string& bytes) {
  const std::string_view head = std::string_view(bytes).substr(0, 4096);
  return head.find("FIELDS ") != head.npos && head.find("DATA ") != head.npos &&
         (head.starts_with("#") || head.starts_with("VERSION") || head.starts_with("FIELDS"));
}

}  // namespace

bool holds_points(const std::string& bytes, const std::string& name) {
  if (looks_like_pcd(bytes)) return true;
  if (bytes.starts_with("ply")) {
    const std::string_view head = std::string_view(bytes).substr(0, bytes.find("end_header"));
    return head.find("element face") == head.npos && head.find("element tristrips") == head.npos;
  }
  std::string ending = std::filesystem::path(name).extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return ending == ".xyz" || ending == ".pwn" || ending == ".pts" || ending == ".asc" || ending == ".csv";
}

PointCloud parse_points(const std::string& bytes, const std::string& name) {
  if (looks_like_pcd(bytes)) return cloud_of_pcd(bytes, name);
  return bytes.starts_with("ply") ? cloud_of_ply(bytes, name) : from_text(bytes, name);
}

PointCloud read_points(const std::string& path) { return parse_points(read_all(path), path); }

}  // namespace geo
