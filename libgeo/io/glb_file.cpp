// io/glb_file.h. A .glb is a header, a JSON chunk and a binary chunk.
#include "io/glb_file.h"

#include <algorithm>

#include "kerf/error.h"

namespace geo {

std::size_t GlbFile::view(const void* values, std::size_t bytes, int target) {
  const std::size_t offset = bytes_.size();
  bytes_.append(static_cast<const char*>(values), bytes);
  bytes_.resize((bytes_.size() + 3) / 4 * 4);
  json["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", offset}, {"byteLength", bytes}, {"target", target}});
  return json["bufferViews"].size() - 1;
}

std::size_t GlbFile::bytes(const std::string& content) {
  const std::size_t at = view(content.data(), content.size(), 0);
  json["bufferViews"][at].erase("target");
  return at;
}

std::size_t GlbFile::positions(const std::vector<float>& values) {
  const std::size_t at = accessor(values, 5126, "VEC3", values.size() / 3);
  std::array<float, 3> lo{values[0], values[1], values[2]}, hi = lo;
  for (std::size_t i = 0; i < values.size(); ++i) {
    lo[i % 3] = std::min(lo[i % 3], values[i]);
    hi[i % 3] = std::max(hi[i % 3], values[i]);
  }
  json["accessors"][at]["min"] = lo;
  json["accessors"][at]["max"] = hi;
  return at;
}

std::size_t GlbFile::indices(const std::vector<std::uint32_t>& values) {
  json["accessors"].push_back({{"bufferView", view(values.data(), values.size() * sizeof(std::uint32_t), 34963)},
                               {"componentType", 5125},
                               {"count", values.size()},
                               {"type", "SCALAR"}});
  return json["accessors"].size() - 1;
}

std::size_t GlbFile::node(Json description) {
  json["nodes"].push_back(std::move(description));
  return json["nodes"].size() - 1;
}

std::size_t GlbFile::mesh(Json primitives, const std::string& name) {
  json["meshes"].push_back({{"name", name}, {"primitives", std::move(primitives)}});
  return json["meshes"].size() - 1;
}

void GlbFile::write(std::ostream& out) {
  if (!bytes_.empty()) json["buffers"] = Json::array({Json{{"byteLength", bytes_.size()}}});
  std::string text = json.dump(-1, ' ', false, Json::error_handler_t::replace);
  text.resize((text.size() + 3) / 4 * 4, ' ');
  const std::uint64_t total = 12 + 8 + text.size() + (bytes_.empty() ? 0 : 8 + bytes_.size());
  if (total > 0xffffffffu) throw OutputError("pieces of more than 4 GB do not fit into a .glb; write a folder");
  const auto put = [&](std::uint64_t x) {
    const auto word = static_cast<std::uint32_t>(x);
    out.write(reinterpret_cast<const char*>(&word), 4);
  };
  // Magic words in ASCII: "glTF", "JSON" and "BIN".
  put(0x46546c67);
  put(2);
  put(total);
  put(text.size());
  put(0x4e4f534a);
  out << text;
  if (bytes_.empty()) return;
  put(bytes_.size());
  put(0x004e4942);
  out << bytes_;
}

}  // namespace geo
