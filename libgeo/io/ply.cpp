#include <bit>
#include <cstdint>
#include <cstring>
#include <type_traits>

#include "io/line_reader.h"
#include "io/ply.h"

namespace geo {
namespace {

char type_of(std::string_view word) {
  static constexpr std::pair<std::string_view, char> types[] = {
      {"char", 'c'},   {"int8", 'c'},    {"uchar", 'C'},  {"uint8", 'C'},  {"short", 's'}, {"int16", 's'},
      {"ushort", 'S'}, {"uint16", 'S'},  {"int", 'i'},    {"int32", 'i'},  {"uint", 'I'},  {"uint32", 'I'},
      {"float", 'f'},  {"float32", 'f'}, {"double", 'd'}, {"float64", 'd'}};
  for (const auto& [name, type] : types)
    if (name == word) return type;
  return 0;
}

std::size_t size_of(char type) {
  return type == 'd' ? 8 : type == 'c' || type == 'C' ? 1 : type == 's' || type == 'S' ? 2 : 4;
}

template <class T>
double decode(const char* bytes, bool swap) {
  char raw[sizeof(T)];
  for (std::size_t i = 0; i < sizeof(T); ++i) raw[i] = bytes[swap ? sizeof(T) - 1 - i : i];
  T value;
  std::memcpy(&value, raw, sizeof(T));
  return static_cast<double>(value);
}

double decode(const char* bytes, char type, bool swap) {
  switch (type) {
    case 'c':
      return decode<std::int8_t>(bytes, swap);
    case 'C':
      return decode<std::uint8_t>(bytes, swap);
    case 's':
      return decode<std::int16_t>(bytes, swap);
    case 'S':
      return decode<std::uint16_t>(bytes, swap);
    case 'i':
      return decode<std::int32_t>(bytes, swap);
    case 'I':
      return decode<std::uint32_t>(bytes, swap);
    case 'f':
      return decode<float>(bytes, swap);
    default:
      return decode<double>(bytes, swap);
  }
}

// Numbers that stand at equal distances, `each` of them in a place; false where one is not finite.
template <class T>
bool fill(std::vector<double>& values, const char* first, std::size_t apart, std::size_t places, std::size_t each,
          bool swap) {
  values.resize(places * each);
  const auto read = [&](auto swapped) {
    bool finite = true;
    double* to = values.data();
    for (std::size_t i = 0; i < places; ++i)
      for (const char *from = first + i * apart, *end = from + each * sizeof(T); from != end; from += sizeof(T)) {
        *to = decode<T>(from, swapped);
        if constexpr (std::is_floating_point_v<T>) finite &= std::isfinite(*to);
        ++to;
      }
    return finite;
  };
  return swap ? read(std::true_type()) : read(std::false_type());
}

bool fill(PlyProperty& p, const char* first, std::size_t apart, std::size_t places, std::size_t each, bool swap) {
  switch (p.type) {
    case 'c':
      return fill<std::int8_t>(p.values, first, apart, places, each, swap);
    case 'C':
      return fill<std::uint8_t>(p.values, first, apart, places, each, swap);
    case 's':
      return fill<std::int16_t>(p.values, first, apart, places, each, swap);
    case 'S':
      return fill<std::uint16_t>(p.values, first, apart, places, each, swap);
    case 'i':
      return fill<std::int32_t>(p.values, first, apart, places, each, swap);
    case 'I':
      return fill<std::uint32_t>(p.values, first, apart, places, each, swap);
    case 'f':
      return fill<float>(p.values, first, apart, places, each, swap);
    default:
      return fill<double>(p.values, first, apart, places, each, swap);
  }
}

// Whether some bytes are the same in all places, at equal distances.
bool repeats(const char* first, std::size_t size, std::size_t apart, std::size_t places) {
  for (std::size_t i = 1; i < places; ++i)
    for (std::size_t k = 0; k < size; ++k)
      if (first[i * apart + k] != first[k]) return false;
  return true;
}

// Reads a binary element whose rows are all as long as the first, as they are in most files, a property at a time.
// False, with nothing read, where they are not or anything else is wrong.
bool read_even_rows(std::string_view bytes, bool swap, std::size_t& at, PlyElement& element) {
  std::string_view rest = bytes.substr(at);
  std::vector<std::size_t> first, each;  // of the numbers of a property in a row
  std::size_t row = 0;
  for (const PlyProperty& p : element.properties) {
    double count = 1;
    if (p.count_type != 0) {
      if (rest.size() < row + size_of(p.count_type)) return false;
      count = decode(rest.data() + row, p.count_type, swap), row += size_of(p.count_type);
      if (!(count >= 0 && count <= static_cast<double>(rest.size()))) return false;
    }
    first.push_back(row), each.push_back(static_cast<std::size_t>(count)), row += each.back() * size_of(p.type);
    if (row > rest.size()) return false;
  }
  if (row == 0 || rest.size() / row < element.count) return false;
  for (std::size_t k = 0; k < each.size(); ++k)
    if (const char type = element.properties[k].count_type; type != 0)
      if (const char* const count = rest.data() + first[k] - size_of(type);
          !repeats(count, size_of(type), row, element.count))
        return false;
  for (std::size_t k = 0; k < each.size(); ++k) {
    PlyProperty& p = element.properties[k];
    if (!fill(p, rest.data() + first[k], row, element.count, each[k], swap)) {
      for (PlyProperty& other : element.properties) other.values.clear(), other.ends.clear();
      return false;
    }
    if (p.count_type == 0) continue;
    p.ends.resize(element.count);
    for (std::size_t i = 0; i < element.count; ++i) p.ends[i] = static_cast<std::uint32_t>((i + 1) * each[k]);
  }
  at += row * element.count;
  return true;
}

}  // namespace

const PlyProperty* PlyElement::find(std::string_view property) const {
  for (const auto& p : properties)
    if (p.name == property) return &p;
  return nullptr;
}

const PlyElement* Ply::find(std::string_view element) const {
  for (const auto& e : elements)
    if (e.name == element) return &e;
  return nullptr;
}

Ply parse_ply(std::string_view bytes, const std::string& name) {
  static_assert(std::endian::native == std::endian::little);
  Ply ply;
  LineReader header(bytes, name, 0);
  std::vector<std::string_view> words;
  int format = -1;  // 0 ASCII, 1 little, 2 big
  bool ended = false;
  if (!header.next(words) || words[0] != "ply") throw InputError(name + ": does not begin with 'ply'");
  while (!ended && header.next(words)) {
    if (words[0] == "end_header") {
      ended = true;
    } else if (words[0] == "format" && words.size() >= 2) {
      format = words[1] == "ascii"                  ? 0
               : words[1] == "binary_little_endian" ? 1
               : words[1] == "binary_big_endian"    ? 2
                                                    : -1;
      if (format < 0) header.fail("unknown PLY format '" + shown(words[1]) + "'");
    } else if (words[0] == "comment" || words[0] == "obj_info") {
      std::string line;
      for (std::size_t i = 1; i < words.size(); ++i) line += (i > 1 ? " " : "") + std::string(words[i]);
      ply.comments.push_back(line);
    } else if (words[0] == "element" && words.size() == 3) {
      const auto count = header.integer(words[2]);
      // No row is smaller than a byte, so the file bounds every count before anything is allocated.
      if (count < 0 || static_cast<std::size_t>(count) > bytes.size())
        header.fail("the file is too short for " + shown(words[2]) + " rows of '" + shown(words[1]) +
                    "'; it is truncated or damaged");
      ply.elements.push_back({std::string(words[1]), static_cast<std::size_t>(count), {}});
    } else if (words[0] == "property" && !ply.elements.empty() &&
               (words.size() == 3 || (words.size() == 5 && words[1] == "list"))) {
      PlyProperty p;
      p.name = std::string(words.back());
      p.type = type_of(words[words.size() - 2]);
      if (words.size() == 5) p.count_type = type_of(words[2]);
      if (p.type == 0 || (words.size() == 5 && (p.count_type == 0 || p.count_type == 'f' || p.count_type == 'd')))
        header.fail("unknown property type");
      ply.elements.back().properties.push_back(std::move(p));
    } else {
      header.fail("'" + shown(words[0]) + "' is not expected in a PLY header");
    }
  }
  if (!ended || format < 0) throw InputError(name + ": the PLY header is not complete; the file is truncated");

  std::size_t at = header.position();
  LineReader rows(bytes.substr(at), name, 0);
  const auto truncated = [&](const std::string& element) -> void {
    throw InputError(name + ": ends within element '" + shown(element) + "'; the file is truncated");
  };
  for (auto& element : ply.elements) {
    if (element.properties.empty() && element.count > 0)
      throw InputError(name + ": element '" + shown(element.name) + "' has rows but no properties");
    if (format != 0 && element.count > 0 && read_even_rows(bytes, format == 2, at, element)) continue;
    for (std::size_t row = 0; row < element.count; ++row) {
      std::size_t word = 0;
      if (format == 0 && !rows.next(words)) truncated(element.name);
      const auto take = [&](char type) {
        double value = 0;
        if (format == 0) {
          if (word >= words.size()) rows.fail("too few numbers for a row of '" + shown(element.name) + "'");
          value = rows.real(words[word++]);
        } else {
          if (bytes.size() - at < size_of(type)) truncated(element.name);
          value = decode(bytes.data() + at, type, format == 2);
          at += size_of(type);
        }
        if (!std::isfinite(value))
          throw InputError(name + ": row " + std::to_string(row) + " of '" + shown(element.name) +
                           "' holds a value that is not a finite number; repair the file");
        return value;
      };
      for (auto& p : element.properties) {
        if (p.count_type == 0) {
          p.values.push_back(take(p.type));
          continue;
        }
        const double count = take(p.count_type);
        if (!(count >= 0) || count > static_cast<double>(bytes.size()) || count != std::floor(count))
          truncated(element.name);
        for (double i = 0; i < count; ++i) p.values.push_back(take(p.type));
        p.ends.push_back(static_cast<std::uint32_t>(p.values.size()));
      }
      if (format == 0 && word != words.size()) rows.fail("too many numbers for a row of '" + shown(element.name) + "'");
    }
  }
  if (format == 0 ? rows.next(words) : at != bytes.size())
    throw InputError(name + ": has bytes after its last element; the file is damaged");
  return ply;
}

}  // namespace geo
