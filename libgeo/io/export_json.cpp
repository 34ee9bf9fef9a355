// write_json() of kerf/export.h: the sections of a .kerf file as one JSON object. Arrays are
// streamed block by block, and numbers printed in the shortest form that reads back exactly
// (write_number()).
#include <cmath>
#include <nlohmann/json.hpp>

#include "base/number_text.h"
#include "io/kerf_layout.h"
#include "io/kerf_writer.h"
#include "io/shown.h"
#include "kerf/export.h"

namespace geo {
namespace {

// Numbers in the inner lists of an array, the longest lists first: rows are lists, lists of one
// number are not.
std::vector<std::uint64_t> list_sizes(const std::vector<std::uint64_t>& shape) {
  std::vector<std::uint64_t> sizes;
  std::uint64_t size = 1;
  for (std::size_t i = shape.size(); i-- > 1;)
    if ((size *= shape[i]) > 1) sizes.insert(sizes.begin(), size);
  return sizes;
}

template <class T>
void append_number(std::string& text, T x) {
  if constexpr (std::is_floating_point_v<T>)
    if (!std::isfinite(x)) {  // JSON has no such number
      text += "null";
      return;
    }
  char digits[32];
  text.append(digits, write_number(digits, x));
}

template <class T>
void write_rows(std::ostream& out, const KerfFile& file, const std::string& name,
                const std::vector<std::uint64_t>& shape) {
  const std::vector<std::uint64_t> lists = list_sizes(shape);
  std::uint64_t count = 0;
  std::string text = "[";
  KerfSink sink([&](std::span<const std::byte> block) {
    // No number lies in two blocks: kerf::hash_block is a multiple of 8, and an array ends with a
    // whole number.
    for (std::size_t at = 0; at < block.size(); at += sizeof(T)) {
      T x;
      std::memcpy(&x, block.data() + at, sizeof x);
      if (count > 0) text += ',';
      for (const auto size : lists)
        if (count % size == 0) text += '[';
      append_number(text, x);
      ++count;
      for (const auto size : lists)
        if (count % size == 0) text += ']';
    }
    out << text;
    text.clear();
  });
  file.stream(name, into(sink));
  sink.finish();
  out << text << ']';
}

}  // namespace

void write_json(std::ostream& out, const KerfFile& file) {
  const char* separator = "";
  out << '{';
  for (const auto& [name, s] : file.sections()) {
    if (kerf::size_of(s.dtype) == 0) continue;  // of a later version
    out << separator << nlohmann::json(name) << ':';
    separator = ",";
    if (s.dtype == "json") {
      const std::string text = file.text(name);
      if (!nlohmann::json::accept(text)) file.fail("section '" + shown(name) + "' is malformed");
      out << text;
    } else if (s.dtype == "f8") {
      write_rows<double>(out, file, name, s.shape);
    } else if (s.dtype == "f4") {
      write_rows<float>(out, file, name, s.shape);
    } else if (s.dtype == "u8") {
      write_rows<std::uint64_t>(out, file, name, s.shape);
    } else if (s.dtype == "u4") {
      write_rows<std::uint32_t>(out, file, name, s.shape);
    } else if (s.dtype == "i4") {
      write_rows<std::int32_t>(out, file, name, s.shape);
    } else if (s.dtype == "u2") {
      write_rows<std::uint16_t>(out, file, name, s.shape);
    } else {
      write_rows<std::uint8_t>(out, file, name, s.shape);
    }
    out << '\n';
  }
  out << "}\n";
}

}  // namespace geo
