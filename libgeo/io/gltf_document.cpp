// io/gltf_document.h, after the specification of glTF 2.0 (sections 3.6 and 4.4). Every size is
// compared with the bytes that there are before memory is allocated.
#include "io/gltf_document.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include "io/shown.h"
#include "kerf/error.h"
#include "kerf/files.h"

namespace geo {
namespace {

// Extensions with which a file is read rightly. Those of materials, lights and physics change no
// shape.
constexpr std::string_view known_extensions[] = {"KHR_mesh_quantization",
                                                 "EXT_mesh_gpu_instancing",
                                                 "KHR_node_visibility",
                                                 "KHR_texture_transform",
                                                 "KHR_texture_basisu",
                                                 "EXT_texture_webp",
                                                 "EXT_texture_avif",
                                                 "MSFT_texture_dds",
                                                 "KHR_lights_punctual",
                                                 "EXT_lights_image_based",
                                                 "EXT_lights_ies",
                                                 "KHR_animation_pointer",
                                                 "KHR_xmp",
                                                 "KHR_xmp_json_ld",
                                                 "KHR_audio",
                                                 "KHR_implicit_shapes",
                                                 "KHR_physics_rigid_bodies",
                                                 "OMI_physics_body",
                                                 "OMI_physics_shape",
                                                 "OMI_physics_joint",
                                                 "OMI_collider",
                                                 "MSFT_lod"};

// Extensions that compress, which a file may use with uncompressed data beside.
constexpr std::string_view compressions[] = {"KHR_draco_mesh_compression", "EXT_meshopt_compression",
                                             "KHR_meshopt_compression"};

bool is_in(const auto& list, std::string_view name) {
  return std::find(std::begin(list), std::end(list), name) != std::end(list);
}

bool is_known(std::string_view extension) {
  return extension.starts_with("KHR_materials_") || extension.starts_with("EXT_materials_") ||
         is_in(known_extensions, extension);
}

const GltfDocument::Json no_member;  // stands for members that are missing

std::uint32_t word_at(std::string_view bytes, std::size_t at) {
  std::uint32_t word = 0;
  std::memcpy(&word, bytes.data() + at, sizeof word);
  return word;
}

std::size_t bytes_of_component(std::size_t type) {
  switch (type) {
    case 5120:
    case 5121:
      return 1;
    case 5122:
    case 5123:
      return 2;
    case 5125:
    case 5126:
      return 4;
    default:
      return 0;
  }
}

std::size_t components_of(const std::string& type) {
  static constexpr std::pair<std::string_view, std::size_t> types[] = {
      {"SCALAR", 1}, {"VEC2", 2}, {"VEC3", 3}, {"VEC4", 4}, {"MAT4", 16}};
  for (const auto& [name, count] : types)
    if (name == type) return count;
  return 0;
}

template <class T>
T value_at(const char* bytes) {
  T value;
  std::memcpy(&value, bytes, sizeof value);
  return value;
}

// A number of an accessor. Normalised integers follow section 3.6.2.2: c / 255, max(c / 127, −1)
// and so on.
double number_at(const char* bytes, std::size_t type, bool normalized) {
  switch (type) {
    case 5120: {
      const double c = value_at<std::int8_t>(bytes);
      return normalized ? std::max(c / 127, -1.0) : c;
    }
    case 5121: {
      const double c = value_at<std::uint8_t>(bytes);
      return normalized ? c / 255 : c;
    }
    case 5122: {
      const double c = value_at<std::int16_t>(bytes);
      return normalized ? std::max(c / 32767, -1.0) : c;
    }
    case 5123: {
      const double c = value_at<std::uint16_t>(bytes);
      return normalized ? c / 65535 : c;
    }
    case 5125:
      return value_at<std::uint32_t>(bytes);
    default:
      return value_at<float>(bytes);
  }
}

// Bytes of base64 text (RFC 4648); false for any other text.
bool from_base64(std::string_view text, std::string& bytes) {
  std::uint32_t bits = 0;
  int held = 0;
  while (!text.empty() && text.back() == '=') text.remove_suffix(1);
  for (const char c : text) {
    int digit = -1;
    if (c >= 'A' && c <= 'Z') digit = c - 'A';
    if (c >= 'a' && c <= 'z') digit = c - 'a' + 26;
    if (c >= '0' && c <= '9') digit = c - '0' + 52;
    if (c == '+' || c == '-') digit = 62;
    if (c == '/' || c == '_') digit = 63;
    if (digit < 0) return false;
    bits = bits << 6 | static_cast<std::uint32_t>(digit);
    held += 6;
    if (held < 8) continue;
    held -= 8;
    bytes += static_cast<char>(bits >> held & 0xff);
  }
  return true;
}

// A URI's text with %20 and the like as characters.
std::string unescaped(const std::string& uri) {
  const auto digit = [](char c) {
    if (c >= '0' && c <= '9') return c - '0';
    if (c >= 'a' && c <= 'f') return c - 'a' + 10;
    return c >= 'A' && c <= 'F' ? c - 'A' + 10 : -1;
  };
  std::string text;
  for (std::size_t i = 0; i < uri.size(); ++i) {
    if (uri[i] == '%' && i + 2 < uri.size() && digit(uri[i + 1]) >= 0 && digit(uri[i + 2]) >= 0) {
      text += static_cast<char>(16 * digit(uri[i + 1]) + digit(uri[i + 2]));
      i += 2;
    } else {
      text += uri[i];
    }
  }
  return text;
}

}  // namespace

GltfDocument::GltfDocument(const std::string& bytes, const std::string& name) : name_(name), file_size_(bytes.size()) {
  read_container(bytes);
  const std::string version = text(member(json_, "asset"), "version");
  if (!version.starts_with("2.")) fail("is a glTF file of version '" + shown(version) + "'; save it as glTF 2.0");
  check_extensions();
}

void GltfDocument::fail(const std::string& what) const { throw InputError(name_ + ": " + what); }

void GltfDocument::read_container(const std::string& bytes) {
  std::string_view text = bytes;
  if (bytes.starts_with("glTF")) {
    constexpr std::size_t head = 12, chunk_head = 8;
    constexpr std::uint32_t json_chunk = 0x4e4f534a, binary_chunk = 0x004e4942;  // "JSON" and "BIN" in ASCII
    if (bytes.size() < head + chunk_head) fail("is a glTF file that is truncated");
    if (word_at(bytes, 4) != 2)
      fail("is a glTF file of version " + std::to_string(word_at(bytes, 4)) + "; save it as glTF 2.0");
    if (word_at(bytes, 8) > bytes.size()) fail("is a glTF file that is truncated");
    const std::size_t end = std::max<std::size_t>(word_at(bytes, 8), head + chunk_head);
    text = {};
    bool first = true;
    for (std::size_t at = head; at + chunk_head <= end;) {
      const std::size_t length = word_at(bytes, at);
      const std::uint32_t kind = word_at(bytes, at + 4);
      at += chunk_head;
      if (length > end - at) fail("is a glTF file that is truncated or damaged");
      const std::string_view chunk = std::string_view(bytes).substr(at, length);
      if (first && kind != json_chunk) fail("is a glTF file without JSON; it is damaged");
      if (first) text = chunk;
      if (!first && kind == binary_chunk && !has_binary_) {
        binary_ = chunk;
        has_binary_ = true;
      }
      first = false;
      at += length;
    }
  }
  while (text.ends_with('\0')) text.remove_suffix(1);  // padding of some programs
  constexpr int deepest = 200;  // levels: copies and texts of JSON need stack for each, and files have about ten
  const auto limit = [&](int depth, Json::parse_event_t, Json&) {
    if (depth > deepest) fail("is a glTF file whose JSON is nested too deep");
    return true;
  };
  json_ = Json::parse(text, limit, false);
  if (!json_.is_object()) fail("is a glTF file whose JSON is damaged");
}

void GltfDocument::check_extensions() {
  const auto names = [&](const char* key) {
    std::vector<std::string> list;
    const Json& given = member(json_, key);
    if (given.is_array())
      for (const Json& name : given)
        if (name.is_string()) list.push_back(name.get<std::string>());
    return list;
  };
  for (const std::string& extension : names("extensionsRequired")) {
    if (is_known(extension)) continue;
    const std::string compressed = is_in(compressions, extension)
                                       ? "which compresses it and is not read here; save it without compression"
                                       : "which is not read here; save it without that extension";
    fail("requires the glTF extension " + shown(extension) + ", " + compressed);
  }
  for (const std::string& extension : names("extensionsUsed"))
    if (!is_known(extension) && !is_in(compressions, extension)) unknown_.push_back(shown(extension));
}

const GltfDocument::Json& GltfDocument::member(const Json& object, const char* key) {
  if (!object.is_object()) return no_member;
  const auto at = object.find(key);
  return at == object.end() ? no_member : *at;
}

const GltfDocument::Json& GltfDocument::extension(const Json& object, const char* name) {
  return member(member(object, "extensions"), name);
}

std::size_t GltfDocument::count(const char* list) const {
  const Json& entries = member(json_, list);
  return entries.is_array() ? entries.size() : 0;
}

const GltfDocument::Json& GltfDocument::entry(const char* list, std::size_t index) const {
  if (index >= count(list))
    fail("names entry " + std::to_string(index) + " of its '" + list + "', but there are " +
         std::to_string(count(list)));
  return member(json_, list)[index];
}

std::optional<std::size_t> GltfDocument::index(const Json& object, const char* key) const {
  const Json& value = member(object, key);
  if (value.is_null()) return {};
  if (!value.is_number_integer() || value.get<std::int64_t>() < 0)
    fail("its '" + std::string(key) + "' is not a whole number from 0 on");
  return static_cast<std::size_t>(value.get<std::int64_t>());
}

std::size_t GltfDocument::size(const Json& object, const char* key, std::size_t fallback) const {
  return index(object, key).value_or(fallback);
}

std::vector<std::size_t> GltfDocument::indices(const Json& object, const char* key) const {
  const Json& list = member(object, key);
  std::vector<std::size_t> result;
  if (list.is_null()) return result;
  if (!list.is_array()) fail("its '" + std::string(key) + "' is not a list");
  for (const Json& value : list) {
    if (!value.is_number_integer() || value.get<std::int64_t>() < 0)
      fail("its '" + std::string(key) + "' has an entry that is not a whole number from 0 on");
    result.push_back(static_cast<std::size_t>(value.get<std::int64_t>()));
  }
  return result;
}

std::vector<double> GltfDocument::numbers(const Json& object, const char* key, std::size_t count) const {
  const Json& list = member(object, key);
  std::vector<double> result;
  if (list.is_null()) return result;
  if (!list.is_array() || list.size() != count)
    fail("its '" + std::string(key) + "' is not a list of " + std::to_string(count) + " numbers");
  for (const Json& value : list) {
    if (!value.is_number()) fail("its '" + std::string(key) + "' has an entry that is no number");
    result.push_back(value.get<double>());
  }
  return result;
}

std::string GltfDocument::text(const Json& object, const char* key) {
  const Json& value = member(object, key);
  return value.is_string() ? value.get<std::string>() : std::string();
}

std::string GltfDocument::at_uri(const std::string& uri) const {
  if (uri.starts_with("data:")) {
    const auto comma = uri.find(',');
    std::string bytes;
    if (comma == uri.npos || uri.substr(0, comma).find(";base64") == uri.npos ||
        !from_base64(std::string_view(uri).substr(comma + 1), bytes))
      fail("has a 'data:' URI that is not base64");
    return bytes;
  }
  const std::string file = unescaped(uri);
  const std::filesystem::path folder = std::filesystem::path(name_).parent_path();
  const std::filesystem::path inside = std::filesystem::path(file).lexically_normal();
  if (inside.empty() || inside.is_absolute() || *inside.begin() == ".." || file.find("://") != file.npos)
    fail("names '" + shown(file, 200) + "', which is not in its folder; put it beside the file, or save as .glb");
  std::error_code failed;
  if (!std::filesystem::is_regular_file(folder / inside, failed))
    fail("names '" + shown(file, 200) + "', which is not there; put it beside the file, or save as .glb");
  try {
    return read_all((folder / inside).string());
  } catch (const InputError& error) {
    fail("names '" + shown(file, 200) + "', which cannot be read (" + error.what() + ")");
  }
}

std::string_view GltfDocument::buffer(std::size_t index) {
  const Json& description = entry("buffers", index);
  const std::string uri = text(description, "uri");
  if (uri.empty()) {
    for (const char* name : {"EXT_meshopt_compression", "KHR_meshopt_compression"})
      if (!extension(description, name).is_null())
        fail(std::string("holds its data with the glTF extension ") + name +
             " alone, which is not read here; save it without compression");
    if (index != 0 || !has_binary_) fail("has no bytes for buffer " + std::to_string(index) + "; it is incomplete");
    return binary_;
  }
  const auto [at, fresh] = buffers_.try_emplace(index);
  if (fresh) at->second = at_uri(uri);
  return at->second;
}

std::string_view GltfDocument::view(std::size_t buffer_view) {
  const Json& description = entry("bufferViews", buffer_view);
  const auto which = index(description, "buffer");
  if (!which) fail("buffer view " + std::to_string(buffer_view) + " names no buffer");
  const std::string_view bytes = buffer(*which);
  const std::size_t offset = size(description, "byteOffset", 0), length = size(description, "byteLength", 0);
  if (offset > bytes.size() || length > bytes.size() - offset)
    fail("buffer view " + std::to_string(buffer_view) + " exceeds its buffer; the file is truncated or damaged");
  return bytes.substr(offset, length);
}

void GltfDocument::decode(std::string_view from, std::size_t stride, const Json& accessor, GltfRows& rows) const {
  const std::size_t type = size(accessor, "componentType", 0);
  const std::size_t each = bytes_of_component(type), row = each * rows.width;
  const bool normalized = member(accessor, "normalized") == true;
  if (stride == 0) stride = row;
  if (stride < row) fail("has a buffer view whose byteStride is less than a row of its accessor");
  // The last row needs no bytes behind it.
  if (rows.count > 0 && (from.size() < row || (from.size() - row) / stride < rows.count - 1))
    fail("has an accessor that exceeds its buffer view; the file is truncated or damaged");
  for (std::size_t i = 0; i < rows.count; ++i)
    for (std::size_t k = 0; k < rows.width; ++k)
      rows.values[i * rows.width + k] = number_at(from.data() + i * stride + k * each, type, normalized);
}

void GltfDocument::replace_sparse(const Json& sparse, const Json& accessor, GltfRows& rows) {
  GltfRows at{{}, 1, size(sparse, "count", 0)}, values{{}, rows.width, at.count};
  if (at.count > rows.count) fail("has a sparse accessor with more rows than the accessor");
  const Json &places = member(sparse, "indices"), &given = member(sparse, "values");
  const auto part = [&](const Json& description) {
    const auto which = index(description, "bufferView");
    if (!which) fail("has a sparse accessor without a buffer view");
    const std::string_view bytes = view(*which);
    return bytes.substr(std::min(size(description, "byteOffset", 0), bytes.size()));
  };
  if (bytes_of_component(size(places, "componentType", 0)) == 0 || size(places, "componentType", 0) == 5126)
    fail("has a sparse accessor whose indices are of an unknown type");
  at.values.resize(at.count);
  values.values.resize(values.count * values.width);
  decode(part(places), 0, places, at);
  decode(part(given), 0, accessor, values);
  for (std::size_t i = 0; i < at.count; ++i) {
    if (!(at.values[i] < static_cast<double>(rows.count))) fail("has a sparse accessor with an index out of range");
    std::copy_n(values.row(i), rows.width, rows.values.data() + static_cast<std::size_t>(at.values[i]) * rows.width);
  }
}

GltfRows GltfDocument::read_rows(std::size_t which) {
  const Json& accessor = entry("accessors", which);
  GltfRows rows{{}, components_of(text(accessor, "type")), size(accessor, "count", 0)};
  if (rows.width == 0 || bytes_of_component(size(accessor, "componentType", 0)) == 0)
    fail("accessor " + std::to_string(which) + " has an unknown type");
  const auto buffer_view = index(accessor, "bufferView");
  const Json& sparse = member(accessor, "sparse");
  std::string_view bytes;
  if (buffer_view) {
    bytes = view(*buffer_view);
    bytes = bytes.substr(std::min(size(accessor, "byteOffset", 0), bytes.size()));
  }
  // Without a buffer view all numbers are zero, so that no byte bounds their number.
  if (rows.count > (buffer_view ? bytes.size() : file_size_))
    fail("accessor " + std::to_string(which) + " exceeds its buffer view; the file is truncated or damaged");
  rows.values.resize(rows.count * rows.width);
  if (buffer_view) decode(bytes, size(entry("bufferViews", *buffer_view), "byteStride", 0), accessor, rows);
  if (!sparse.is_null()) replace_sparse(sparse, accessor, rows);
  return rows;
}

const GltfRows& GltfDocument::rows(std::size_t accessor) {
  const auto at = rows_.find(accessor);
  return at != rows_.end() ? at->second : rows_.emplace(accessor, read_rows(accessor)).first->second;
}

}  // namespace geo
