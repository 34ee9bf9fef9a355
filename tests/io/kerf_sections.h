// Small `.kerf` files in memory: sections by name, as strings of bytes.
#pragma once

#include <cstdint>
#include <map>
#include <ostream>
#include <string>
#include <vector>

#include "io/kerf_writer.h"
#include "kerf/body_file.h"

namespace geo {

struct KerfSection {
  std::string dtype;
  std::vector<std::uint64_t> shape;
  std::string bytes;  ///< raw, little-endian
};
using KerfSections = std::map<std::string, KerfSection>;

inline void write_kerf(std::ostream& out, const KerfSections& sections) {
  std::vector<KerfArray> arrays;
  for (const auto& [name, s] : sections)
    arrays.push_back(
        {name, s.dtype, s.shape, [bytes = std::as_bytes(std::span(s.bytes))](KerfSink& sink) { sink.write(bytes); }});
  write_kerf(out, arrays);
}

inline KerfSections parse_kerf(std::string bytes, const std::string& name) {
  const KerfFile file(Input(std::move(bytes), name));
  KerfSections sections;
  for (const auto& [key, s] : file.sections()) {
    std::string values(s.bytes, '\0');
    file.read(key, std::as_writable_bytes(std::span(values)));
    sections[key] = {s.dtype, s.shape, std::move(values)};
  }
  return sections;
}

}  // namespace geo
