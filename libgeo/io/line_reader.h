// Reading text formats: lines, words and numbers, with the line number in every error.
#pragma once

#include <charconv>
#include <cmath>
#include <string>
#include <string_view>
#include <vector>

#include "io/shown.h"
#include "kerf/error.h"

namespace geo {

/// Iterates over the lines of a text, without empty ones and comments.
class LineReader {
 public:
  /// `comment`: begins a comment up to the end of the line; 0: none does. `text` must outlive the
  /// reader.
  LineReader(std::string_view text, std::string name, char comment = '#')
      : text_(text), name_(std::move(name)), comment_(comment) {}

  /// Splits the next line that is not empty into words; false at the end.
  bool next(std::vector<std::string_view>& words) {
    while (at_ < text_.size()) {
      const auto end = std::min(text_.find('\n', at_), text_.size());
      std::string_view line = text_.substr(at_, end - at_);
      at_ = end + 1;
      ++number_;
      if (comment_) line = line.substr(0, line.find(comment_));
      words.clear();
      for (std::size_t i = 0; i < line.size();) {
        if (line[i] == ' ' || line[i] == '\t' || line[i] == '\r') {
          ++i;
          continue;
        }
        std::size_t j = i;
        while (j < line.size() && line[j] != ' ' && line[j] != '\t' && line[j] != '\r') ++j;
        words.push_back(line.substr(i, j - i));
        i = j;
      }
      if (!words.empty()) return true;
    }
    return false;
  }
  /// Throws InputError: name, line number, `what`.
  [[noreturn]] void fail(const std::string& what) const {
    throw InputError(name_ + ":" + std::to_string(number_) + ": " + what);
  }
  /// Bytes up to the end of the current line.
  std::size_t position() const { return std::min(at_, text_.size()); }

  /// A finite number. Throws InputError.
  double real(std::string_view word) const {
    double value = 0;
    const char* begin = word.data() + (!word.empty() && word[0] == '+');
    const auto [end, error] = std::from_chars(begin, word.data() + word.size(), value);
    if (error != std::errc() || end != word.data() + word.size()) fail("'" + shown(word) + "' is not a number");
    if (!std::isfinite(value)) fail("'" + shown(word) + "' is not a finite number; repair the file");
    return value;
  }
  /// An integer. Throws InputError.
  long long integer(std::string_view word) const {
    long long value = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (error != std::errc() || end != word.data() + word.size()) fail("'" + shown(word) + "' is not an integer");
    return value;
  }

 private:
  std::string_view text_;
  std::string name_;
  char comment_;
  std::size_t at_ = 0, number_ = 0;
};

}  // namespace geo
