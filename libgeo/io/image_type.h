// The format of an image by its first bytes, and whether its file is whole.
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

/// The reason why an image cannot be used: "is empty", "is cut off", "is damaged", "is no PNG or
/// JPEG"; empty where there is none. Chunks of a PNG are checked with their checksums (PNG
/// specification, § 5.3), a JPEG for its end; KTX2 and WebP are taken as they are.
std::string image_fault(std::string_view bytes);

}  // namespace geo
