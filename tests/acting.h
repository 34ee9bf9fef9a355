// What potentials do to all nodes, by their rows.
#pragma once

#include <vector>

#include "mechanics/terms/contact_rows.h"

namespace geo {

/// The same row by row, of all rows.
inline double energy_of(const Potential& of, const std::vector<Vec3>& u) {
  double sum = 0;
  for (std::size_t r = 0; r < of.size(); ++r) sum += of.energy(r, weighed(of.row(r), u));
  return sum;
}
inline std::vector<Vec3> force_of(Potential& of, const std::vector<Vec3>& u) {
  std::vector<Vec3> force(u.size(), Vec3::Zero());
  for (std::size_t r = 0; r < of.size(); ++r)
    for (const auto& e : of.row(r)) force[e.node] += e.weight * of.push(r, weighed(of.row(r), u)).force;
  return force;
}

class Acting {
 public:
  /// After their begin() at displacements u, which outlive it.
  Acting(std::span<Potential* const> potentials, const std::vector<Vec3>& u)
      : rows_(potentials, u), part_(u.size(), 0) {}
  Acting(Potential& one, const std::vector<Vec3>& u) : Acting(std::vector<Potential*>{&one}, u) {}
  ContactRows& rows() { return rows_; }

  double energy(const std::vector<Vec3>& u) {
    std::vector<double> sum(1, 0);
    rows_.add_energy(u, part_, {1}, sum);
    return sum[0];
  }
  /// Products are of what acts there from now on.
  std::vector<Vec3> force(const std::vector<Vec3>& u) {
    energy(u), rows_.push(part_, {1});
    std::vector<Vec3> force;
    for (std::size_t i = 0; i < u.size(); ++i) force.push_back(rows_.force_at(i));
    return force;
  }
  std::vector<Vec3> product(const std::vector<Vec3>& p) {
    rows_.multiply(p);
    std::vector<Vec3> product;
    for (std::size_t i = 0; i < p.size(); ++i) product.push_back(rows_.product_at(i));
    return product;
  }

 private:
  ContactRows rows_;
  std::vector<std::uint32_t> part_;
};

}  // namespace geo
