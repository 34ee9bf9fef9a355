#include "kerf/body_file.h"

namespace geo {

void write_kerf(std::ostream& out, const KerfSections& sections) {
  std::vector<KerfArray> arrays;
  for (const auto& [name, s] : sections)
    arrays.push_back(
        {name, s.dtype, s.shape, [bytes = std::as_bytes(std::span(s.bytes))](KerfSink& sink) { sink.write(bytes); }});
  write_kerf(out, arrays);
}

KerfSections parse_kerf(std::string bytes, const std::string& name) {
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
