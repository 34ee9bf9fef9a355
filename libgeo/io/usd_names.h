// Names of prims in USD.
#pragma once

#include <map>
#include <string>

namespace geo::usd {

/// A name as that of a prim: a letter or underscore, then letters, digits and underscores.
inline std::string identifier(const std::string& name) {
  std::string id;
  for (const char c : name) {
    const bool digit = c >= '0' && c <= '9', letter = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_';
    if (digit && id.empty()) id = "_";
    id += digit || letter ? c : '_';
  }
  return id.empty() ? "_" : id;
}

/// Unique names of materials, by group.
class MaterialNames {
 public:
  /// The prim's name of a group, the same at each call.
  const std::string& of(const std::string& group) {
    const auto [entry, fresh] = names_.try_emplace(group);
    if (!fresh) return entry->second;
    std::string name = identifier(group);
    while (!taken_.emplace(name, group).second) name += '_';
    return entry->second = name;
  }
  /// All names so far, by group.
  const std::map<std::string, std::string>& all() const { return names_; }

 private:
  std::map<std::string, std::string> names_, taken_;
};

}  // namespace geo::usd
