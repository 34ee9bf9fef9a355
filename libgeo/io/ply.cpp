// The header gives the layout. Binary elements whose rows have equal size are decoded column by
// column, all others number by number. All numbers become doubles. Text after the last number of a
// row is ignored.
#include <bit>
#include <cstdint>
#include <cstring>
#include <optional>
#include <type_traits>

#include "io/line_reader.h"
#include "io/ply.h"

namespace geo {
namespace {

char type_of(std::string_view word) {
  static constexpr std::pair<std::string_view, char> types[] = {
      {"char", 'c'},    {"int8", 'c'},   {"uchar", 'C'},  {"uint8", 'C'},   {"short", 's'},
      {"int16", 's'},   {"ushort", 'S'}, {"uint16", 'S'}, {"int", 'i'},     {"int32", 'i'},
      {"uint", 'I'},    {"uint32", 'I'}, {"float", 'f'},  {"float32", 'f'}, {"double", 'd'},
      {"float64", 'd'}, {"long", 'l'},   {"int64", 'l'},  {"ulong", 'L'},   {"uint64", 'L'}};
  for (const auto& [name, type] : types)
    if (name == word) return type;
  return 0;
}

std::size_t size_of(char type) {
  return type == 'd' || type == 'l' || type == 'L' ? 8
         : type == 'c' || type == 'C'              ? 1
         : type == 's' || type == 'S'              ? 2
                                                   : 4;
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
    case 'l':
      return decode<std::int64_t>(bytes, swap);
    case 'L':
      return decode<std::uint64_t>(bytes, swap);
    case 'f':
      return decode<float>(bytes, swap);
    default:
      return decode<double>(bytes, swap);
  }
}

// Reads `each` consecutive numbers at each of `places`, `apart` bytes from one to the next.
template <class T>
void fill(std::vector<double>& values, const char* first, std::size_t apart, std::size_t places, std::size_t each,
          bool swap) {
  values.resize(places * each);
  const auto read = [&](auto swapped) {
    double* to = values.data();
    for (std::size_t i = 0; i < places; ++i)
      for (const char *from = first + i * apart, *end = from + each * sizeof(T); from != end; from += sizeof(T))
        *to++ = decode<T>(from, swapped);
  };
  swap ? read(std::true_type()) : read(std::false_type());
}

void fill(PlyProperty& p, const char* first, std::size_t apart, std::size_t places, std::size_t each, bool swap) {
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
    case 'l':
      return fill<std::int64_t>(p.values, first, apart, places, each, swap);
    case 'L':
      return fill<std::uint64_t>(p.values, first, apart, places, each, swap);
    case 'f':
      return fill<float>(p.values, first, apart, places, each, swap);
    default:
      return fill<double>(p.values, first, apart, places, each, swap);
  }
}

// True where `size` bytes are the same at all places, `apart` bytes from one to the next.
bool repeats(const char* first, std::size_t size, std::size_t apart, std::size_t places) {
  for (std::size_t i = 1; i < places; ++i)
    for (std::size_t k = 0; k < size; ++k)
      if (first[i * apart + k] != first[k]) return false;
  return true;
}

// Reads a binary element whose rows have equal lengths, property by property: the common case, and
// much faster. False, with nothing read, for any other element.
bool read_even_rows(std::string_view bytes, bool swap, std::size_t& at, PlyElement& element) {
  std::string_view rest = bytes.substr(at);
  std::vector<std::size_t> first, each;  // of the numbers of a property in a row
  std::size_t row = 0;
  for (const PlyProperty& p : element.properties) {
    double count = 1;
    if (p.count_type != 0) {
      if (rest.size() < row + size_of(p.count_type)) return false;
      count = decode(rest.data() + row, p.count_type, swap);
      row += size_of(p.count_type);
      if (!(count >= 0 && count <= static_cast<double>(rest.size()))) return false;
    }
    first.push_back(row);
    each.push_back(static_cast<std::size_t>(count));
    row += each.back() * size_of(p.type);
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
    fill(p, rest.data() + first[k], row, element.count, each[k], swap);
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

namespace {

enum class PlyFormat { ascii, little_endian, big_endian };

// The character that ends the lines of the header: the first one, as binary rows may hold the
// other.
char header_end(std::string_view bytes) {
  const auto at = bytes.find_first_of("\r\n");
  const bool only_return = at != bytes.npos && bytes[at] == '\r' && bytes.substr(at + 1, 1) != "\n";
  return only_return ? '\r' : '\n';
}

PlyFormat format_of(const LineReader& lines, std::string_view word) {
  if (word == "ascii") return PlyFormat::ascii;
  if (word == "binary_little_endian") return PlyFormat::little_endian;
  if (word == "binary_big_endian") return PlyFormat::big_endian;
  lines.fail("unknown PLY format '" + shown(word) + "'");
}

PlyProperty property_of(const LineReader& lines, const std::vector<std::string_view>& words) {
  const bool list = words.size() == 5;
  PlyProperty p;
  p.name = std::string(words.back());
  p.type = type_of(words[words.size() - 2]);
  if (list) p.count_type = type_of(words[2]);
  if (p.type == 0 || (list && (p.count_type == 0 || p.count_type == 'f' || p.count_type == 'd')))
    lines.fail("unknown property type");
  return p;
}

// Reads the header: elements with their properties, without values.
PlyFormat read_header(LineReader& lines, std::string_view bytes, const std::string& name, Ply& ply) {
  std::vector<std::string_view> words;
  std::optional<PlyFormat> format;
  bool ended = false;
  if (!lines.next(words) || words[0] != "ply") throw InputError(name + ": does not begin with 'ply'");
  while (!ended && lines.next(words)) {
    if (words[0] == "end_header") {
      ended = true;
    } else if (words[0] == "format" && words.size() >= 2) {
      format = format_of(lines, words[1]);
    } else if (words[0] == "comment" || words[0] == "obj_info") {
      std::string line;
      for (std::size_t i = 1; i < words.size(); ++i) line += (i > 1 ? " " : "") + std::string(words[i]);
      ply.comments.push_back(line);
    } else if (words[0] == "element" && words.size() == 3) {
      const auto count = lines.integer(words[2]);
      // A row has at least one byte, so the file bounds every count before memory is allocated.
      if (count < 0 || static_cast<std::size_t>(count) > bytes.size())
        lines.fail("the file is too short for " + shown(words[2]) + " rows of '" + shown(words[1]) +
                   "'; it is truncated or damaged");
      ply.elements.push_back({std::string(words[1]), static_cast<std::size_t>(count), {}});
    } else if (words[0] == "property" && !ply.elements.empty() &&
               (words.size() == 3 || (words.size() == 5 && words[1] == "list"))) {
      ply.elements.back().properties.push_back(property_of(lines, words));
    } else if (!ply.elements.empty() || words[0] == "format" || words[0] == "element" || words[0] == "property") {
      lines.fail("'" + shown(words[0]) + "' is not expected in a PLY header");
    }  // else a comment without its keyword, as Blender 2.4 wrote it; there are no columns yet to mistake
  }
  if (!ended || !format) throw InputError(name + ": the PLY header is not complete; the file is truncated");
  return *format;
}

// Reads rows number by number, from text or bytes.
class RowReader {
 public:
  RowReader(std::string_view bytes, std::size_t at, PlyFormat format, const std::string& name)
      : bytes_(bytes), at_(at), format_(format), name_(name), lines_(bytes.substr(at), name, 0) {}

  void read(PlyElement& element) {
    if (ascii() || element.count == 0 || !read_even_rows(bytes_, format_ == PlyFormat::big_endian, at_, element))
      for (std::size_t row = 0; row < element.count; ++row) read_row(element);
  }
  // True where bytes or lines are left. Line ends behind binary rows are nothing.
  bool more() {
    return ascii() ? lines_.next(words_) : bytes_.substr(at_).find_first_not_of("\r\n") != std::string_view::npos;
  }

 private:
  bool ascii() const { return format_ == PlyFormat::ascii; }
  [[noreturn]] void truncated(const PlyElement& element) const {
    throw InputError(name_ + ": ends within element '" + shown(element.name) + "'; the file is truncated");
  }
  double next(char type, const PlyElement& element) {
    double value = 0;
    if (ascii()) {
      if (word_ >= words_.size()) lines_.fail("too few numbers for a row of '" + shown(element.name) + "'");
      value = lines_.any_real(words_[word_++]);
    } else {
      if (bytes_.size() - at_ < size_of(type)) truncated(element);
      value = decode(bytes_.data() + at_, type, format_ == PlyFormat::big_endian);
      at_ += size_of(type);
    }
    return value;
  }
  // The next line that is no comment: some programs write comments between the rows.
  bool next_line() {
    do
      if (!lines_.next(words_)) return false;
    while (words_[0] == "comment" || words_[0] == "obj_info");
    return true;
  }
  void read_row(PlyElement& element) {
    word_ = 0;
    if (ascii() && !next_line()) truncated(element);
    for (auto& p : element.properties) {
      if (p.count_type == 0) {
        p.values.push_back(next(p.type, element));
        continue;
      }
      const double count = next(p.count_type, element);
      if (!(count >= 0) || count > static_cast<double>(bytes_.size()) || count != std::floor(count)) truncated(element);
      for (double i = 0; i < count; ++i) p.values.push_back(next(p.type, element));
      p.ends.push_back(static_cast<std::uint32_t>(p.values.size()));
    }
  }

  std::string_view bytes_;
  std::size_t at_;
  PlyFormat format_;
  const std::string& name_;
  LineReader lines_;
  std::vector<std::string_view> words_;
  std::size_t word_ = 0;
};

}  // namespace

Ply parse_ply(std::string_view bytes, const std::string& name) {
  static_assert(std::endian::native == std::endian::little);
  Ply ply;
  LineReader header(bytes, name, 0, 0, header_end(bytes));
  const PlyFormat format = read_header(header, bytes, name, ply);
  RowReader rows(bytes, header.position(), format, name);
  for (auto& element : ply.elements) {
    if (element.properties.empty() && element.count > 0)
      throw InputError(name + ": element '" + shown(element.name) + "' has rows but no properties");
    rows.read(element);
  }
  ply.has_rest = rows.more();
  return ply;
}

void require_no_rest(const Ply& ply, const std::string& name) {
  if (ply.has_rest) throw InputError(name + ": has bytes after its last element; the file is damaged");
}

}  // namespace geo
