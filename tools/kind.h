// The kind of a file, recognised by its content.
#pragma once

#include <string>

#include <kerf/body_file.h>

namespace tool {

enum class Kind { body, nodes, fronts, surface };

/// Ignores comments and blank lines at the beginning. An OBJ file with polylines only holds fronts,
/// one with faces a surface. Where the content leaves it open, files named .front hold fronts.
inline Kind kind_of(const std::string& bytes, const std::string& name) {
  if (geo::looks_like_kerf(bytes)) return Kind::body;
  const auto begins = [&](const char* word, std::size_t at = 0) {
    return bytes.compare(at, std::string(word).size(), word) == 0;
  };
  const std::string header = bytes.substr(0, 4096);
  // A binary file of another program, whose bytes may look like any line.
  if (!begins("ply") && !begins("# .PCD") && header.find('\0') != std::string::npos) return Kind::surface;
  if (begins("# .PCD") || begins("VERSION") || begins("FIELDS"))
    return header.find("radius") != std::string::npos ? Kind::nodes : Kind::surface;
  if (begins("ply")) {
    const bool radius = header.find("property double radius") != std::string::npos ||
                        header.find("property float radius") != std::string::npos;
    return radius ? Kind::nodes : Kind::surface;
  }
  bool lines = false, faces = false;
  for (std::size_t at = 0, end = 0; at < bytes.size() && !faces; at = end + 1) {
    end = std::min(bytes.find('\n', at), bytes.size());
    at = bytes.find_first_not_of(" \t\r", at);
    if (at >= end || bytes[at] == '#') continue;
    if (begins("front ", at) || begins("front\t", at) || begins("sheet ", at) || begins("sheet\t", at))
      return Kind::fronts;
    if (begins("OFF", at) || begins("COFF", at) || begins("solid", at)) return Kind::surface;
    lines = lines || begins("l ", at);
    faces = begins("f ", at);
  }
  if (faces) return Kind::surface;
  return lines || name.ends_with(".front") ? Kind::fronts : Kind::surface;
}

}  // namespace tool
