#include "kerf/material.h"

#include "kerf/error.h"

namespace geo {

Materials::Materials(std::vector<Material> table, std::vector<std::uint16_t> of_node)
    : table_(std::move(table)), of_node_(std::move(of_node)) {
  if (table_.empty()) throw InputError("a solid needs a material");
  for (const Material& m : table_) {
    require_material(m);
    if (m.discretisation != discretisation()) throw InputError("all materials of a solid have the same discretisation");
  }
  if (count() == 1) of_node_.clear();
  for (const auto number : of_node_)
    if (number >= count())
      throw InputError("material " + std::to_string(number) + " is not in the table of " + std::to_string(count()));
}

void Materials::set(Discretisation discretisation) {
  for (Material& m : table_) m.discretisation = discretisation;
}

void Materials::add(std::size_t like) {
  if (count() > 1) of_node_.push_back(std::uint16_t(of_node_[like]));
}

}  // namespace geo
