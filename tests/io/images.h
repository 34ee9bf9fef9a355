// Image files that are whole, but hold no picture: enough for what reads their structure.
#pragma once

#include <string>

#include "base/crc32.h"

/// A chunk of a PNG (specification, § 5.3).
inline std::string png_chunk(const std::string& type, const std::string& data) {
  const auto number = [](std::uint32_t value) {
    std::string bytes;
    for (int shift = 24; shift >= 0; shift -= 8) bytes += static_cast<char>(value >> shift & 255);
    return bytes;
  };
  return number(static_cast<std::uint32_t>(data.size())) + type + data + number(geo::crc32(type + data));
}

/// A PNG of this type of colours, 0 grey, 2 red green blue, with some words in a chunk of text.
inline std::string whole_png(char colors, const std::string& words) {
  std::string header(13, '\0');
  header[9] = colors;
  return "\x89PNG\r\n\x1a\n" + png_chunk("IHDR", header) + png_chunk("tEXt", words) + png_chunk("IEND", "");
}

/// A JPEG with some words between its first and its last marker.
inline std::string whole_jpeg(const std::string& words) { return "\xff\xd8" + words + "\xff\xd9"; }
