// Reading text formats: lines, words and numbers, with the line number in every error.
#pragma once

#include <charconv>
#include <cmath>
#include <string>
#include <string_view>
#include <vector>

#include "base/number_text.h"
#include "io/shown.h"
#include "kerf/error.h"

namespace geo {

/// Iterates over the lines of a text, without empty ones and comments. Lines end with a line feed;
/// in a text without one, with a carriage return.
class LineReader {
 public:
  /// `comment`: begins a comment up to the end of the line; 0: none does. `continuation`: at the
  /// end of a line, joins the next line to it; 0: nothing does. `end`: ends a line; 0: as above.
  /// `text` must outlive the reader.
  LineReader(std::string_view text, std::string name, char comment = '#', char continuation = 0, char end = 0)
      : text_(text),
        name_(std::move(name)),
        comment_(comment),
        continuation_(continuation),
        end_(end != 0                                    ? end
             : text.find('\n') == std::string_view::npos ? '\r'
                                                         : '\n') {}

  /// Splits the next line that is not empty into words; false at the end.
  bool next(std::vector<std::string_view>& words) {
    words.clear();
    while (at_ < text_.size()) {
      const auto end = std::min(text_.find(end_, at_), text_.size());
      std::string_view line = text_.substr(at_, end - at_);
      at_ = end + 1;
      ++number_;
      if (comment_) line = line.substr(0, line.find(comment_));
      if (!split(line, words) && !words.empty()) return true;
    }
    return !words.empty();
  }
  /// Number of the current line, from 1.
  std::size_t number() const { return number_; }
  /// Throws InputError: name, line number, `what`.
  [[noreturn]] void fail(const std::string& what) const {
    throw InputError(name_ + ":" + std::to_string(number_) + ": " + what);
  }
  /// Bytes up to the end of the current line.
  std::size_t position() const { return std::min(at_, text_.size()); }

  /// A number, which may be infinite or not a number. Throws InputError.
  double any_real(std::string_view word) const {
    double value = 0;
    const char* begin = word.data() + (!word.empty() && word[0] == '+');
    const auto [end, good] = read_number(begin, word.data() + word.size(), value);
    if (!good || end != word.data() + word.size()) fail("'" + shown(word) + "' is not a number");
    return value;
  }
  /// A finite number. Throws InputError.
  double real(std::string_view word) const {
    const double value = any_real(word);
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
  // Adds the words of a line; whether the next line continues it.
  bool split(std::string_view line, std::vector<std::string_view>& words) const {
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
    if (!continuation_ || words.empty() || words.back().back() != continuation_) return false;
    words.back().remove_suffix(1);
    if (words.back().empty()) words.pop_back();
    return true;
  }

  std::string_view text_;
  std::string name_;
  char comment_, continuation_, end_;
  std::size_t at_ = 0, number_ = 0;
};

}  // namespace geo
