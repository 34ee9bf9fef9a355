// Connected regions that grow from seeds only as far as it takes to tell which of them are one.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

namespace geo {

/// Over the elements 0, 1, … of any undirected graph. Of two regions the smaller one grows, so that a question costs
/// twice the smaller of them at most, and where they are joined near their seeds it costs next to nothing.
class Regions {
 public:
  /// Appends the neighbours of an element.
  using Around = std::function<void(std::uint32_t, std::vector<std::uint32_t>&)>;
  explicit Regions(Around around) : around_(std::move(around)), slots_(64) {}

  /// A region begins here, unless one has come here already.
  void seed(std::uint32_t at);
  /// Takes in the neighbours of every seed: seeds beside each other become one region.
  void grow_seeds();
  /// One more element's neighbours are taken into the region of a seed.
  void grow(std::uint32_t at);
  /// True when two seeds are connected.
  bool joined(std::uint32_t a, std::uint32_t b);

  /// Of a seed's region: nothing is left to take in; its lowest element; its elements so far whose neighbours are in.
  bool whole(std::uint32_t at) { return at_end(of(at)); }
  std::uint32_t lowest(std::uint32_t at) { return of(at).lowest; }
  const std::vector<std::uint32_t>& inside(std::uint32_t at) { return of(at).inside; }

 private:
  struct Region {
    std::uint32_t parent, lowest;
    std::vector<std::uint32_t> inside, edge;  // edge[begin…]: neighbours that may not be in yet
    std::size_t begin = 0;
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
  void take_around(std::uint32_t element);

  Around around_;
  std::vector<Region> regions_;
  std::vector<std::uint32_t> seeds_;
  std::vector<Slot> slots_;  // a hash table by linear probing, a power of two
  std::size_t used_ = 0;
  std::vector<std::uint32_t> next_;
};

}  // namespace geo
