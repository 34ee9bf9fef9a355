// What rows of contact have for all nodes.
#pragma once

#include <vector>

#include "mechanics/contact_rows.h"

namespace geo {

inline std::vector<Vec3> product_of(ContactRows& rows, const std::vector<Vec3>& p) {
  rows.multiply(p);
  std::vector<Vec3> product;
  for (std::size_t i = 0; i < p.size(); ++i) product.push_back(rows.product_at(i));
  return product;
}

}  // namespace geo
