// Scalar fields at nodes, for colours.
#pragma once

#include <string>
#include <vector>

#include "view/subject.h"

namespace view {

struct Field {
  std::string name;
  std::vector<double> values;  ///< one a node
};

/// radius, spacing, volume; for bodies also neighbors, component and debris; with a motion also
/// displacement, speed and strain. The strain is the equivalent (von Mises) strain √(⅔ e:e), with e
/// the deviator of the Green strain: for a linear material von Mises stress over 3 μ.
std::vector<Field> node_fields(const Subject& subject);

/// The field of that name. Throws InputError that lists all fields.
const Field& find_field(const std::vector<Field>& fields, const std::string& name);

}  // namespace view
