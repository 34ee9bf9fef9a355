// A table of a TOML file, read key by key. Errors have line and column. A key that is never queried
// is an error.
#pragma once

#include <cmath>
#include <cstdio>
#include <set>
#include <string>
#include <vector>

#include "io/shown.h"
#include "io/toml.h"
#include "kerf/error.h"
#include "kerf/vec.h"

namespace geo {

/// Reader of one table. All get() functions leave the value unchanged where the key is missing.
/// They throw InputError where the key has another type or is out of range.
class TomlTable {
 public:
  /// `name`: of the file; `path`: dotted prefix of the keys in messages. `table` must outlive the
  /// reader.
  TomlTable(const toml::table& table, std::string name, std::string path)
      : table_(table), name_(std::move(name)), path_(std::move(path)) {}

  /// Throws InputError at the position of a node.
  [[noreturn]] void fail(const toml::node& node, const std::string& what) const {
    const auto at = node.source().begin;
    throw InputError(at.line > 0 ? name_ + ":" + std::to_string(at.line) + ":" + std::to_string(at.column) + ": " + what
                                 : name_ + ": " + what);
  }
  /// Throws InputError at the position of the table.
  [[noreturn]] void fail(const std::string& what) const { fail(table_, what); }
  /// Throws InputError for a missing key, or one with an empty text; where another key is similar,
  /// for that one as misspelt.
  [[noreturn]] void missing(const std::string& key, const std::string& what) const {
    if (const auto* node = table_.get(key)) fail(*node, "'" + path_ + key + "' is empty: " + what);
    for (const auto& [other, node] : table_)
      if (const auto meant = did_you_mean(other.str(), {key}); !meant.empty())
        fail(node, "unknown key '" + path_ + shown(other.str()) + "'" + meant);
    fail("'" + path_ + key + "' is missing: " + what);
  }
  /// Prefix of the keys in messages.
  const std::string& path() const { return path_; }
  /// The node of a key; null where it is missing.
  const toml::node* find(const std::string& key) {
    known_.insert(key);
    return table_.get(key);
  }
  /// A number within [least, most].
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
  /// An integer within [least, most].
  void get(const std::string& key, int& value, int least, int most) {
    const auto* node = find(key);
    if (!node) return;
    const auto v = node->value_exact<std::int64_t>();
    if (!v || *v < least || *v > most)
      fail(*node,
           "'" + path_ + key + "' must be an integer from " + std::to_string(least) + " to " + std::to_string(most));
    value = static_cast<int>(*v);
  }
  /// Text.
  void get(const std::string& key, std::string& value) {
    const auto* node = find(key);
    if (!node) return;
    const auto v = node->value_exact<std::string>();
    if (!v) fail(*node, "'" + path_ + key + "' must be text");
    value = *v;
  }
  /// A truth value.
  void get(const std::string& key, bool& value) {
    const auto* node = find(key);
    if (!node) return;
    const auto v = node->value_exact<bool>();
    if (!v) fail(*node, "'" + path_ + key + "' must be true or false");
    value = *v;
  }
  /// Three numbers.
  void get(const std::string& key, Vec3& value) {
    const auto* node = find(key);
    if (!node) return;
    const auto v = row(*node, 3, "'" + path_ + key + "'");
    value = {v[0], v[1], v[2]};
  }
  /// A list of `size` finite numbers; `what` names it in messages.
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
  /// A list of lists of `size` numbers; empty where the key is missing.
  std::vector<std::vector<double>> rows(const std::string& key, std::size_t size) {
    std::vector<std::vector<double>> values;
    const auto* node = find(key);
    if (!node) return values;
    if (!node->is_array()) fail(*node, "'" + path_ + key + "' must be a list of rows");
    for (const auto& r : *node->as_array()) values.push_back(row(r, size, "a row of '" + path_ + key + "'"));
    return values;
  }
  /// Reads a table within this one: `read` gets its reader, and must query all keys that it knows.
  template <class Read>
  void section(const std::string& key, const Read& read) {
    const auto* node = find(key);
    if (!node) return;
    if (!node->is_table()) fail(*node, "'" + path_ + key + "' must be a table");
    each(*node->as_table(), key, read);
  }
  /// Reads the tables of [[key]] in order.
  template <class Read>
  void list(const std::string& key, const Read& read) {
    const auto* node = find(key);
    if (!node) return;
    if (!node->is_array_of_tables() && !(node->is_array() && node->as_array()->is_homogeneous<toml::table>()))
      fail(*node, "write each " + key + " as [[" + key + "]]");
    for (const auto& e : *node->as_array()) each(*e.as_table(), key, read);
  }
  /// Throws InputError for a key that was never queried.
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
