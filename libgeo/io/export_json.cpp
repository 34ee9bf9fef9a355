// Sections are streamed block by block and printed in the shortest form that reads back exactly
// (std::to_chars).
#include <charconv>
#include <nlohmann/json.hpp>

#include "io/kerf_layout.h"
#include "io/kerf_writer.h"
#include "io/line_reader.h"
#include "kerf/export.h"

namespace geo {
namespace {

template <class T>
void write_rows(std::ostream& out, const KerfFile& file, const std::string& name, std::uint64_t columns) {
  std::uint64_t count = 0;
  std::string text = "[";
  KerfSink sink([&](std::span<const std::byte> block) {
    // No number lies in two blocks: their size is a multiple of every type's.
    for (std::size_t at = 0; at < block.size(); at += sizeof(T), ++count) {
      T x;
      std::memcpy(&x, block.data() + at, sizeof x);
      if (count > 0) text += ',';
      if (columns > 1 && count % columns == 0) text += '[';
      char digits[32];
      text.append(digits, std::to_chars(digits, digits + sizeof digits, x).ptr);
      if (columns > 1 && count % columns == columns - 1) text += ']';
    }
    out << text;
    text.clear();
  });
  file.stream(name, sink);
  sink.finish();
  out << text << ']';
}

}  // namespace

void write_json(std::ostream& out, const KerfFile& file) {
  char separator = '{';
  for (const auto& [name, s] : file.sections()) {
    if (kerf::size_of(s.dtype) == 0) continue;
    out << separator << nlohmann::json(name) << ':';
    separator = ',';
    const std::uint64_t columns = s.shape.size() > 1 ? s.shape[1] : 1;
    if (s.dtype == "json") {
      const std::string text = file.text(name);
      if (!nlohmann::json::accept(text)) file.fail("section '" + shown(name) + "' is malformed");
      out << text;
    } else if (s.dtype == "f8") {
      write_rows<double>(out, file, name, columns);
    } else if (s.dtype == "f4") {
      write_rows<float>(out, file, name, columns);
    } else if (s.dtype == "u8") {
      write_rows<std::uint64_t>(out, file, name, columns);
    } else if (s.dtype == "u4") {
      write_rows<std::uint32_t>(out, file, name, columns);
    } else if (s.dtype == "i4") {
      write_rows<std::int32_t>(out, file, name, columns);
    } else if (s.dtype == "u2") {
      write_rows<std::uint16_t>(out, file, name, columns);
    } else {
      write_rows<std::uint8_t>(out, file, name, columns);
    }
    out << '\n';
  }
  out << "}\n";
}

}  // namespace geo
