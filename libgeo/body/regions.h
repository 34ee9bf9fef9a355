// Connected regions that grow from seeds only as far as a connectivity query requires.
#pragma once

#include <cstdint>
#include <functional>
#include <utility>
#include <vector>

namespace geo {

/// Regions over the elements 0, 1, … of any undirected graph. A query grows the smaller of two
/// regions, so its cost is at most twice the size of the smaller component. It is small if the two
/// seeds are connected near each other.
class Regions {
 public:
  /// Appends the neighbours of an element.
  using Around = std::function<void(std::uint32_t, std::vector<std::uint32_t>&)>;
  /// No regions yet.
  explicit Regions(Around around) : around_(std::move(around)), slots_(64) {}

  /// Starts a region at an element, unless a region contains it.
  void seed(std::uint32_t at);
  /// Grows every seed's region by the seed's neighbours; adjacent seeds become one region.
  void grow_seeds();
  /// Grows the region of a seed by the neighbours of one of its elements.
  void grow(std::uint32_t at);
  /// Are two seeds connected? Grows regions until that is known.
  bool joined(std::uint32_t a, std::uint32_t b);

  /// Is the region of a seed a whole component?
  bool whole(std::uint32_t at) { return at_end(of(at)); }
  /// The lowest element of a seed's region so far.
  std::uint32_t lowest(std::uint32_t at) { return of(at).lowest; }
  /// Elements of a seed's region whose neighbours are all in the region; the whole component when
  /// whole().
  const std::vector<std::uint32_t>& inside(std::uint32_t at) { return of(at).inside; }

 private:
  struct Region {
    std::uint32_t parent, lowest;
    std::vector<std::uint32_t> inside, edge;  // edge[begin…]: elements whose neighbours may be missing
    std::size_t begin = 0;
    /// Elements so far, for comparison.
    std::size_t size() const { return inside.size() + edge.size() - begin; }
  };
  static constexpr std::uint32_t none = ~0u;
  struct Slot {
    std::uint32_t element = none, region = none;
    bool inside = false;
  };
  Slot& slot(std::uint32_t element);
  std::uint32_t find(std::uint32_t region);
  Region& of(std::uint32_t at) { return regions_[find(slot(at).region)]; }
  std::uint32_t unite(std::uint32_t a, std::uint32_t b);
  bool at_end(Region& region);
  void add_neighbors_of(std::uint32_t element);

  Around around_;
  std::vector<Region> regions_;  // a union-find forest
  std::vector<std::uint32_t> seeds_;
  std::vector<Slot> slots_;  // a hash table with linear probing; its size is a power of two
  std::size_t used_ = 0;
  std::vector<std::uint32_t> next_;
};

}  // namespace geo
