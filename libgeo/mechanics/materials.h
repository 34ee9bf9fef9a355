// What a solid is made of: one material, or several, of which each node has one. What no path in the material joins may differ.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "mechanics/elasticity.h"

namespace geo {

class Materials {
 public:
  /// One for all. Throws InputError for an impossible one.
  Materials(const Material& all = {}) : Materials(std::vector<Material>{all}, {}) {}
  /// `of_node`: numbers in the table. Nodes that share a graph's component have the same. Throws InputError for an impossible material, for numbers
  /// that are not in the table, and where discretisations differ.
  Materials(std::vector<Material> table, std::vector<std::uint16_t> of_node);

  std::size_t count() const { return table_.size(); }
  const Material& operator[](std::size_t number) const { return table_[number]; }
  std::span<const Material> all() const { return table_; }
  std::uint16_t number(std::size_t node) const { return count() > 1 ? of_node_[node] : std::uint16_t(0); }
  const Material& of(std::size_t node) const { return table_[number(node)]; }
  Discretisation discretisation() const { return table_[0].discretisation; }
  void set(Discretisation discretisation);

  /// A new node, the next one, has the material of another.
  void add(std::size_t like);
  /// True where there are fewer nodes, or more.
  bool unfit(std::size_t nodes) const { return count() > 1 && of_node_.size() != nodes; }
  /// Whether any of them has what `has` asks for.
  template <class Has>
  bool any(const Has& has) const {
    return std::any_of(table_.begin(), table_.end(), has);
  }

 private:
  std::vector<Material> table_;
  std::vector<std::uint16_t> of_node_;  // empty where there is one material
};

/// Of a small-strain stiffness, Pa.
struct Moduli {
  float shear = 0, bulk = 0;
  friend bool operator==(const Moduli&, const Moduli&) = default;
};

}  // namespace geo
