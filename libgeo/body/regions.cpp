// Breadth-first regions in a union-find forest with path halving (Tarjan and van Leeuwen 1984). The
// smaller region is merged into the larger one.
#include "body/regions.h"

#include <algorithm>

namespace geo {

Regions::Slot& Regions::slot(std::uint32_t element) {
  if (2 * used_ > slots_.size()) {
    std::vector<Slot> old(2 * slots_.size());
    old.swap(slots_);
    used_ = 0;
    for (const Slot& s : old)
      if (s.element != none) slot(s.element) = s;
  }
  const std::size_t mask = slots_.size() - 1;
  // Fibonacci hashing: the constant is 2⁶⁴ / φ (Knuth, vol. 3, § 6.4).
  std::size_t at = (element * std::uint64_t{0x9e3779b97f4a7c15}) >> 32 & mask;
  while (slots_[at].element != none && slots_[at].element != element) at = (at + 1) & mask;
  if (slots_[at].element == none) {
    slots_[at].element = element;
    ++used_;
  }
  return slots_[at];
}

std::uint32_t Regions::find(std::uint32_t region) {
  while (regions_[region].parent != region) region = regions_[region].parent = regions_[regions_[region].parent].parent;
  return region;
}

void Regions::seed(std::uint32_t at) {
  Slot& s = slot(at);
  if (s.region != none) return;
  s.region = static_cast<std::uint32_t>(regions_.size());
  regions_.push_back({.parent = s.region, .lowest = at, .inside = {}, .edge = {at}});
  seeds_.push_back(at);
}

std::uint32_t Regions::unite(std::uint32_t a, std::uint32_t b) {
  if (regions_[a].size() < regions_[b].size()) std::swap(a, b);
  Region &large = regions_[a], &small = regions_[b];
  large.inside.insert(large.inside.end(), small.inside.begin(), small.inside.end());
  large.edge.insert(large.edge.end(), small.edge.begin() + static_cast<std::ptrdiff_t>(small.begin), small.edge.end());
  large.lowest = std::min(large.lowest, small.lowest);
  small = {.parent = a, .lowest = small.lowest, .inside = {}, .edge = {}};
  return a;
}

bool Regions::at_end(Region& region) {
  while (region.begin < region.edge.size() && slot(region.edge[region.begin]).inside) ++region.begin;
  return region.begin == region.edge.size();
}

void Regions::add_neighbors_of(std::uint32_t element) {
  Slot& s = slot(element);
  if (s.inside) return;
  s.inside = true;
  std::uint32_t region = find(s.region);
  regions_[region].inside.push_back(element);
  next_.clear();
  around_(element, next_);
  for (const auto n : next_) {
    Slot& next = slot(n);
    if (next.region == none) {
      next.region = region;
      regions_[region].edge.push_back(n);
      regions_[region].lowest = std::min(regions_[region].lowest, n);
    } else if (const auto other = find(next.region); other != region) {
      region = unite(region, other);
    }
  }
}

void Regions::grow(std::uint32_t at) {
  Region& region = of(at);
  if (!at_end(region)) add_neighbors_of(region.edge[region.begin]);
}

void Regions::grow_seeds() {
  for (const auto s : seeds_) add_neighbors_of(s);
}

bool Regions::joined(std::uint32_t a, std::uint32_t b) {
  for (;;) {
    Region &ra = of(a), &rb = of(b);
    if (&ra == &rb) return true;
    if (at_end(ra) || at_end(rb)) return false;
    grow(ra.size() <= rb.size() ? a : b);
  }
}

}  // namespace geo
