// What is said of a file: a sentence for people, then keys and values that scripts rely on.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace info {

class Report {
 public:
  std::string headline;  ///< for people only; not in JSON

  /// `value` is JSON.
  void add(const std::string& key, const std::string& value) { rows_.push_back({key, value}); }
  void add(const std::string& key, std::size_t value) { add(key, std::to_string(value)); }
  void add(const std::string& key, bool value) { add(key, std::string(value ? "true" : "false")); }
  void add_text(const std::string& key, const std::string& value);
  void add_number(const std::string& key, double value);
  /// Ten bins between the least and the greatest value; in JSON an object with lo, hi, mean and counts, for people
  /// bars.
  void add_histogram(const std::string& key, const std::vector<double>& values);

  /// Another report's keys: in JSON an object; people see its histograms only.
  void add_report(const std::string& key, const Report& other);

  /// On standard output.
  void print(bool as_json) const;

 private:
  std::string json() const;

  std::vector<std::pair<std::string, std::string>> rows_;
  std::vector<std::string> bars_;  ///< what people see of histograms
};

/// "3 pieces", "1 piece"; thousands set off.
std::string counted(std::size_t n, const std::string& noun, const std::string& plural = {});
/// "3,000".
std::string grouped(std::size_t n);
/// "1.25 × 0.8 × 2", rounded to four digits.
std::string rounded(double x);
/// JSON lists.
std::string list(const std::vector<std::string>& values);
template <class Range>
std::string numbers(const Range& values) {
  std::vector<std::string> text;
  for (const auto& x : values) text.push_back(std::to_string(x));
  return list(text);
}

}  // namespace info
