// The format of an image by its first bytes.
#pragma once

#include <string>
#include <string_view>

namespace geo {

/// The media type of an image, "image/png" for instance; empty: none of those that glTF knows.
inline std::string image_type(std::string_view bytes) {
  if (bytes.starts_with("\x89PNG")) return "image/png";
  if (bytes.starts_with("\xff\xd8")) return "image/jpeg";
  if (bytes.starts_with("\xabKTX 20")) return "image/ktx2";
  if (bytes.starts_with("RIFF") && bytes.substr(8, 4) == "WEBP") return "image/webp";
  return {};
}

}  // namespace geo
