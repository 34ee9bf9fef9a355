// Text of files in error messages.
#pragma once

#include <string>
#include <string_view>

namespace geo {

/// Text of a file as an error message shows it: at most `limit` bytes, without control characters.
inline std::string shown(std::string_view text, std::size_t limit = 60) {
  for (int i = 0; i < 3 && limit < text.size() && (text[limit] & 0xc0) == 0x80; ++i)
    --limit;  // not within a UTF-8 character
  std::string out(text.substr(0, limit));
  for (char& c : out)
    if (static_cast<unsigned char>(c) < 32 || c == 127) c = '?';
  return text.size() > limit ? out + "..." : out;
}

}  // namespace geo
