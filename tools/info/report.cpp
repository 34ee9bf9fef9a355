// Values are kept as JSON text, so that one list serves people and scripts. Histograms have ten
// bins.
#include "info/report.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <iostream>
#include <numeric>

#include "tool.h"

namespace info {

void Report::add_text(const std::string& key, const std::string& value) { add(key, tool::quoted(value)); }
void Report::add_number(const std::string& key, double value) { add(key, tool::number(value)); }

void Report::add_histogram(const std::string& key, const std::vector<double>& values) {
  if (values.empty()) return add(key, "null");
  const auto [lo, hi] = std::minmax_element(values.begin(), values.end());
  const double mean = std::accumulate(values.begin(), values.end(), 0.0) / double(values.size());
  std::array<std::size_t, 10> counts{};
  for (const double x : values)
    ++counts[*hi > *lo ? std::min<std::size_t>(9, static_cast<std::size_t>(10 * (x - *lo) / (*hi - *lo))) : 0];
  add(key, "{\"lo\":" + tool::number(*lo) + ",\"hi\":" + tool::number(*hi) + ",\"mean\":" + tool::number(mean) +
               ",\"counts\":" + numbers(counts) + "}");
  std::string bars = key + ": " + rounded(*lo) + " to " + rounded(*hi) + ", mean " + rounded(mean) + "\n";
  const std::size_t most = *std::max_element(counts.begin(), counts.end());
  for (std::size_t b = 0; b < counts.size() && *hi > *lo; ++b) {
    char from[32];
    std::snprintf(from, sizeof from, "%12.4g  ", *lo + double(b) * (*hi - *lo) / 10);
    bars += from;
    for (std::size_t k = 0; k < (40 * counts[b] + most - 1) / most; ++k) bars += "█";
    bars += " " + std::to_string(counts[b]) + "\n";
  }
  bars_.push_back(bars);
}

void Report::add_report(const std::string& key, const Report& other) {
  add(key, other.json());
  for (const auto& bars : other.bars_) bars_.push_back(bars);
}

std::string Report::json() const {
  std::string text = "{";
  for (std::size_t i = 0; i < rows_.size(); ++i)
    text += (i ? "," : "") + tool::quoted(rows_[i].first) + ":" + rows_[i].second;
  return text + "}";
}

void Report::print(bool as_json) const {
  if (as_json) {
    std::cout << json() << '\n';
    return;
  }
  if (!headline.empty()) std::cout << headline << "\n\n";
  for (const auto& [key, value] : rows_) {
    if (value.front() == '{') continue;  // a histogram: below; another report: its headline has said it
    std::string shown = value.size() > 1 && value.front() == '"' ? value.substr(1, value.size() - 2) : value;
    for (std::size_t at = 0; (at = shown.find("},{", at)) != std::string::npos;)
      shown.insert(at += 2, "\n" + std::string(21, ' '));  // a list of objects: one a line
    std::cout << key << std::string(std::max<std::size_t>(1, 20 - std::min<std::size_t>(19, key.size())), ' ') << shown
              << '\n';
  }
  for (const auto& bars : bars_) std::cout << '\n' << bars;
}

std::string grouped(std::size_t n) {
  std::string digits = std::to_string(n);
  for (std::size_t at = digits.size(); at > 3;) digits.insert(at -= 3, ",");
  return digits;
}

std::string counted(std::size_t n, const std::string& noun, const std::string& plural) {
  return grouped(n) + " " + (n == 1 ? noun : plural.empty() ? noun + "s" : plural);
}

std::string rounded(double x) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4g", x);
  return text;
}

std::string list(const std::vector<std::string>& values) {
  std::string text = "[";
  for (std::size_t i = 0; i < values.size(); ++i) text += (i ? "," : "") + values[i];
  return text + "]";
}

}  // namespace info
