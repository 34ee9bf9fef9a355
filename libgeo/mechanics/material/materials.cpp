// Materials of kerf/material.h. The table is checked once, in the constructor. A single material
// needs no index per node.

#include "kerf/error.h"
#include "kerf/material.h"

namespace geo {

Materials::Materials(std::vector<Material> table, std::vector<std::uint16_t> index_of_node)
    : table_(std::move(table)), index_of_node_(std::move(index_of_node)) {
  if (table_.empty()) throw InputError("a solid needs a material");
  for (const Material& m : table_) {
    require_material(m);
    if (m.discretisation != discretisation()) throw InputError("all materials of a solid have the same discretisation");
  }
  if (count() == 1) index_of_node_.clear();
  for (const auto index : index_of_node_)
    if (index >= count())
      throw InputError("material " + std::to_string(index) + " is not in the table of " + std::to_string(count()));
}

void Materials::set_discretisation(Discretisation discretisation) {
  for (Material& m : table_) m.discretisation = discretisation;
}

void Materials::add_node(std::size_t donor) {
  if (count() > 1) index_of_node_.push_back(std::uint16_t(index_of_node_[donor]));
}

}  // namespace geo
