// Random damage to the bytes of a file.
#pragma once

#include <algorithm>
#include <cstring>
#include <limits>
#include <string>
#include <vector>

#include "base/random.h"

class Mutator {
 public:
  explicit Mutator(geo::Random& random) : random_(random) {}

  /// Makes one to four changes; `others` are files to splice with. At least one byte remains.
  std::string damaged(std::string bytes, const std::vector<std::string>& others) {
    const std::size_t most = 2 * bytes.size() + 4096;
    for (auto changes = 1 + random_.below(2) * random_.below(4); changes-- > 0;) {
      change(bytes, others);
      if (bytes.empty()) bytes = "\n";
      if (bytes.size() > most) bytes.resize(most);
    }
    return bytes;
  }

  /// Replaces one number in an array of numbers of `width` bytes, by another of them or an extreme
  /// one.
  void damage_number(std::string& s, std::size_t width) {
    const std::size_t rows = s.size() / width;
    if (rows == 0) return;
    const std::size_t to = width * below(rows), from = width * below(rows);
    if (random_.below(2))
      s.replace(to, width, s.substr(from, width));
    else
      put_number(s, to, width == 8 ? 0 : 2);
  }

 private:
  std::size_t below(std::size_t n) { return n == 0 ? 0 : random_.below(static_cast<std::uint32_t>(n)); }
  // Half of the changes hit the beginning, where sizes are.
  std::size_t place(const std::string& s) {
    return below(random_.below(2) ? std::min<std::size_t>(s.size(), 400) : s.size());
  }
  std::size_t length(std::size_t room) { return std::min(room, 1 + below(random_.below(4) ? 16 : 400)); }

  void change(std::string& s, const std::vector<std::string>& others) {
    const std::size_t at = place(s);
    switch (random_.below(14)) {
      case 0:
        s[at] = static_cast<char>(s[at] ^ 1 << random_.below(8));
        break;
      case 1:
        s[at] = static_cast<char>(random_.bits());
        break;
      case 2:
      case 3:
        put_number(s, at);
        break;
      case 4:
      case 5:
      case 6:
        write_number(s, at);
        break;
      case 7:
        s.erase(at, length(s.size() - at));
        break;
      case 8:
        s.insert(place(s), s.substr(at, length(s.size() - at)));
        break;
      case 9: {
        std::string noise(length(40), ' ');
        for (char& c : noise) c = static_cast<char>(random_.bits());
        s.insert(at, noise);
        break;
      }
      case 10:
        s.resize(random_.below(3) ? s.size() - length(s.size()) : at);
        break;
      case 11:
      case 12:
        change_lines(s);
        break;
      default: {
        const std::string& other = others[below(others.size())];
        s = s.substr(0, at) + other.substr(place(other));
      }
    }
  }

  // Overwrites bytes with an extreme number of random type and byte order.
  void put_number(std::string& s, std::size_t at) { put_number(s, at, random_.below(4)); }
  void put_number(std::string& s, std::size_t at, std::uint32_t type) {
    static constexpr double numbers[] = {
        0,    1,     -1,    2,      255,    2147483647.0, 2147483648.0, -2147483648.0, 4294967295.0,
        1e15, -1e15, 1e308, -1e308, 1e-308, 5e-324,       3e38,         1e100,         1e200};
    const double number = numbers[below(std::size(numbers))];
    char raw[8];
    std::size_t size = 8;
    switch (type) {
      case 0: {
        const double odd[] = {number, number, number, std::numeric_limits<double>::quiet_NaN(),
                              std::numeric_limits<double>::infinity()};
        std::memcpy(raw, &odd[below(5)], 8);
        break;
      }
      case 1: {
        const float odd[] = {static_cast<float>(std::clamp(number, -3e38, 3e38)),
                             std::numeric_limits<float>::quiet_NaN(), -std::numeric_limits<float>::infinity()};
        std::memcpy(raw, &odd[random_.below(3) ? 0 : below(3)], size = 4);
        break;
      }
      default: {
        const auto whole = static_cast<std::int64_t>(std::clamp(number, -9e18, 9e18));
        size = type == 2 ? 4 : std::size_t(1) << random_.below(4);
        std::memcpy(raw, &whole, 8);
      }
    }
    if (type > 2 && random_.below(3) == 0) std::reverse(raw, raw + size);
    for (std::size_t i = 0; i < size && at + i < s.size(); ++i) s[at + i] = raw[i];
  }

  // Replaces a word of text by an extreme number or another word.
  void write_number(std::string& s, std::size_t at) {
    static constexpr const char* words[] = {"0",
                                            "-1",
                                            "1",
                                            "3",
                                            "2147483647",
                                            "2147483648",
                                            "-2147483648",
                                            "4294967295",
                                            "4294967296",
                                            "9223372036854775807",
                                            "-9223372036854775808",
                                            "99999999999999999999999",
                                            "nan",
                                            "inf",
                                            "-inf",
                                            "1e308",
                                            "-1e308",
                                            "1e-308",
                                            "1e400",
                                            "0x10",
                                            "1e100",
                                            "1e-200",
                                            "5e-324",
                                            "",
                                            ".",
                                            "/",
                                            "1/2/3",
                                            "\"",
                                            "[",
                                            "]",
                                            "closed",
                                            "list",
                                            "true",
                                            "\t",
                                            "\x1b[31m",
                                            "\xff\xfe"};
    const auto in_word = [&](std::size_t i) { return i < s.size() && !std::strchr(" \t\r\n,[]=", s[i]); };
    while (at < s.size() && !in_word(at)) ++at;
    std::size_t end = at;
    while (in_word(end)) ++end;
    s.replace(at, end - at, words[below(std::size(words))]);
  }

  void change_lines(std::string& s) {
    std::vector<std::string> lines{""};
    for (const char c : s)
      if (lines.back().push_back(c); c == '\n') lines.emplace_back();
    const std::size_t a = below(lines.size()),
                      b = below(random_.below(2) ? std::min<std::size_t>(lines.size(), 12) : lines.size());
    switch (random_.below(3)) {
      case 0:
        std::swap(lines[a], lines[b]);
        break;
      case 1:
        lines.insert(lines.begin() + static_cast<std::ptrdiff_t>(a), lines[b]);
        break;
      default:
        lines.erase(lines.begin() + static_cast<std::ptrdiff_t>(b));
    }
    s.clear();
    for (const auto& line : lines) s += line;
  }

  geo::Random& random_;
};
