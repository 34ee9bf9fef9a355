// image_fault() of io/image_type.h: the structure of a file, without decoding it.
#include <cstdint>

#include "base/crc32.h"
#include "io/image_type.h"

namespace geo {
namespace {

// A number of four bytes, the highest first.
std::uint32_t number_at(std::string_view bytes, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < 4; ++i) value = value << 8 | static_cast<std::uint8_t>(bytes[at + i]);
  return value;
}

// A PNG is its signature and chunks up to IEND: length, type, data, checksum of type and data.
std::string png_fault(std::string_view bytes) {
  constexpr std::size_t signature = 8, around_data = 12;
  for (std::size_t at = signature; bytes.size() >= at && bytes.size() - at >= around_data;) {
    const std::size_t length = number_at(bytes, at);
    if (length > bytes.size() - at - around_data) break;
    const std::string_view chunk = bytes.substr(at + 4, 4 + length);
    if (number_at(bytes, at + 8 + length) != crc32(chunk)) return "is damaged";
    if (chunk.starts_with("IEND")) return {};
    at += around_data + length;
  }
  return "is cut off";
}

}  // namespace

std::string image_fault(std::string_view bytes) {
  const std::string type = image_type(bytes);
  if (bytes.empty()) return "is empty";
  if (type.empty()) return "is no PNG or JPEG";
  if (type == "image/png") return png_fault(bytes);
  // Some programs add bytes after the end of a JPEG. In its data FF is followed by 00, so that FFD9
  // is the end, of the image or of a preview before it: a preview alone passes.
  if (type == "image/jpeg" && bytes.rfind("\xff\xd9") == std::string_view::npos) return "is cut off";
  return {};
}

}  // namespace geo
