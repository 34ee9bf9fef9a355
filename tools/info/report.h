// A report on a file: a headline for people, then keys and values for scripts.
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
  /// A histogram with ten bins between the smallest and the largest value: in JSON an object with
  /// lo, hi, mean and counts, as text a bar chart.
  void add_histogram(const std::string& key, const std::vector<double>& values);

  /// The keys of another report: in JSON an object, as text its histograms only.
  void add_report(const std::string& key, const Report& other);

  /// Prints to standard output.
  void print(bool as_json) const;

 private:
  std::string json() const;

  std::vector<std::pair<std::string, std::string>> rows_;
  std::vector<std::string> bars_;  ///< bar charts
};

/// "3 pieces", "1 piece"; with groups of three digits.
std::string counted(std::size_t n, const std::string& noun, const std::string& plural = {});
/// "3,000".
std::string grouped(std::size_t n);
/// A number rounded to four digits.
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
