// Numbers at nodes that pictures can be coloured by.
#pragma once

#include <string>
#include <vector>

#include "view/subject.h"

namespace view {

struct Field {
  std::string name;
  std::vector<double> values;  ///< one a node
};

/// radius, spacing, volume; of bodies also neighbors, component and debris; with a motion also displacement, speed and
/// strain: the equivalent (von Mises) strain √(⅔ e:e), e the deviator of Green's strain: the stress of that name over
/// three times the shear modulus, for a linear material.
std::vector<Field> node_fields(const Subject& subject);

/// The field of that name. Throws InputError, which lists those that there are.
const Field& find_field(const std::vector<Field>& fields, const std::string& name);

}  // namespace view
