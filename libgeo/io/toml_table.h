// A table of a TOML file, read key by key: every complaint has line and column, and a key that nobody asks for is
// unknown.
#pragma once

#include <toml++/toml.h>
#include <cmath>
#include <cstdio>
#include <set>
#include <string>
#include <vector>

#include "io/line_reader.h"
#include "kerf/error.h"
#include "kerf/vec.h"

namespace geo {

class TomlTable {
 public:
  TomlTable(const toml::table& table, std::string name, std::string path)
      : table_(table), name_(std::move(name)), path_(std::move(path)) {}

  [[noreturn]] void fail(const toml::node& node, const std::string& what) const {
    const auto at = node.source().begin;
    throw InputError(at.line > 0 ? name_ + ":" + std::to_string(at.line) + ":" + std::to_string(at.column) + ": " + what
                                 : name_ + ": " + what);
  }
  [[noreturn]] void fail(const std::string& what) const { fail(table_, what); }
  /// A key that must be there is not: perhaps it is there misspelt.
  [[noreturn]] void missing(const std::string& key, const std::string& what) const {
    for (const auto& [other, node] : table_)
      if (const auto meant = did_you_mean(other.str(), {key}); !meant.empty())
        fail(node, "unknown key '" + path_ + shown(other.str()) + "'" + meant);
    fail("'" + path_ + key + "' is missing: " + what);
  }
  /// What stands before its keys in messages.
  const std::string& path() const { return path_; }
  const toml::node* find(const std::string& key) {
    known_.insert(key);
    return table_.get(key);
  }
  void get(const std::string& key, double& value, double least, double most) {
    const auto* node = find(key);
    if (!node) return;
    const auto v = node->value<double>();
    if (!v) fail(*node, "'" + path_ + key + "' must be a number");
    if (!(*v >= least && *v <= most))
      fail(*node,
           "'" + path_ + key + "' is out of range: it must be from " + in_words(least) + " to " + in_words(most));
    value = *v;
  }
  void get(const std::string& key, int& value, int least, int most) {
    const auto* node = find(key);
    if (!node) return;
    const auto v = node->value_exact<std::int64_t>();
    if (!v || *v < least || *v > most)
      fail(*node,
           "'" + path_ + key + "' must be an integer from " + std::to_string(least) + " to " + std::to_string(most));
    value = static_cast<int>(*v);
  }
  void get(const std::string& key, std::string& value) {
    const auto* node = find(key);
    if (!node) return;
    const auto v = node->value_exact<std::string>();
    if (!v) fail(*node, "'" + path_ + key + "' must be text");
    value = *v;
  }
  void get(const std::string& key, bool& value) {
    const auto* node = find(key);
    if (!node) return;
    const auto v = node->value_exact<bool>();
    if (!v) fail(*node, "'" + path_ + key + "' must be true or false");
    value = *v;
  }
  void get(const std::string& key, Vec3& value) {
    const auto* node = find(key);
    if (!node) return;
    const auto v = row(*node, 3, "'" + path_ + key + "'");
    value = {v[0], v[1], v[2]};
  }
  std::vector<double> row(const toml::node& node, std::size_t size, const std::string& what) const {
    const auto* array = node.as_array();
    if (!array || array->size() != size) fail(node, what + " must be " + std::to_string(size) + " numbers");
    std::vector<double> values;
    for (const auto& e : *array) {
      const auto v = e.value<double>();
      if (!v || !std::isfinite(*v)) fail(e, what + " must be " + std::to_string(size) + " finite numbers");
      values.push_back(*v);
    }
    return values;
  }
  /// The rows of a list of lists; none where the key is missing.
  std::vector<std::vector<double>> rows(const std::string& key, std::size_t size) {
    std::vector<std::vector<double>> values;
    const auto* node = find(key);
    if (!node) return values;
    if (!node->is_array()) fail(*node, "'" + path_ + key + "' must be a list of rows");
    for (const auto& r : *node->as_array()) values.push_back(row(r, size, "a row of '" + path_ + key + "'"));
    return values;
  }
  /// A table within this one; `read` gets it, and must ask for all keys it knows.
  template <class Read>
  void section(const std::string& key, const Read& read) {
    const auto* node = find(key);
    if (!node) return;
    if (!node->is_table()) fail(*node, "'" + path_ + key + "' must be a table");
    each(*node->as_table(), key, read);
  }
  /// The tables of [[key]], in order.
  template <class Read>
  void list(const std::string& key, const Read& read) {
    const auto* node = find(key);
    if (!node) return;
    if (!node->is_array_of_tables() && !(node->is_array() && node->as_array()->is_homogeneous<toml::table>()))
      fail(*node, "write each " + key + " as [[" + key + "]]");
    for (const auto& e : *node->as_array()) each(*e.as_table(), key, read);
  }
  /// After all keys were asked for.
  void done() const {
    for (const auto& [key, node] : table_)
      if (!known_.count(std::string(key.str())))
        fail(node, "unknown key '" + path_ + shown(key.str()) + "'" +
                       did_you_mean(key.str(), {known_.begin(), known_.end()}));
  }

 private:
  static std::string in_words(double x) {
    char text[32];
    std::snprintf(text, sizeof text, "%g", x);
    return text;
  }
  template <class Read>
  void each(const toml::table& table, const std::string& key, const Read& read) {
    TomlTable inner(table, name_, path_ + key + ".");
    read(inner);
    inner.done();
  }
  const toml::table& table_;
  std::string name_, path_;
  std::set<std::string> known_;
};

}  // namespace geo
