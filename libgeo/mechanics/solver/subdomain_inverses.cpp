// An inverse is reused while its inputs are unchanged, bit for bit: diagonal terms, moduli, and the
// subdomain's outer products.
#include "mechanics/solver/subdomain_inverses.h"

#include <algorithm>
#include <utility>

#include "kerf/parallel.h"
#include "mechanics/solver/subdomain_lanes.h"

namespace geo {

void SubdomainInverses::begin(const Subdomains& subdomains) {
  node_.assign(1, 0);
  first_.assign(1, 0);
  for (std::size_t p = 0; p < subdomains.count(); ++p) {
    const std::size_t nodes = subdomains.nodes(p).size();
    node_.push_back(node_.back() + nodes);
    first_.push_back(first_.back() + 3 * nodes * padded(3 * nodes));
  }
  matrix_ = UninitializedArray<std::uint16_t>(first_.back());
  floats_.assign(subdomains.count(), {});
  terms_.resize(node_.back());
  moduli_.resize(subdomains.count());
  valid_.assign(subdomains.count(), 0);
}

void SubdomainInverses::update(const Subdomains& subdomains, std::span<const std::uint32_t> former) {
  const SubdomainInverses before = std::exchange(*this, {});
  begin(subdomains);
  parallel_for(former.size(), 64, [&](std::size_t begin, std::size_t end) {
    for (std::size_t p = begin; p < end; ++p) {
      const std::size_t o = former[p];
      if (o >= before.count() || !before.valid_[o]) continue;
      std::copy_n(before.matrix(o), before.first_[o + 1] - before.first_[o], matrix(p));
      floats_[p] = before.floats_[o];
      std::copy(&before.terms_[before.node_[o]], &before.terms_[0] + before.node_[o + 1], &terms_[node_[p]]);
      moduli_[p] = before.moduli_[o];
      valid_[p] = 1;
    }
  });
}

bool SubdomainInverses::is_valid(std::size_t p, std::span<const DiagonalTerm> terms, const Moduli& moduli) const {
  return valid_[p] && moduli_[p] == moduli &&
         std::equal(terms.begin(), terms.end(), terms_.begin() + static_cast<std::ptrdiff_t>(node_[p]),
                    terms_.begin() + static_cast<std::ptrdiff_t>(node_[p + 1]));
}

void SubdomainInverses::set_valid(std::size_t p, std::span<const DiagonalTerm> terms, const Moduli& moduli) {
  valid_[p] = !terms.empty();
  moduli_[p] = moduli;
  std::copy(terms.begin(), terms.end(), terms_.begin() + static_cast<std::ptrdiff_t>(node_[p]));
}

}  // namespace geo
